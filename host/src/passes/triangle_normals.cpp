#include <vkmesh/passes/triangle_normals.h>

#include "catching.h"
#include "large_pages.h"
#include "parallel.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {

Result<std::vector<Vec3>> triangle_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(detail::require_triangles(mesh, "triangle_normals"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    const auto corners = mesh.origins();
    std::vector<Vec3> normals = detail::large_vector<Vec3>(mesh.face_count());
    detail::parallel_ranges(normals.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
      const auto block = std::span(normals).subspan(begin, end - begin);
      detail::area_vectors(positions, corners.subspan(3 * begin, 3 * block.size()), block);
      detail::to_unit_vectors(block);
    });
    return normals;
  });
}

}  // namespace vkmesh
