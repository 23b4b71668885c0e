// Stable counting sort of items into buckets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vkmesh::detail {

/// Sorts the items 0 .. items - 1 by key(item) in [0, buckets): place(slot, item) is called once for each
/// item, in ascending order of items, with its slot in the sorted order. Returns the buckets + 1 offsets of
/// the buckets. O(items + buckets). Requires items < 2^32.
template <class Key, class Place>
std::vector<std::uint32_t> counting_sort(std::size_t buckets, std::size_t items, Key&& key, Place&& place) {
  std::vector<std::uint32_t> offsets(buckets + 1, 0);
  for (std::size_t i = 0; i < items; ++i) ++offsets[key(i)];
  std::uint32_t sum = 0;
  for (std::uint32_t& offset : offsets) {
    const std::uint32_t size = offset;
    offset = sum;
    sum += size;
  }
  for (std::size_t i = 0; i < items; ++i) place(offsets[key(i)]++, i);
  // Each offset now stands at its bucket's end, which is where the next begins.
  for (std::size_t b = buckets; b > 0; --b) offsets[b] = offsets[b - 1];
  offsets[0] = 0;
  return offsets;
}

}  // namespace vkmesh::detail
