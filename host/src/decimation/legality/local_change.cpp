#include "decimation/legality/local_change.h"

#include <glm/geometric.hpp>

namespace vkmesh::detail {

void take_star(Star& star, const CollapseMesh& mesh, std::uint32_t h, const std::array<float, 3>& place) {
  star.clear();
  const std::uint32_t t = mesh.twin(h);
  const DVec3 there = point_of(place), at_p = point_of(mesh.vertices[mesh.origin(h)].position),
              at_q = point_of(mesh.vertices[mesh.origin(t)].position);
  star.length2 = glm::dot(at_q - at_p, at_q - at_p);
  star.inner_after.push_back(there);
  if (there != at_p) star.inner_before.push_back(at_p);
  if (there != at_q) star.inner_before.push_back(at_q);
  for (const std::uint32_t side : {h, t})
    if (!mesh.is_ghost(side)) star.before.push_back(face_of(mesh, side >> 2));
  const auto add_others_at = [&](std::uint32_t start) {
    for (std::uint32_t out = mesh.around_vertex(start); out != start; out = mesh.around_vertex(out)) {
      if (mesh.is_ghost(out) || (out >> 2) == (h >> 2) || (out >> 2) == (t >> 2)) continue;
      star.before.push_back(face_of(mesh, out >> 2));
      star.after.push_back(star.before.back());
      star.after.back().corner[out & 3u] = there;
    }
  };
  if (there != at_p) add_others_at(h);
  if (there != at_q) add_others_at(t);
  // Where nothing moves, or an ear of the boundary goes, the faces beside it are in its place.
  if (star.after.empty())
    for (const std::uint32_t start : {h, t}) add_others_at(start);
}

}  // namespace vkmesh::detail
