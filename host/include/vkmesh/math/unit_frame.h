// Coordinates of about [-1, 1] for sums that must not overflow, in the exact arithmetic that shaders share.
#pragma once

#include <algorithm>
#include <cstdint>

#include <vkmesh/math/arithmetic.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// Scaled coordinates are (position − centre) · scale.
struct UnitFrame {
  Vec3 centre{0.0f};
  float scale = 0.0f, inverse_scale = 0.0f;  ///< Powers of two.
};

/// The frame in which the longest side of the box has a length in [1, 2). O(1).
[[nodiscard]] inline UnitFrame unit_frame_of(const Bounds& bounds) {
  const Vec3 extent = bounds.extent();
  const std::uint32_t largest =
      std::max(std::max(bits(extent.x), bits(extent.y)), bits(extent.z)) & 0x7f800000u;
  return {bounds.low + zero_below(0.5f * extent, VKMESH_TINY_COORDINATE), from_bits(0x7f000000u - largest),
          from_bits(largest)};
}

}  // namespace vkmesh::detail
