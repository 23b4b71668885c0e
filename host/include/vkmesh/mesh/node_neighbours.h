// Vertex adjacency (CSR): for each vertex its neighbours in cyclic order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// A. K. Cline and R. L. Renka, "A storage-efficient method for construction of a Thiessen triangulation"
/// (1984): the neighbours of every node in counter-clockwise order, packed. What smoothing gathers over.
/// Memory: 4 bytes a directed edge, 4 bytes and a bit a vertex.
struct NodeNeighbours {
  std::vector<std::uint32_t>
      offsets;  ///< vertices + 1; the neighbours of v are [offsets[v], offsets[v + 1]).
  std::vector<std::uint32_t> ids;
  /// Bit v (word v / 32, bit v % 32): v lies on the boundary, its first and last neighbours are joined to it
  /// by boundary edges, and there is no face between them.
  std::vector<std::uint32_t> boundary_bits;

  [[nodiscard]] std::size_t vertex_count() const { return offsets.empty() ? 0 : offsets.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> of(VertexId v) const {
    return {ids.data() + offsets[v.index], offsets[v.index + 1] - offsets[v.index]};
  }
  [[nodiscard]] bool is_boundary(VertexId v) const {
    return ((boundary_bits[v.index / 32] >> (v.index % 32)) & 1u) != 0;
  }
};

/// O(half-edges). Any polygon mesh; faces of more than three corners are not seen in the lists.
/// Errors: kOutOfMemory.
[[nodiscard]] VKMESH_API Result<NodeNeighbours> node_neighbours(const HalfEdgeMesh& mesh);

/// The triangle mesh of which these are the neighbour lists; triangles by their smallest vertex, then in its
/// cyclic order. O(edges). Errors: kUnsuitable when the lists are those of no triangle mesh.
[[nodiscard]] VKMESH_API Result<HalfEdgeMesh> to_half_edge_mesh(const NodeNeighbours& neighbours);

}  // namespace vkmesh
