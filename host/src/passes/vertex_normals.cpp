#include <algorithm>

#include <vkmesh/passes/vertex_normals.h>

#include "catching.h"
#include "parallel.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {

Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(detail::require_triangles(mesh, "vertex_normals"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    const std::span<const Vec3> p = positions;
    const auto corners = mesh.origins();
    // Scattering over ascending faces adds in the order in which the shader gathers. The areas are computed
    // by all cores, a block at a time that stays in the cache.
    constexpr std::size_t kBlock = 1 << 16, kGrain = 1 << 13;
    std::vector<Vec3> normals(p.size(), Vec3(0.0f)), areas(std::min(kBlock, mesh.face_count()));
    for (std::size_t first = 0; first < mesh.face_count(); first += kBlock) {
      const std::size_t count = std::min(kBlock, mesh.face_count() - first);
      const auto block = corners.subspan(3 * first, 3 * count);
      detail::parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
          areas[f] = area_vector(p[block[3 * f]], p[block[3 * f + 1]], p[block[3 * f + 2]]);
      });
      for (std::size_t f = 0; f < count; ++f)
        for (std::size_t i = 0; i < 3; ++i) normals[block[3 * f + i]] += areas[f];
    }
    detail::parallel_ranges(normals.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      detail::to_unit_vectors(std::span(normals).subspan(begin, end - begin));
    });
    return normals;
  });
}

}  // namespace vkmesh
