// Which elements have a property.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include "base/parallel.h"

namespace vkmesh::detail {

/// The numbers below `count` that f(number) is true for, in ascending order; f is called once for each, on
/// any threads.
template <class F>
std::vector<std::uint32_t> collect(std::size_t count, F&& f) {
  constexpr std::size_t kBlock = std::size_t{1} << 15;
  const std::size_t blocks = (count + kBlock - 1) / kBlock;
  // Each block's numbers where it begins, and where they will stand together.
  const auto found = std::make_unique_for_overwrite<std::uint32_t[]>(count);
  std::vector<std::size_t> begin(blocks + 1, 0);
  parallel_ranges(blocks, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      std::uint32_t* const to = &found[b * kBlock];
      std::size_t size = 0;  // branchless: the branch is unpredictable
      for (std::size_t i = b * kBlock; i < std::min((b + 1) * kBlock, count); ++i) {
        to[size] = static_cast<std::uint32_t>(i);
        size += f(static_cast<std::uint32_t>(i)) ? 1 : 0;
      }
      begin[b + 1] = size;
    }
  });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> all(begin.back());
  parallel_ranges(blocks, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b)
      std::copy_n(&found[b * kBlock], begin[b + 1] - begin[b], all.data() + begin[b]);
  });
  return all;
}

}  // namespace vkmesh::detail
