// Walks over the faces of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <utility>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// Calls visit(FaceId, steps) with `start` and the faces around it in order of the number of edges to cross,
/// those of one number in the order in which they are met, until visit returns false or the component is
/// walked. Expected time and memory proportional to the faces visited. Errors: kOutOfMemory; kInternal with
/// the words of what visit throws.
template <class Visit>
[[nodiscard]] Result<void> walk_breadth_first(const HalfEdgeMesh& mesh, FaceId start, Visit&& visit) {
  return detail::catching([&]() -> Result<void> {
    std::unordered_set<std::uint32_t> seen = {start.index};
    std::vector<FaceId> ring = {start}, next;
    for (std::size_t steps = 0; !ring.empty(); ++steps, std::swap(ring, next), next.clear())
      for (const FaceId f : ring) {
        if (!visit(f, steps)) return {};
        for (const FaceId g : mesh.faces_around(f))
          if (g.valid() && seen.insert(g.index).second) next.push_back(g);
      }
    return {};
  });
}

}  // namespace vkmesh
