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

}  // namespace

void sum_quadrics(CollapseMesh& mesh, float boundary_weight) {
  constexpr std::uint32_t kAhead = 16;
  const auto last = static_cast<std::uint32_t>(mesh.face_count()) - 1;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const CollapseMesh::Face& face = mesh.face(4 * f);
    for (const std::uint32_t v : mesh.face(4 * std::min(f + kAhead, last)).origin)
      prefetch(&mesh.vertices[v]);
    std::array<CollapseVertex*, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) v[i] = &mesh.vertices[face.origin[i]];
    const auto side = [&](std::size_t i) {
      const auto &a = v[i]->position, &b = v[(i + 1) % 3]->position;
      return std::array<float, 3>{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    };
    const std::array<float, 3> s = side(0), r = side(1);
    std::array<float, 3> n = {s[1] * r[2] - s[2] * r[1], s[2] * r[0] - s[0] * r[2],
                              s[0] * r[1] - s[1] * r[0]};
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) continue;
    for (float& x : n) x /= length;
    for (CollapseVertex* corner : v) add_plane(*corner, n, 0.5f * length);
    if (!(boundary_weight > 0)) continue;
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (!mesh.is_ghost(face.twin[i])) continue;
      const std::array<float, 3> e = side(i);
      const float area = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
      if (!(area > 0)) continue;
      const float root = std::sqrt(area);
      const std::array<float, 3> across = {(e[1] * n[2] - e[2] * n[1]) / root,
                                           (e[2] * n[0] - e[0] * n[2]) / root,
                                           (e[0] * n[1] - e[1] * n[0]) / root};
      add_plane(*v[i], across, boundary_weight * area);
      add_plane(*v[(i + 1) % 3], across, boundary_weight * area);
    }
  }
}

}  // namespace vkmesh::detail
