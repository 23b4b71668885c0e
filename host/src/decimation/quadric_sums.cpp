#include "decimation/quadric_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace vkmesh::detail {
namespace {

/// Adds w (n·x)² to the quadric of a vertex that the plane goes through.
void add_plane(CollapseVertex& v, const std::array<float, 3>& n, float w) {
  v.a[0] += w * n[0] * n[0];
  v.a[1] += w * n[0] * n[1];
  v.a[2] += w * n[0] * n[2];
  v.a[3] += w * n[1] * n[1];
  v.a[4] += w * n[1] * n[2];
  v.a[5] += w * n[2] * n[2];
  v.weight += w;
}

struct AreaVector {
  std::array<float, 3> twice;
  float length;
};
[[gnu::always_inline]] inline AreaVector area_of(const CollapseMesh& mesh, const CollapseMesh::Face& face) {
  const auto &a = mesh.vertices[face.origin[0]].position, &b = mesh.vertices[face.origin[1]].position,
             &c = mesh.vertices[face.origin[2]].position;
  const std::array<float, 3> s = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                             r = {c[0] - b[0], c[1] - b[1], c[2] - b[2]};
  const std::array<float, 3> n = {s[1] * r[2] - s[2] * r[1], s[2] * r[0] - s[0] * r[2],
                                  s[0] * r[1] - s[1] * r[0]};
  return {n, std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])};
}

/// Of the plane that stands on half-edge i of a face of unit normal n; 0: none does.
float constraint(const CollapseMesh& mesh, const CollapseMesh::Face& face, std::uint32_t i,
                 const std::array<float, 3>& n, const ConstraintWeights& weights) {
  if (mesh.is_ghost(face.twin[i])) return weights.boundary;
  const float seam =
      weights.seam > 0 && weights.wedges->is_seam(mesh, mesh.twin(face.twin[i])) ? weights.seam : 0.0f;
  if (!(weights.crease > 0)) return seam;
  const AreaVector other = area_of(mesh, mesh.face(face.twin[i]));
  const float along = n[0] * other.twice[0] + n[1] * other.twice[1] + n[2] * other.twice[2];
  return along < weights.crease_cosine * other.length ? std::max(seam, weights.crease) : seam;
}

}  // namespace

void sum_quadrics(CollapseMesh& mesh, const ConstraintWeights& weights) {
  constexpr std::uint32_t kAhead = 16;
  const auto last = static_cast<std::uint32_t>(mesh.face_count()) - 1;
  const bool constrained = weights.boundary > 0 || weights.crease > 0 || weights.seam > 0;
  mesh.parts().for_each([&, vertices = &mesh.vertices[0]](const VertexParts::Part& part) {
    const auto add = [vertices, part](std::uint32_t v, const std::array<float, 3>& n, float w) {
      if (part.has(v)) add_plane(vertices[v], n, w);
    };
    part.for_each_face([&mesh, &weights, vertices, part, add, last, constrained](std::uint32_t f) {
      const CollapseMesh::Face& face = mesh.face(4 * f);
      for (const std::uint32_t v : mesh.face(4 * std::min(f + kAhead, last)).origin) prefetch(&vertices[v]);
      const auto& [p, q, r] = face.origin;
      if (!part.has(p) && !part.has(q) && !part.has(r)) return;
      const AreaVector area = area_of(mesh, face);
      if (!(area.length > 0)) return;
      std::array<float, 3> n = area.twice;
      for (float& x : n) x /= area.length;
      for (const std::uint32_t v : face.origin) add(v, n, 0.5f * area.length);
      if (!constrained) return;
      for (std::uint32_t i = 0; i < 3; ++i) {
        const float weight = constraint(mesh, face, i, n, weights);
        if (!(weight > 0)) continue;
        const std::uint32_t from = face.origin[i], to = face.origin[(i + 1) % 3];
        const auto &a = vertices[from].position, &b = vertices[to].position;
        const std::array<float, 3> e = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        const float squared = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
        if (!(squared > 0)) continue;
        const float root = std::sqrt(squared);
        const std::array<float, 3> across = {(e[1] * n[2] - e[2] * n[1]) / root,
                                             (e[2] * n[0] - e[0] * n[2]) / root,
                                             (e[0] * n[1] - e[1] * n[0]) / root};
        add(from, across, weight * squared);
        add(to, across, weight * squared);
      }
    });
  });
}

}  // namespace vkmesh::detail
