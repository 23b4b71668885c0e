// Four words at a time, or eight.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "simd/target_clones.h"

namespace vkmesh::detail {

/// Column k becomes the k-th word of each of four rows of four words.
[[gnu::always_inline]] inline void turn_four(const std::array<const void*, 4>& rows,
                                             const std::array<float*, 4>& columns) {
#if defined(__GNUC__) || defined(__clang__)
  using Four = float __attribute__((vector_size(16)));
  std::array<Four, 4> r;
  for (std::size_t i = 0; i < 4; ++i) __builtin_memcpy(&r[i], rows[i], 16);
  const Four a = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
             b = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5);
  const Four c = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7),
             d = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
  const std::array<Four, 4> s = {
      __builtin_shufflevector(a, b, 0, 1, 4, 5), __builtin_shufflevector(a, b, 2, 3, 6, 7),
      __builtin_shufflevector(c, d, 0, 1, 4, 5), __builtin_shufflevector(c, d, 2, 3, 6, 7)};
  for (std::size_t i = 0; i < 4; ++i) __builtin_memcpy(columns[i], &s[i], 16);
#else
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k)
      std::memcpy(columns[k] + i, static_cast<const char*>(rows[i]) + 4 * k, 4);
#endif
}

#if defined(VKMESH_HAS_CLONES)
/// The same of eight rows, for processors that have registers of eight.
[[gnu::always_inline, gnu::target("avx2")]] inline void turn_eight(const std::array<const void*, 8>& rows,
                                                                   const std::array<float*, 4>& columns) {
  using Four = float __attribute__((vector_size(16)));
  using Eight = float __attribute__((vector_size(32)));
  std::array<Eight, 4> r;
  for (std::size_t i = 0; i < 4; ++i) {
    Four low, high;
    __builtin_memcpy(&low, rows[i], 16);
    __builtin_memcpy(&high, rows[i + 4], 16);
    r[i] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
  }
  const Eight a = __builtin_shufflevector(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13),
              b = __builtin_shufflevector(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight c = __builtin_shufflevector(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15),
              d = __builtin_shufflevector(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
  // One by one: g++ 12 keeps an array of them in memory.
  const Eight first = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13),
              second = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15),
              third = __builtin_shufflevector(c, d, 0, 1, 8, 9, 4, 5, 12, 13),
              fourth = __builtin_shufflevector(c, d, 2, 3, 10, 11, 6, 7, 14, 15);
  __builtin_memcpy(columns[0], &first, 32);
  __builtin_memcpy(columns[1], &second, 32);
  __builtin_memcpy(columns[2], &third, 32);
  __builtin_memcpy(columns[3], &fourth, 32);
}
#endif

/// Adds four floats to those at `to`.
[[gnu::always_inline]] inline void add_four(const float* from, void* to) {
#if defined(__GNUC__) || defined(__clang__)
  using Four = float __attribute__((vector_size(16)));
#else
  using Four = std::array<float, 4>;
#endif
  Four a, b;
  std::memcpy(&a, from, 16);
  std::memcpy(&b, to, 16);
  for (std::size_t k = 0; k < 4; ++k) b[k] += a[k];
  std::memcpy(to, &b, 16);
}

}  // namespace vkmesh::detail
