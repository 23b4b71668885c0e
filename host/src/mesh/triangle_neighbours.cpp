#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/triangle_neighbours.h>

namespace vkmesh {

std::array<FaceId, 2> TriangleNeighbours::triangles_of_edge(VertexId a, VertexId b) const {
  std::array<FaceId, 2> found;
  for_each_triangle(a, [&](FaceId t) {
    const unsigned i = place(t, a);
    if (corners[3 * std::size_t{t.index} + (i + 1) % 3] == b.index) found[0] = t;
    if (corners[3 * std::size_t{t.index} + (i + 2) % 3] == b.index) found[1] = t;
  });
  return found;
}

Result<TriangleNeighbours> triangle_neighbours(const HalfEdgeMesh& mesh) {
  return detail::catching([&]() -> Result<TriangleNeighbours> {
    if (!mesh.is_triangles())
      return fail(ErrorCode::kUnsuitable, "only triangles have a neighbour opposite each corner");
    TriangleNeighbours result;
    result.corners.assign(mesh.origins().begin(), mesh.origins().end());
    result.neighbours.resize(mesh.half_edge_count());
    // The edge opposite corner i runs from corner i + 1: it is the next half-edge.
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      const HalfEdgeId twin = mesh.twin(mesh.next(HalfEdgeId(h)));
      result.neighbours[h] = twin.valid() ? twin.index / 3 : kInvalid;
    }
    result.leading.resize(mesh.vertex_count());
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      const HalfEdgeId h = mesh.leading(VertexId(v));
      result.leading[v] = h.valid() ? h.index / 3 : kInvalid;
    }
    return result;
  });
}

Result<HalfEdgeMesh> to_half_edge_mesh(const TriangleNeighbours& triangles) {
  return detail::catching([&]() -> Result<HalfEdgeMesh> {
    const std::size_t corners = triangles.corners.size(), vertices = triangles.vertex_count();
    const auto unsuitable = [](const std::string& why) {
      return fail(ErrorCode::kUnsuitable, "these triangles are no oriented manifold: " + why);
    };
    if (corners % 3 != 0 || triangles.neighbours.size() != corners || corners >= kInvalid)
      return unsuitable("there must be three corners and three neighbours for each triangle");
    for (const std::uint32_t v : triangles.corners)
      if (v >= vertices) return unsuitable("a corner names vertex " + std::to_string(v));
    std::vector<std::uint32_t> twin(corners, kInvalid), leading(vertices, kInvalid);
    for (std::uint32_t c = 0; c < corners; ++c) {
      const std::uint32_t t = c / 3, h = 3 * t + (c + 1) % 3, other = triangles.neighbours[c];
      if (other == kInvalid) continue;
      if (other >= corners / 3) return unsuitable("a neighbour names triangle " + std::to_string(other));
      const std::uint32_t from = triangles.corners[h], to = triangles.corners[3 * t + (c + 2) % 3];
      for (std::uint32_t i = 0; i < 3; ++i)
        if (triangles.corners[3 * other + i] == to && triangles.corners[3 * other + (i + 1) % 3] == from)
          twin[h] = 3 * other + i;
      if (twin[h] == kInvalid)
        return unsuitable("triangles " + std::to_string(t) + " and " + std::to_string(other) +
                          " are neighbours without a common edge");
    }
    for (std::uint32_t v = 0; v < vertices; ++v) {
      const std::uint32_t t = triangles.leading[v];
      if (t == kInvalid) continue;
      if (t >= corners / 3 || triangles.place(FaceId(t), VertexId(v)) == 3)
        return unsuitable("the leading triangle of vertex " + std::to_string(v) + " does not hold it");
      leading[v] = 3 * t + triangles.place(FaceId(t), VertexId(v));
    }
    HalfEdgeMesh mesh = HalfEdgeMesh::from_arrays(triangles.corners, std::move(twin), std::move(leading));
    if (const auto valid = validate(mesh); !valid) return unsuitable(valid.error().message);
    return mesh;
  });
}

}  // namespace vkmesh
