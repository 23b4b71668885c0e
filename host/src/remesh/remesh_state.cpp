#include "remesh/remesh_state.h"

namespace vkmesh::detail {

Foot RemeshState::original_at(std::uint32_t h) const {
  const std::uint32_t v = mesh.origin(h);
  const RemeshVertex& vertex = mesh.vertices[v];
  if (vertex.is_free()) return surface.nearest_in(vertex.place, vertex.position);
  // Clockwise to the curve that bounds the sector of h.
  std::uint32_t g = h;
  do {
    if (is_curve(g)) {
      const std::uint32_t curve = curve_of(g);
      const double here = along(curve, v);
      return curves.beside(curve, here, along(curve, mesh.target(g)) > here);
    }
    g = EditFaces::next(mesh.twin(g));
  } while (g != h);
  const std::uint32_t f = surface.mesh().leadings()[vertex.place] / 3;
  return surface.nearest_in(f, vertex.position);
}

std::uint32_t RemeshState::original_near(std::uint32_t h) const {
  for (const std::uint32_t g : {h, RemeshMesh::next(h), RemeshMesh::previous(h)})
    if (const RemeshVertex& vertex = mesh.vertices[mesh.origin(g)]; vertex.is_free()) return vertex.place;
  return original_at(h).face;
}

}  // namespace vkmesh::detail
