// Streaming stores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace vkmesh::detail {

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
