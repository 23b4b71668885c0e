#include <vkmesh/passes/curvatures.h>

#include "catching.h"
#include "parallel.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// What one triangle gives to the vertex `here`; its other corners are q and r.
struct Share {
  Vec3 area_vector{0.0f};
  float at_q = 0.0f, at_r = 0.0f;  // Cotangents.
  float angle = 0.0f;
  float area = 0.0f;  // Eight times.
};

float squared_distance(Vec3 a, Vec3 b) {
  return squared_length(zero_below(b - a, VKMESH_TINY_LENGTH));
}

Share share(Vec3 here, Vec3 q, Vec3 r) {
  Share s;
  s.area_vector = area_vector(here, q, r);
  const float twice_area = vector_length(s.area_vector);
  const float product = corner_product(here, q, r);
  s.at_q = cotangent(corner_product(q, r, here), twice_area);
  s.at_r = cotangent(corner_product(r, here, q), twice_area);
  s.angle = corner_angle(product, twice_area);
  const float voronoi = zero_below(squared_distance(here, q) * s.at_r, VKMESH_TINY_AREA) +
                        zero_below(squared_distance(here, r) * s.at_q, VKMESH_TINY_AREA);
  const bool obtuse_elsewhere = s.at_q < 0.0f || s.at_r < 0.0f;
  s.area = product < 0.0f ? 2.0f * twice_area : (obtuse_elsewhere ? twice_area : voronoi);
  return s;
}

VertexCurvature curvature_at(std::span<const Vec3> p, Vec3 here, std::span<const std::uint32_t> ring,
                             bool open) {
  Vec3 q = p[ring.front()];
  float before = open ? 0.0f : share(here, p[ring.back()], q).at_q;
  Vec3 laplacian(0.0f), normal(0.0f);
  float angles = 0.0f, area = 0.0f;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec3 r = p[ring[k + 1 == ring.size() ? 0 : k + 1]];
    const Share s = open && k + 1 == ring.size() ? Share{} : share(here, q, r);
    const float weight = zero_below(before + s.at_r, VKMESH_TINY_DIRECTION);
    laplacian += weight * zero_below(here - q, VKMESH_TINY_LENGTH);
    normal += s.area_vector;
    angles += s.angle;
    area += s.area;
    before = s.at_q;
    q = r;
  }
  VertexCurvature result;
  const float whole = open ? 1.0f : 2.0f;
  result.angle_defect = (whole * (2.0f * VKMESH_HALF_PI_HIGH) - angles) + whole * (2.0f * VKMESH_HALF_PI_LOW);
  result.area = 0.125f * area;
  if (open) return result;
  const Vec3 a = unit_vector(laplacian), b = unit_vector(normal);
  const float along = (a.x * b.x + a.y * b.y) + a.z * b.z;
  const float size = bounded_quotient(vector_length(laplacian), 0.5f * area, VKMESH_CURVATURE_BOUND,
                                      VKMESH_CURVATURE_BOUND_INVERSE);
  result.mean = along < 0.0f ? -size : size;
  result.gaussian = bounded_quotient(result.angle_defect, result.area, VKMESH_CURVATURE_BOUND,
                                     VKMESH_CURVATURE_BOUND_INVERSE);
  return result;
}

}  // namespace

Result<std::vector<VertexCurvature>> curvatures(const NodeNeighbours& neighbours,
                                                std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<VertexCurvature>> {
    VKMESH_CHECK(detail::require_positions(positions, neighbours.vertex_count()));
    std::vector<VertexCurvature> result(positions.size());
    detail::parallel_ranges(result.size(), 1 << 11, [&](std::size_t begin, std::size_t end) {
      for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
        const auto ring = neighbours.of(VertexId(v));
        if (!ring.empty())
          result[v] = curvature_at(positions, positions[v], ring, neighbours.is_boundary(VertexId(v)));
      }
    });
    return result;
  });
}

}  // namespace vkmesh
