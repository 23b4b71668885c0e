// The link condition: whether the surface stays a manifold of the same topology.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/edit/collapse_mesh.h"

namespace vkmesh::detail {

/// Whether an edge may collapse (T. Dey, H. Edelsbrunner, S. Guha, D. Nekhayev, "Topology preserving edge
/// contraction", 1999): its ends share two neighbours, those across its faces, and the four are no
/// tetrahedron. `ring_p`, `ring_q`: the neighbours of each end but the other, counter-clockwise, so that each
/// ring starts with one of the two and ends with the other. No two edges join the same vertices. `sorted` is
/// scratch. O((p + q) log p).
[[nodiscard]] inline bool meets_link_condition(std::span<const std::uint32_t> ring_p,
                                               std::span<const std::uint32_t> ring_q,
                                               std::vector<std::uint32_t>& sorted) {
  if (ring_p.front() == ring_p.back()) return false;
  if (ring_p.size() == 2 && ring_q.size() == 2) return false;
  sorted.assign(ring_p.begin() + 1, ring_p.end() - 1);
  std::sort(sorted.begin(), sorted.end());
  return std::none_of(ring_q.begin() + 1, ring_q.end() - 1,
                      [&](std::uint32_t v) { return std::binary_search(sorted.begin(), sorted.end(), v); });
}

/// Whether an edge joins p and q, which are not isolated. It walks around both at once, since one may have
/// many edges: O(the smaller valence). Filling a hole may not make an edge that is there.
[[nodiscard]] inline bool has_edge(const CollapseMesh& mesh, std::uint32_t p, std::uint32_t q) {
  const std::uint32_t p0 = mesh.vertices[p].leading, q0 = mesh.vertices[q].leading;
  std::uint32_t at_p = p0, at_q = q0;
  do {
    if (mesh.target(at_p) == q || mesh.target(at_q) == p) return true;
    at_p = mesh.around_vertex(at_p);
    at_q = mesh.around_vertex(at_q);
  } while (at_p != p0 && at_q != q0);
  return false;
}

/// Whether a vertex, by all edges that leave it, is the tip of a tetrahedron: the face that fills its hole
/// would be there already.
[[nodiscard]] inline bool is_tip_of_tetrahedron(const CollapseMesh& mesh,
                                                std::span<const std::uint32_t> edges) {
  const auto beyond = [&](std::size_t i) { return mesh.twin(CollapseMesh::next(edges[i])) >> 2; };
  return edges.size() == 3 && beyond(0) == beyond(1);
}

}  // namespace vkmesh::detail
