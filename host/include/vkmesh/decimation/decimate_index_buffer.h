// Decimation of an index buffer over a vertex buffer that stays as it is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/strided_span.h>

namespace vkmesh {

struct DecimatedIndexBuffer : DecimationReport {
  std::vector<std::uint32_t> indices;      ///< Three a triangle, of the vertices of the input.
  std::vector<std::uint32_t> source_face;  ///< For each triangle that of the input it was; ascending.
};

/// For engines that draw all levels of detail from one vertex buffer: half-edge collapses, of which only the
/// index buffer is returned. Vertices at the same place (0 is -0) are the wedges of one point, and the edges
/// between them seams: what `decimate` says of seams holds, so a level has no cracks, and both sides of a
/// seam end at the same places. Triangles with two corners at one place are left out.
///
/// The triangles need be no oriented manifold. Where it is not clear which two of the triangles at an edge
/// continue each other, as where a fin stands on a surface, three sheets meet or a triangle is turned, and
/// where sheets touch in one point, the vertices are locked and all else is simplified. (A seam whose sides
/// collapse together would need a rule for which of three sheets leads; locked vertices need none, leave no
/// crack and cost few triangles, since such edges are few.) The two sides of a double-sided part are told
/// apart by their vertices, or as the reverses that they are, and each is simplified by itself, outline
/// included.
///
/// `points`: those of the vertices, which may be members of an interleaved buffer: StridedSpan<Vec3>(buffer,
/// vertices, sizeof(Vertex)). Values of options.attributes: one for each vertex; DecimateAttribute::stride is
/// for interleaved ones, and corners must be empty. Neither need be copied by the caller; strides other than
/// the packed ones cost as many bytes as there are values while the function runs. options.operation: an edge
/// collapse, the default, is done as the half-edge collapse that leaves all vertices where they are; vertex
/// removals leave them, too. What is locked, or of faces, is numbered as in the input. O(n log n). Errors: as
/// `decimate`, but for those of surfaces that are no oriented manifolds; kUsage for corner_groups.
[[nodiscard]] VKMESH_API Result<DecimatedIndexBuffer> decimate_index_buffer(
    const StridedSpan<Vec3>& points, std::span<const std::uint32_t> indices, const DecimateOptions& options,
    const Progress& progress = {});

}  // namespace vkmesh
