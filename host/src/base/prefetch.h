// What a processor's caches are told about memory.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vkmesh::detail {

inline constexpr std::size_t kCacheLine = 64;

/// Asks for the cache line at `address` without waiting for it.
[[gnu::always_inline]] inline void prefetch(const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(address);
#else
  static_cast<void>(address);
#endif
}

/// For loops over long arrays that do little else than wait for memory: asks for what comes a page after
/// `address`, which may be beyond the array. The processor by itself looks less far ahead, and not from one
/// page to the next.
[[gnu::always_inline]] inline void prefetch_stream([[maybe_unused]] const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  constexpr std::uintptr_t kAhead = 4096;
  __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(address) + kAhead));
#endif
}

/// The same for `bytes` from `data` on, only into the second cache: what is wanted later than the first
/// keeps.
inline void prefetch_for_later(const void* data, std::size_t bytes) {
#if defined(__GNUC__) || defined(__clang__)
  const char* const begin = static_cast<const char*>(data);
  for (std::size_t i = 0; i < bytes; i += kCacheLine) __builtin_prefetch(begin + i, 0, 2);
#else
  static_cast<void>(data), static_cast<void>(bytes);
#endif
}

}  // namespace vkmesh::detail
