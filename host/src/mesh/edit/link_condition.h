// The link condition: whether the surface stays a manifold of the same topology.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/edit/edit_mesh.h"

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

/// Whether a vertex, by all edges that leave it, is the tip of a tetrahedron: the face that fills its hole
/// would be there already.
[[nodiscard]] inline bool is_tip_of_tetrahedron(const EditFaces& mesh, std::span<const std::uint32_t> edges) {
  const auto beyond = [&](std::size_t i) { return mesh.twin(EditFaces::next(edges[i])) >> 2; };
  return edges.size() == 3 && beyond(0) == beyond(1);
}

}  // namespace vkmesh::detail
