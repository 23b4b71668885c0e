// Lanes: what many elements of a batch have of one kind, side by side, as vector registers take them.
#pragma once

#include <array>
#include <cstddef>

namespace vkmesh::detail {

template <std::size_t kCount>
using FloatLanes = std::array<float, kCount>;

}  // namespace vkmesh::detail

// A loop over lanes, which know nothing of each other. g++ 12 would unroll a short one before it looks for
// vectors, and find none.
#if defined(__GNUC__) && !defined(__clang__)
#define VKMESH_FOR_LANES(l, count) \
  _Pragma("GCC ivdep") _Pragma("GCC unroll 1") for (std::size_t l = 0; l < (count); ++l)
#elif defined(__clang__)
#pragma clang diagnostic ignored "-Wpass-failed"  // where little is optimised
#define VKMESH_FOR_LANES(l, count) \
  _Pragma("clang loop vectorize(assume_safety)") for (std::size_t l = 0; l < (count); ++l)
#else
#define VKMESH_FOR_LANES(l, count) for (std::size_t l = 0; l < (count); ++l)
#endif
