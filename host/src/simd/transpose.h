// Records taken apart into lanes, four at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>

namespace vkmesh::detail {

/// Column k becomes the k-th word of each of four rows of four words.
[[gnu::always_inline]] inline void transpose_4x4(const std::array<const void*, 4>& rows,
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

/// The first kWords words of four records, a multiple of four: word k of each goes to column(k), [0, 4).
template <std::size_t kWords, class Column>
[[gnu::always_inline]] inline void transpose_records(const std::array<const void*, 4>& records,
                                                     Column&& column) {
  for (std::size_t k = 0; k < kWords; k += 4) {
    std::array<const void*, 4> rows;
    for (std::size_t i = 0; i < 4; ++i) rows[i] = static_cast<const char*>(records[i]) + 4 * k;
    transpose_4x4(rows, {column(k), column(k + 1), column(k + 2), column(k + 3)});
  }
}

/// Adds four floats to those at `to`.
[[gnu::always_inline]] inline void add_4(const float* from, void* to) {
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
