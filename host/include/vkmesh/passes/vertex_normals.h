// Vertex normals: a weighted mean of the normals of the faces around each vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// How much each triangle around a vertex counts.
enum class NormalWeights : std::uint8_t {
  kArea,     ///< By its area.
  kAngle,    ///< By its angle at the vertex (G. Thürmer, C. A. Wüthrich, "Computing vertex normals from
             ///< polygonal facets", 1998): the same however a flat side is cut into triangles.
  kUniform,  ///< All alike.
};

struct VertexNormalsOptions {
  NormalWeights weights = NormalWeights::kArea;
};

/// N_v = Σ w_T N_T / |Σ w_T N_T| over the triangles T around v, summed in ascending order of faces (lecture,
/// "Normals"). Unit vectors; the zero vector where no direction is defined: isolated vertices, and fans of
/// degenerate triangles (lengths below about 4e-19 units and areas below about 4e-31 square units count as
/// zero, see docs/exactness.md). The reference of shaders/passes/vertex_normals*.comp, equal to them bit for
/// bit. O(half-edges). Errors: kUnsuitable unless triangles; kUsage unless one position for each vertex;
/// kOutOfMemory.
[[nodiscard]] Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh,
                                                       std::span<const Vec3> positions,
                                                       const VertexNormalsOptions& options = {});

/// The same into memory of the caller, one vector for each vertex, whatever it held. Errors: also kUsage
/// where the size of `normals` differs; it is left as it was.
[[nodiscard]] Result<void> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                          std::span<Vec3> normals, const VertexNormalsOptions& options = {});

}  // namespace vkmesh
