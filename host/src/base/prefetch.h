// What a processor's caches are told about memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

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

/// Copies floats past the caches where the processor can: what is not read again soon then takes no room
/// there, and is not read before it is written over. Other threads may read it after the usual
/// synchronization.
inline void copy_past_caches(const float* from, std::size_t count, float* to) {
#if defined(__SSE2__)
  std::size_t i = 0;
  while (i < count && reinterpret_cast<std::uintptr_t>(to + i) % 16 != 0) to[i] = from[i], ++i;
  for (; i + 4 <= count; i += 4) _mm_stream_ps(to + i, _mm_loadu_ps(from + i));
  for (; i < count; ++i) to[i] = from[i];
  _mm_sfence();
#else
  std::memcpy(to, from, count * sizeof(float));
#endif
}

}  // namespace vkmesh::detail
