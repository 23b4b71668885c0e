// How well shaped the triangles of a surface are, by their least angles.
#pragma once

#include <cstddef>
#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// Measures of the least angle of each triangle, in radians; 0 where there are none. A triangle without area
/// has one of 0.
struct TriangleAngles {
  double least = 0, mean = 0;
  std::size_t below_5_degrees = 0, below_30_degrees = 0;  ///< Triangles.
};

/// O(faces). Errors: kUnsuitable unless triangles; kUsage unless one position for each vertex.
[[nodiscard]] VKMESH_API Result<TriangleAngles> triangle_angles(const HalfEdgeMesh& mesh,
                                                                std::span<const Vec3> positions);

}  // namespace vkmesh
