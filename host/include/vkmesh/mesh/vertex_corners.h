// For each vertex the corners of faces that lie at it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// The half-edges that leave each vertex, packed, in ascending order. What a shader gathers faces over (the
/// face of half-edge h of a triangle mesh is h / 3), in the order in which a loop over the faces would
/// scatter. Memory: 4 bytes a half-edge and 4 a vertex.
struct VertexCorners {
  std::vector<std::uint32_t>
      offsets;  ///< vertices + 1; the half-edges of v are [offsets[v], offsets[v + 1]).
  std::vector<std::uint32_t> half_edges;

  [[nodiscard]] std::span<const std::uint32_t> of(VertexId v) const {
    return {half_edges.data() + offsets[v.index], offsets[v.index + 1] - offsets[v.index]};
  }
};

/// O(half-edges). Errors: kOutOfMemory.
[[nodiscard]] VKMESH_API Result<VertexCorners> vertex_corners(const HalfEdgeMesh& mesh);

}  // namespace vkmesh
