// Triangles with their neighbours: for each corner the triangle across the opposite edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/handles.h>

namespace vkmesh {

/// A triangle [v_i, v_j, v_k] has neighbours t_i, t_j, t_k: t_i is joined to it along [v_j, v_k], the edge
/// opposite v_i. Each vertex has a leading triangle; on the boundary it starts the vertex's fan. Memory: 24
/// bytes a triangle, 4 a vertex (52 bytes a vertex on a closed mesh, as half-edges).
struct VKMESH_API TriangleNeighbours {
  std::vector<std::uint32_t> corners;     ///< Vertices, three a triangle, counter-clockwise.
  std::vector<std::uint32_t> neighbours;  ///< Triangles, three a triangle; kInvalid across the boundary.
  std::vector<std::uint32_t> leading;     ///< A triangle for each vertex; kInvalid when it is isolated.

  [[nodiscard]] std::size_t triangle_count() const { return corners.size() / 3; }
  [[nodiscard]] std::size_t vertex_count() const { return leading.size(); }

  // O(1). Handles must be valid and of this mesh.
  [[nodiscard]] std::array<VertexId, 3> vertices_of(FaceId t) const {
    const std::uint32_t* c = &corners[3 * std::size_t{t.index}];
    return {VertexId(c[0]), VertexId(c[1]), VertexId(c[2])};
  }
  /// The neighbour opposite each vertex; invalid across the boundary.
  [[nodiscard]] std::array<FaceId, 3> neighbours_of(FaceId t) const {
    const std::uint32_t* n = &neighbours[3 * std::size_t{t.index}];
    return {FaceId(n[0]), FaceId(n[1]), FaceId(n[2])};
  }
  /// The place of v in t: 0, 1 or 2; 3 when it is no corner of it.
  [[nodiscard]] unsigned place(FaceId t, VertexId v) const {
    unsigned i = 0;
    while (i < 3 && corners[3 * std::size_t{t.index} + i] != v.index) ++i;
    return i;
  }
  [[nodiscard]] bool is_isolated(VertexId v) const { return leading[v.index] == kInvalid; }
  [[nodiscard]] bool is_boundary(VertexId v) const {
    if (is_isolated(v)) return false;
    const FaceId t(leading[v.index]);
    return !across(t, (place(t, v) + 2) % 3).valid();
  }

  // Time proportional to the answer.

  /// Calls f(FaceId) with each triangle that holds v, counter-clockwise, from the leading one.
  template <class F>
  void for_each_triangle(VertexId v, F&& f) const {
    const FaceId start(leading[v.index]);
    for (FaceId t = start; t.valid();) {
      f(t);
      t = across(t, (place(t, v) + 1) % 3);
      if (t == start) return;
    }
  }
  /// Calls f(VertexId) with each neighbour of v, counter-clockwise; on a boundary vertex from one boundary
  /// edge to the other.
  template <class F>
  void for_each_neighbour(VertexId v, F&& f) const {
    const FaceId start(leading[v.index]);
    for (FaceId t = start; t.valid();) {
      const unsigned i = place(t, v);
      f(VertexId(corners[3 * std::size_t{t.index} + (i + 1) % 3]));
      const FaceId next = across(t, (i + 1) % 3);
      if (!next.valid()) f(VertexId(corners[3 * std::size_t{t.index} + (i + 2) % 3]));
      if (next == start) return;
      t = next;
    }
  }
  /// The triangles that hold the edge from a to b, the one in which b follows a first; invalid where there
  /// is none. O(valence of a).
  [[nodiscard]] std::array<FaceId, 2> triangles_of_edge(VertexId a, VertexId b) const;

 private:
  /// The neighbour opposite corner i of t.
  [[nodiscard]] FaceId across(FaceId t, unsigned i) const {
    return FaceId(neighbours[3 * std::size_t{t.index} + i]);
  }
};

/// O(half-edges). Triangle t has the corners of face t. Errors: kUnsuitable for polygons; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<TriangleNeighbours> triangle_neighbours(const HalfEdgeMesh& mesh);

/// The inverse. Half-edge 3t + i starts at corner i of triangle t. O(triangles). Errors: kUnsuitable when
/// the arrays are those of no oriented manifold; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<HalfEdgeMesh> to_half_edge_mesh(const TriangleNeighbours& triangles);

}  // namespace vkmesh
