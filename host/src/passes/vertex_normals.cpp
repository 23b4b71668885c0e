#include <vkmesh/passes/vertex_normals.h>

#include "catching.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {

Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(detail::require_triangles(mesh, "vertex_normals"));
    VKMESH_TRY(const std::vector<Vec3> p, detail::prepared(positions, mesh.vertex_count()));
    const auto corners = mesh.origins();
    // Scattering over ascending faces adds in the order in which the shader gathers.
    std::vector<Vec3> normals(p.size(), Vec3(0.0f));
    for (std::size_t h = 0; h < corners.size(); h += 3) {
      const Vec3 area = area_vector(p[corners[h]], p[corners[h + 1]], p[corners[h + 2]]);
      for (std::size_t i = 0; i < 3; ++i) normals[corners[h + i]] += area;
    }
    detail::to_unit_vectors(normals);
    return normals;
  });
}

}  // namespace vkmesh
