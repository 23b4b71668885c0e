// Rows to columns, four by four.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>

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

}  // namespace vkmesh::detail
