// What is left of a mesh that was edited, as a mesh whose numbers have no gaps.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <vkmesh/mesh/half_edge_mesh.h>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "base/parallel_filter.h"
#include "mesh/edit/edit_mesh.h"

namespace vkmesh::detail {

/// `vertices` and `faces`: the number in the edited mesh of each, ascending.
struct Gathered {
  HalfEdgeMesh mesh;
  std::vector<std::uint32_t> vertices, faces;
};

/// Vertices and faces that are left in the order of their records; `leading` as to_half_edge_mesh() sets it:
/// the boundary half-edge, or the first. Isolated vertices stay. O(n).
template <class Vertex>
Gathered gather(const EditMesh<Vertex>& edited) {
  Gathered result;
  result.vertices = collect(edited.vertex_bound(), [&](std::uint32_t v) {
    const std::uint32_t leading = edited.vertices[v].leading;
    return v != edited.apex() && (leading == kInvalid || (leading & kVertexGone) == 0);
  });
  result.faces = collect(edited.face_count(), [&](std::uint32_t f) { return edited.alive(4 * f); });
  std::vector<std::uint32_t> new_vertex(edited.vertex_bound(), kInvalid), new_face(edited.face_count());
  for (std::uint32_t i = 0; i < result.vertices.size(); ++i) new_vertex[result.vertices[i]] = i;
  for (std::uint32_t i = 0; i < result.faces.size(); ++i) new_face[result.faces[i]] = i;
  auto origin = large_vector<std::uint32_t>(3 * result.faces.size()),
       twin = large_vector<std::uint32_t>(origin.size());
  parallel_ranges(result.faces.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const EditFaces::Face& face = edited.face(4 * result.faces[f]);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t t = face.twin[i];
        origin[3 * f + i] = new_vertex[face.origin[i]];
        twin[3 * f + i] = edited.is_ghost(t) ? kInvalid : 3 * new_face[t / 4] + t % 4;
      }
    }
  });
  result.mesh = HalfEdgeMesh::from_twins(std::move(origin), std::move(twin), result.vertices.size());
  return result;
}

}  // namespace vkmesh::detail
