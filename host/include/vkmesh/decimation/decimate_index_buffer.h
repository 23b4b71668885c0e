// Decimation of an index buffer over a vertex buffer that stays as it is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/decimation/decimate.h>

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
/// `points`, and the values of options.attributes, which must name no corners: one for each vertex.
/// options.operation must be half-edge collapse. What is locked, or of faces, is numbered as in the input.
/// O(n log n). Errors: as `decimate`, kUnsuitable too where the surface is no oriented manifold once points
/// are made one; kUsage for corner_groups.
[[nodiscard]] Result<DecimatedIndexBuffer> decimate_index_buffer(std::span<const Vec3> points,
                                                                 std::span<const std::uint32_t> indices,
                                                                 const DecimateOptions& options,
                                                                 const Progress& progress = {});

}  // namespace vkmesh
