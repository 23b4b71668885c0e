// Triangles as borrowed arrays, for algorithms that take any kind of triangle mesh.
#pragma once

#include <cstdint>
#include <span>

#include <vkmesh/math/vec.h>

namespace vkmesh {

/// Triangles as points and three corners each; IndexedFaceSet::corners and HalfEdgeMesh::origins() fit.
/// Borrowed.
struct TriangleSurface {
  std::span<const Vec3> points;
  std::span<const std::uint32_t> corners;  ///< Each < points.size(); a multiple of three.
};

}  // namespace vkmesh
