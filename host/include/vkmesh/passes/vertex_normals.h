// Vertex normals: the area-weighted mean of the normals of the faces around a vertex.
#pragma once

#include <span>
#include <vector>

#include <vkmesh/half_edge_mesh.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

namespace vkmesh {

/// N_v = Σ A_T N_T / |Σ A_T N_T| over the triangles T around v, summed in ascending order of faces (lecture,
/// "Normals"). Unit vectors; the zero vector where no direction is defined: isolated vertices, and fans of
/// degenerate triangles (lengths below about 4e-19 units and areas below about 4e-31 square units count as
/// zero, see docs/exactness.md). The reference of shaders/vertex_normals_*.comp, equal to it bit for bit.
/// O(half-edges). Errors: kUnsuitable unless triangles; kUsage unless one position for each vertex;
/// kOutOfMemory.
[[nodiscard]] Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh,
                                                       std::span<const Vec3> positions);

}  // namespace vkmesh
