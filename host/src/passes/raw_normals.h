// triangle_normals() for the passes that go on with them.
#pragma once

#include <span>

#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh::detail {

/// Of triangles and checked positions, as many as there are faces.
void raw_triangle_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, std::span<Vec3> normals);

}  // namespace vkmesh::detail
