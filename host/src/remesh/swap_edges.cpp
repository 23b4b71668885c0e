// Swaps of edges, for valences and for angles.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "remesh/remesh_state.h"

namespace vkmesh::detail {
namespace {

/// An edge that may swap, with a measure of its two faces and of the two that would take their place.
struct Swap {
  std::uint32_t p, q, a, b;  // the edge p → q becomes b → a
  double worst_before, worst_after;
  bool keeps_surface;
};

Swap look_at(const RemeshState& state, std::uint32_t h) {
  const RemeshMesh& mesh = state.mesh;
  const std::uint32_t t = mesh.twin(h);
  Swap swap{mesh.origin(h),
            mesh.origin(t),
            mesh.origin(RemeshMesh::previous(h)),
            mesh.origin(RemeshMesh::previous(t)),
            0,
            0,
            false};
  const DVec3 &p = state.position(swap.p), &q = state.position(swap.q), &a = state.position(swap.a),
              &b = state.position(swap.b);
  swap.worst_before = std::min(shape_of(p, q, a), shape_of(q, p, b));
  swap.worst_after = std::min(shape_of(p, b, a), shape_of(q, a, b));
  const DVec3 n = area_vector(p, q, a), m = area_vector(q, p, b), around = n + m,
              n_after = area_vector(p, b, a), m_after = area_vector(q, a, b);
  swap.keeps_surface = keeps_side(around, n_after, around, kCosMostTurn) &&
                       keeps_side(around, m_after, around, kCosMostTurn) &&
                       cosine(n_after, m_after) >= std::min(cosine(n, m), kCosMostBend);
  return swap;
}

/// Calls swap(h) once with each edge that may be swapped as far as tags say.
template <class Body>
std::size_t for_each_edge(RemeshState& state, Body&& body) {
  RemeshMesh& mesh = state.mesh;
  std::size_t swaps = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!mesh.alive(4 * f)) continue;
    if (state.is_stopped(f)) break;
    for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h)
      if (const std::uint32_t t = mesh.twin(h); h < t && !mesh.is_ghost(t) && !state.is_curve(h))
        // Across from it are two vertices, but where two faces are back to back.
        if (mesh.origin(RemeshMesh::previous(h)) != mesh.origin(RemeshMesh::previous(t)))
          swaps += body(h) ? 1 : 0;
  }
  return swaps;
}

/// Swaps unless that would part the surface from the original.
bool apply(RemeshState& state, const Swap& swap, std::uint32_t h) {
  RemeshMesh& mesh = state.mesh;
  if (state.deviation.is_set()) {
    const std::uint32_t t = mesh.twin(h);
    const DVec3 &p = state.position(swap.p), &q = state.position(swap.q), &a = state.position(swap.a),
                &b = state.position(swap.b);
    const std::array gone = {h / 4, t / 4};
    const std::array<DeviationBound::Face, 2> made = {
        {{h / 4, {b, a, p}, state.original_near(h)}, {t / 4, {a, b, q}, state.original_near(t)}}};
    if (!state.deviation.allows(gone, made)) return false;
    state.deviation.replace();
  }
  mesh.flip(h);
  --mesh.vertices[swap.p].valence;
  --mesh.vertices[swap.q].valence;
  ++mesh.vertices[swap.a].valence;
  ++mesh.vertices[swap.b].valence;
  return true;
}

}  // namespace

std::size_t swap_for_valence(RemeshState& state) {
  RemeshMesh& mesh = state.mesh;
  const auto excess = [&](std::uint32_t v) {
    return static_cast<int>(mesh.vertices[v].valence) - static_cast<int>(mesh.vertices[v].best_valence);
  };
  return for_each_edge(state, [&](std::uint32_t h) {
    const std::uint32_t t = mesh.twin(h);
    const int p = excess(mesh.origin(h)), q = excess(mesh.origin(t)),
              a = excess(mesh.origin(RemeshMesh::previous(h))),
              b = excess(mesh.origin(RemeshMesh::previous(t)));
    // The sum of squares falls by 2 (p + q - a - b) - 4.
    if (p + q - a - b <= 2) return false;
    const Swap swap = look_at(state, h);
    if (!swap.keeps_surface || swap.worst_after < std::min(swap.worst_before, kShape15) || !mesh.can_flip(h))
      return false;
    return apply(state, swap, h);
  });
}

std::size_t swap_for_angles(RemeshState& state) {
  RemeshMesh& mesh = state.mesh;
  return for_each_edge(state, [&](std::uint32_t h) {
    const Swap swap = look_at(state, h);
    if (!(swap.worst_after > swap.worst_before) || !swap.keeps_surface || !mesh.can_flip(h)) return false;
    return apply(state, swap, h);
  });
}

}  // namespace vkmesh::detail
