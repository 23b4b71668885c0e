// Large arrays whose first touch costs less.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "base/parallel.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace vkmesh::detail {

inline constexpr std::size_t kLargePage = std::size_t{1} << 21;

/// Asks for large pages where whole ones fit into [data, data + bytes), before it is written: to make small
/// pages resident takes longer than most passes take for what they write there. The system may say no.
inline void prefer_large_pages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  const auto begin = reinterpret_cast<std::uintptr_t>(data);
  const std::uintptr_t first = (begin + kLargePage - 1) / kLargePage * kLargePage;
  const std::uintptr_t last = (begin + bytes) / kLargePage * kLargePage;
  if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

/// Makes [data, data + bytes) resident on all cores: one fills it afterwards.
inline void touch_large_pages(void* data, std::size_t bytes) {
  char* const begin = static_cast<char*>(data);
  parallel_ranges(bytes / kLargePage, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) begin[i * kLargePage] = 0;
  });
}

/// `size` elements made from nothing, in large pages as far as possible.
template <class T>
std::vector<T> large_vector(std::size_t size) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> result;
  result.reserve(size);
  prefer_large_pages(result.data(), size * sizeof(T));
  touch_large_pages(result.data(), size * sizeof(T));
  result.resize(size);
  return result;
}

}  // namespace vkmesh::detail
