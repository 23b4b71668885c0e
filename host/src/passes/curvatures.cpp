#include <algorithm>
#include <array>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/curvatures.h>

#include "base/huge_pages.h"
#include "passes/pass_input.h"
#include "passes/valence_groups.h"
#include "simd/target_clones.h"

namespace vkmesh {
namespace {

using detail::RingGroup, detail::RingPoints;
constexpr std::size_t kMost = RingGroup::kMost;

float squared_distance(Vec3 a, Vec3 b) {
  return squared_length(zero_below(b - a, VKMESH_TINY_LENGTH));
}

// What triangles give to their corners `here`; the other corners are q and r.
struct Shares {
  RingPoints area_vector = {};
  float at_q[kMost] = {}, at_r[kMost] = {};  // Cotangents.
  float angle[kMost] = {};
  float area[kMost] = {};  // Eight times.
};
VKMESH_CLONES void compute_shares(Shares& out, const RingPoints& here, const RingPoints& q,
                                  const RingPoints& r, std::size_t count) {
  Shares s;
  float twice_areas[kMost], products[kMost];
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 area = area_vector(here[i], q[i], r[i]);
    s.area_vector.set(i, area);
    twice_areas[i] = vector_length(area);
    products[i] = corner_product(here[i], q[i], r[i]);
  }
  for (std::size_t i = 0; i < count; ++i) s.angle[i] = corner_angle(products[i], twice_areas[i]);
  for (std::size_t i = 0; i < count; ++i) {
    s.at_q[i] = cotangent(corner_product(q[i], r[i], here[i]), twice_areas[i]);
    s.at_r[i] = cotangent(corner_product(r[i], here[i], q[i]), twice_areas[i]);
  }
  float voronoi[kMost];
  for (std::size_t i = 0; i < count; ++i)
    voronoi[i] = zero_below(squared_distance(here[i], q[i]) * s.at_r[i], VKMESH_TINY_AREA) +
                 zero_below(squared_distance(here[i], r[i]) * s.at_q[i], VKMESH_TINY_AREA);
  for (std::size_t i = 0; i < count; ++i) {
    const float not_here = std::min(s.at_q[i], s.at_r[i]) < 0.0f ? twice_areas[i] : voronoi[i];
    s.area[i] = products[i] < 0.0f ? 2.0f * twice_areas[i] : not_here;
  }
  out = s;
}

// Sums around the vertices `here`.
struct Sums {
  RingPoints laplacian = {}, normal = {};
  float angles[kMost] = {}, area[kMost] = {};
};
// The edge to q, between a triangle and the one after it.
VKMESH_CLONES void add(Sums& out, const RingPoints& here, const RingPoints& q, const Shares& before,
                       const Shares& after, std::size_t count) {
  Sums sums = out;
  for (std::size_t i = 0; i < count; ++i) {
    const float weight = zero_below(before.at_q[i] + after.at_r[i], VKMESH_TINY_DIRECTION);
    sums.laplacian.set(i, sums.laplacian[i] + weight * zero_below(here[i] - q[i], VKMESH_TINY_LENGTH));
    sums.normal.set(i, sums.normal[i] + after.area_vector[i]);
    sums.angles[i] += after.angle[i];
    sums.area[i] += after.area[i];
  }
  out = sums;
}

struct Curvatures {
  std::array<float, kMost> mean, gaussian, angle_defect, area;
};
// `whole`: how many half turns there are around each.
VKMESH_CLONES void compute(Curvatures& out, const Sums& sums, float whole, std::size_t count) {
  Curvatures c;
  for (std::size_t i = 0; i < count; ++i) {
    c.angle_defect[i] =
        (whole * (2.0f * VKMESH_HALF_PI_HIGH) - sums.angles[i]) + whole * (2.0f * VKMESH_HALF_PI_LOW);
    c.area[i] = 0.125f * sums.area[i];
  }
  float along[kMost], size[kMost];
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 a = unit_vector(sums.laplacian[i]), b = unit_vector(sums.normal[i]);
    along[i] = (a.x * b.x + a.y * b.y) + a.z * b.z;
  }
  for (std::size_t i = 0; i < count; ++i) {
    size[i] = bounded_quotient(vector_length(sums.laplacian[i]), 0.5f * sums.area[i], VKMESH_CURVATURE_BOUND,
                               VKMESH_CURVATURE_BOUND_INVERSE);
    c.gaussian[i] = bounded_quotient(c.angle_defect[i], c.area[i], VKMESH_CURVATURE_BOUND,
                                     VKMESH_CURVATURE_BOUND_INVERSE);
  }
  for (std::size_t i = 0; i < count; ++i) c.mean[i] = along[i] < 0.0f ? -size[i] : size[i];
  out = c;
}

void curvatures_of(const NodeNeighbours& neighbours, const RingGroup& group, const Vec3* positions,
                   VertexCurvature* out) {
  const std::size_t count = group.vertices.size();
  RingPoints here;
  here.take(group, positions);
  Sums sums;
  detail::go_around<Shares>(group, positions, neighbours, here, compute_shares,
                            [&](const RingPoints& q, const Shares& before, const Shares& after, std::size_t) {
                              add(sums, here, q, before, after, count);
                            });
  Curvatures c;
  compute(c, sums, group.boundary ? 1.0f : 2.0f, count);
  if (group.boundary) c.mean = c.gaussian = {};
  for (std::size_t i = 0; i < count; ++i)
    out[group.vertices[i]] = {c.mean[i], c.gaussian[i], c.angle_defect[i], c.area[i]};
}

}  // namespace

Result<std::vector<VertexCurvature>> curvatures(const NodeNeighbours& neighbours,
                                                std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<VertexCurvature>> {
    VKMESH_CHECK(detail::require_positions(positions, neighbours.vertex_count()));
    std::vector<VertexCurvature> result = detail::large_vector<VertexCurvature>(positions.size());
    const detail::RingGroups groups(neighbours);
    groups.for_each(
        [&](const RingGroup& group) { curvatures_of(neighbours, group, positions.data(), result.data()); });
    return result;
  });
}

}  // namespace vkmesh
