#include <algorithm>

#include <vkmesh/passes/dihedral_angles.h>

#include "catching.h"
#include "passes/pass_input.h"

namespace vkmesh {

Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<DihedralAngles> {
    VKMESH_CHECK(detail::require_triangles(mesh, "dihedral_angles"));
    VKMESH_TRY(const std::vector<Vec3> p, detail::prepared(positions, mesh.vertex_count()));
    const auto corners = mesh.origins(), twins = mesh.twins();
    std::vector<Vec3> normals(mesh.face_count());
    for (std::size_t f = 0; f < normals.size(); ++f)
      normals[f] = unit_vector(area_vector(p[corners[3 * f]], p[corners[3 * f + 1]], p[corners[3 * f + 2]]));

    DihedralAngles result;
    result.half_edge.assign(corners.size(), 0.0f);
    result.vertex_maximum.assign(p.size(), 0.0f);
    for (std::uint32_t h = 0; h < corners.size(); ++h) {
      const std::uint32_t t = twins[h];
      if (t == kInvalid || t < h) continue;
      const float angle = angle_between(normals[h / 3], normals[t / 3]);
      result.half_edge[h] = result.half_edge[t] = angle;
      for (const std::uint32_t end : {corners[h], corners[t]})
        result.vertex_maximum[end] = std::max(result.vertex_maximum[end], angle);
    }
    return result;
  });
}

}  // namespace vkmesh
