#include <algorithm>

#include <vkmesh/passes/vertex_normals.h>

#include "catching.h"
#include "parallel.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// A triangle's normal as it counts at the corner p0.
Vec3 weighted_by_angle(Vec3 normal, Vec3 p0, Vec3 p1, Vec3 p2) {
  const float angle = corner_angle(corner_product(p0, p1, p2), vector_length(area_vector(p0, p1, p2)));
  return zero_below(angle, VKMESH_TINY_DIRECTION) * normal;
}

}  // namespace

Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                         const VertexNormalsOptions& options) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(detail::require_triangles(mesh, "vertex_normals"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    const std::span<const Vec3> p = positions;
    const auto corners = mesh.origins();
    // Scattering over ascending faces adds in the order in which the shader gathers. The areas are computed
    // by all cores, a block at a time that stays in the cache.
    constexpr std::size_t kBlock = 1 << 16, kGrain = 1 << 13;
    const bool by_angle = options.weights == NormalWeights::kAngle;
    std::vector<Vec3> normals(p.size(), Vec3(0.0f)), areas(std::min(kBlock, mesh.face_count()));
    std::vector<Vec3> by_corner(by_angle ? 3 * areas.size() : 0);
    for (std::size_t first = 0; first < mesh.face_count(); first += kBlock) {
      const std::size_t count = std::min(kBlock, mesh.face_count() - first);
      const auto block = corners.subspan(3 * first, 3 * count);
      detail::parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
          areas[f] = area_vector(p[block[3 * f]], p[block[3 * f + 1]], p[block[3 * f + 2]]);
        if (options.weights == NormalWeights::kArea) return;
        detail::to_unit_vectors(std::span(areas).subspan(begin, end - begin));
        if (!by_angle) return;
        for (std::size_t f = begin; f < end; ++f)
          for (std::size_t i = 0; i < 3; ++i)
            by_corner[3 * f + i] = weighted_by_angle(
                areas[f], p[block[3 * f + i]], p[block[3 * f + (i + 1) % 3]], p[block[3 * f + (i + 2) % 3]]);
      });
      if (by_angle)
        for (std::size_t h = 0; h < 3 * count; ++h) normals[block[h]] += by_corner[h];
      else
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
