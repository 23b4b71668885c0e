// Vertex normals: a weighted mean of the normals of the faces around each vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// How much each face around a vertex counts.
enum class NormalWeights : std::uint8_t {
  kArea,     ///< By its area.
  kAngle,    ///< By its angle at the vertex (G. Thürmer, C. A. Wüthrich, "Computing vertex normals from
             ///< polygonal facets", 1998): the same however a flat side is cut into triangles.
  kUniform,  ///< All alike.
};

struct VertexNormalsOptions {
  NormalWeights weights = NormalWeights::kArea;
};

/// N_v = Σ w_F N_F / |Σ w_F N_F| over the faces F around v, summed in ascending order (lecture, "Normals").
/// A polygon counts as one face, by its own area and its own inner angles: its normal is that of its area
/// vector (M. E. Newell, see I. E. Sutherland, R. F. Sproull, R. A. Schumacker, "A characterization of ten
/// hidden-surface algorithms", 1974), which no cut into triangles changes. Unit vectors; the zero vector
/// where no direction is defined: isolated vertices, and fans of degenerate faces (lengths below about 4e-19
/// units and areas below about 4e-31 square units count as zero, see docs/exactness.md). For triangles the
/// reference of shaders/passes/vertex_normals*.comp, equal to them bit for bit; polygons have no kernel, and
/// the same bytes on every machine. O(half-edges). Errors: kUsage unless one position for each vertex;
/// kOutOfMemory.
[[nodiscard]] VKMESH_API Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh,
                                                                  std::span<const Vec3> positions,
                                                                  const VertexNormalsOptions& options = {});

/// The same into memory of the caller, one vector for each vertex, whatever it held. Errors: also kUsage
/// where the size of `normals` differs; it is left as it was.
[[nodiscard]] VKMESH_API Result<void> vertex_normals(const HalfEdgeMesh& mesh,
                                                     std::span<const Vec3> positions, std::span<Vec3> normals,
                                                     const VertexNormalsOptions& options = {});

}  // namespace vkmesh
