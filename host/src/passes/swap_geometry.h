// What scores of swaps and rounds of them share. Twin of shaders/lib/swap_geometry.glsl.
#pragma once

#include <vkmesh/math/arithmetic.h>
#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

[[nodiscard]] inline float squared_distance(Vec3 a, Vec3 b) {
  return squared_length(zero_below(b - a, VKMESH_TINY_LENGTH));
}

/// Whether a triangle of this area vector does not look the way of a unit vector.
[[nodiscard]] inline bool faces_away(Vec3 unit, Vec3 area) {
  const Vec3 other = unit_vector(area);
  return !((unit.x * other.x + unit.y * other.y) + unit.z * other.z > 0.0f);
}

}  // namespace vkmesh::detail
