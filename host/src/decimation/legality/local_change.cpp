#include "decimation/legality/local_change.h"

#include <glm/geometric.hpp>

namespace vkmesh::detail {

void record_length(LocalChange& change, const CollapseMesh& mesh, std::uint32_t h) {
  change.clear();
  const DVec3 way =
      point_of(mesh.vertices[mesh.target(h)].position) - point_of(mesh.vertices[mesh.origin(h)].position);
  change.length2 = glm::dot(way, way);
}

void record_collapse(LocalChange& change, const CollapseMesh& mesh, std::uint32_t h,
                     const std::array<float, 3>& place, std::size_t most) {
  record_length(change, mesh, h);
  const std::uint32_t t = mesh.twin(h);
  const DVec3 there = point_of(place), at_p = point_of(mesh.vertices[mesh.origin(h)].position),
              at_q = point_of(mesh.vertices[mesh.origin(t)].position);
  change.inner_after.push_back(there);
  if (there != at_p) change.inner_before.push_back(at_p);
  if (there != at_q) change.inner_before.push_back(at_q);
  for (const std::uint32_t side : {h, t})
    if (!mesh.is_ghost(side)) change.before.push_back(face_of(mesh, side >> 2));
  const auto add_others_at = [&](std::uint32_t start) {
    std::size_t left = most;
    for (std::uint32_t out = mesh.around_vertex(start); out != start && left > 0;
         out = mesh.around_vertex(out), --left) {
      if (mesh.is_ghost(out) || (out >> 2) == (h >> 2) || (out >> 2) == (t >> 2)) continue;
      change.before.push_back(face_of(mesh, out >> 2));
      change.after.push_back(change.before.back());
      change.after.back().corner[out & 3u] = there;
    }
  };
  if (there != at_p) add_others_at(h);
  if (there != at_q) add_others_at(t);
  // Where nothing moves, or an ear of the boundary goes, the faces beside it are in its place.
  if (change.after.empty())
    for (const std::uint32_t start : {h, t}) add_others_at(start);
}

}  // namespace vkmesh::detail
