#include <algorithm>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/node_neighbours.h>

#include "mesh/edge_matching.h"

namespace vkmesh {

Result<NodeNeighbours> node_neighbours(const HalfEdgeMesh& mesh) {
  return detail::catching([&]() -> Result<NodeNeighbours> {
    const std::size_t vertices = mesh.vertex_count();
    NodeNeighbours result;
    result.offsets.resize(vertices + 1);
    result.boundary_bits.assign((vertices + 31) / 32, 0);
    // Each fan has a neighbour for each half-edge; an open one has one more, and one boundary half-edge.
    result.ids.resize(mesh.half_edge_count() + mesh.boundary_half_edge_count());
    std::uint32_t filled = 0;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      result.offsets[v] = filled;
      mesh.for_each_neighbour(VertexId(v), [&](VertexId n) { result.ids[filled++] = n.index; });
      if (mesh.is_boundary(VertexId(v))) result.boundary_bits[v / 32] |= 1u << (v % 32);
    }
    result.offsets[vertices] = filled;
    return result;
  });
}

Result<HalfEdgeMesh> to_half_edge_mesh(const NodeNeighbours& neighbours) {
  return detail::catching([&]() -> Result<HalfEdgeMesh> {
    const std::size_t vertices = neighbours.vertex_count();
    const auto unsuitable = [] {
      return fail(ErrorCode::kUnsuitable, "these neighbour lists are not those of a triangle mesh");
    };
    if (!std::is_sorted(neighbours.offsets.begin(), neighbours.offsets.end()) ||
        neighbours.boundary_bits.size() != (vertices + 31) / 32 ||
        (vertices > 0 &&
         (neighbours.offsets.front() != 0 || neighbours.offsets.back() != neighbours.ids.size())))
      return unsuitable();
    for (const std::uint32_t id : neighbours.ids)
      if (id >= vertices) return unsuitable();

    // Each triangle appears in the lists of its three vertices: take it from the smallest.
    std::vector<std::uint32_t> corners;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      const auto around = neighbours.of(VertexId(v));
      const std::size_t pairs =
          neighbours.is_boundary(VertexId(v)) ? std::max<std::size_t>(around.size(), 1) - 1 : around.size();
      for (std::size_t i = 0; i < pairs; ++i) {
        const std::uint32_t a = around[i], b = around[i + 1 == around.size() ? 0 : i + 1];
        if (v < a && v < b) corners.insert(corners.end(), {v, a, b});
      }
    }
    VKMESH_TRY(detail::Matching matching, detail::match_edges(vertices, corners, {}));
    if (!matching.defects.none()) return unsuitable();
    HalfEdgeMesh mesh =
        HalfEdgeMesh::from_arrays(std::move(corners), std::move(matching.twin), std::move(matching.leading));

    // The lists may still name triangles that the smallest vertex does not know: compare with those of the
    // result.
    VKMESH_TRY(const NodeNeighbours again, node_neighbours(mesh));
    if (again.offsets != neighbours.offsets || again.boundary_bits != neighbours.boundary_bits)
      return unsuitable();
    for (std::uint32_t v = 0; v < vertices; ++v) {
      const auto ours = again.of(VertexId(v)), theirs = neighbours.of(VertexId(v));
      if (ours.empty()) continue;
      const auto start = std::find(theirs.begin(), theirs.end(), ours[0]);
      const bool turned = start != theirs.begin();  // of a closed fan any neighbour may come first
      if (start == theirs.end() || (turned && again.is_boundary(VertexId(v))) ||
          !std::equal(start, theirs.end(), ours.begin()) ||
          !std::equal(theirs.begin(), start, ours.begin() + (theirs.end() - start)))
        return unsuitable();
    }
    return mesh;
  });
}

}  // namespace vkmesh
