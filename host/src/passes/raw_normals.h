// triangle_normals() for the passes that go on with them.
#pragma once

#include <span>

#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh::detail {

/// One for each triangle, from checked positions.
void raw_triangle_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, std::span<Vec3> normals);

}  // namespace vkmesh::detail
