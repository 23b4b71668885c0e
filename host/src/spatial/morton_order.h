// An order of vertices and faces in which neighbours stand near each other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/counting_sort.h"

namespace vkmesh::detail {

/// Whether many corners stand far from the next of their face, in a mesh that no cache holds: a fourth of
/// those of faces spread over all. O(1).
inline bool lacks_locality(std::size_t vertex_count, std::span<const std::uint32_t> corners) {
  constexpr std::size_t kSmall = std::size_t{1} << 15, kFaces = std::size_t{1} << 15;
  constexpr std::uint32_t kFar = 1 << 13;
  const std::size_t faces = corners.size() / 3, looked_at = std::min(faces, kFaces);
  if (vertex_count < kSmall) return false;
  std::size_t far = 0;
  for (std::size_t i = 0; i < looked_at; ++i) {
    const std::size_t f = i * faces / looked_at;
    const std::uint32_t a = corners[3 * f], b = corners[3 * f + 1];
    far += (a < b ? b - a : a - b) > kFar ? 1 : 0;
  }
  return far > looked_at / 4;
}

/// The vertices along G. M. Morton's curve (1966) through a grid of 1024³ over the cube [-1/2, 1/2]³, those
/// of one cell in ascending order. O(n).
template <class Position>
std::vector<std::uint32_t> morton_order(std::size_t count, Position&& position) {
  const auto spread = [](float x) {  // ten bits, two zeros after each
    const float cell = (x + 0.5f) * 1024.0f;
    auto v = static_cast<std::uint32_t>(cell < 0 ? 0.0f : cell > 1023 ? 1023.0f : cell);
    v = (v | v << 16) & 0x030000ffu;
    v = (v | v << 8) & 0x0300f00fu;
    v = (v | v << 4) & 0x030c30c3u;
    return (v | v << 2) & 0x09249249u;
  };
  std::vector<std::uint64_t> keys(count), sorted(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<float, 3> p = position(i);
    const std::uint32_t code = spread(p[0]) | spread(p[1]) << 1 | spread(p[2]) << 2;
    keys[i] = static_cast<std::uint64_t>(code) << 32 | i;
  }
  for (const unsigned shift : {32u, 42u, 52u}) {
    std::array<std::size_t, 1024> offset{};
    for (const std::uint64_t key : keys) ++offset[key >> shift & 1023u];
    std::exclusive_scan(offset.begin(), offset.end(), offset.begin(), std::size_t{0});
    for (const std::uint64_t key : keys) sorted[offset[key >> shift & 1023u]++] = key;
    std::swap(keys, sorted);
  }
  std::vector<std::uint32_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = static_cast<std::uint32_t>(keys[i]);
  return order;
}

}  // namespace vkmesh::detail
