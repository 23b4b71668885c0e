#include <algorithm>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/swap_scores.h>

#include "passes/pass_input.h"
#include "passes/per_edge_values.h"
#include "passes/swap_geometry.h"
#include "simd/target_clones.h"

namespace vkmesh {
namespace {

using detail::faces_away;
using detail::squared_distance;

float least_angle(Vec3 a, Vec3 b, Vec3 c, float twice_area) {
  const float at_a = corner_angle(corner_product(a, b, c), twice_area);
  const float at_b = corner_angle(corner_product(b, c, a), twice_area);
  const float at_c = corner_angle(corner_product(c, a, b), twice_area);
  return std::min(std::min(at_a, at_b), at_c);
}

float quality(Vec3 a, Vec3 b, Vec3 c, float twice_area) {
  const float sides = (squared_distance(a, b) + squared_distance(b, c)) + squared_distance(c, a);
  return bounded_quotient(VKMESH_QUALITY_SCALE * twice_area, zero_below(sides, VKMESH_TINY_AREA), 2.0f, 0.5f);
}

struct Triangle {
  Vec3 area{0.0f};
  float score = 0.0f;
};

template <SwapCriterion criterion>
Triangle triangle(Vec3 a, Vec3 b, Vec3 c) {
  Triangle result;
  result.area = area_vector(a, b, c);
  const float twice_area = vector_length(result.area);
  result.score =
      criterion == SwapCriterion::kMinAngle ? least_angle(a, b, c, twice_area) : quality(a, b, c, twice_area);
  return result;
}

// The edge runs from p to q; `left` and `right` are the corners opposite to it.
template <SwapCriterion criterion>
float score_of(Vec3 p, Vec3 q, Vec3 left, Vec3 right) {
  const Triangle t0 = triangle<criterion>(p, q, left), t1 = triangle<criterion>(q, p, right);
  const Triangle n0 = triangle<criterion>(left, right, q), n1 = triangle<criterion>(right, left, p);
  const Vec3 before = unit_vector(t0.area + t1.area);
  const float gain = std::min(n0.score, n1.score) - std::min(t0.score, t1.score);
  return faces_away(before, n0.area) || faces_away(before, n1.area) ? kNoSwap : gain;
}

struct Quadrilaterals {
  std::array<Vec3, detail::kEdgeBlock> p, q, left, right;
};

VKMESH_FLAT_CLONES void scores_by_angle(const Quadrilaterals& of, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i)
    out[i] = score_of<SwapCriterion::kMinAngle>(of.p[i], of.q[i], of.left[i], of.right[i]);
}
VKMESH_FLAT_CLONES void scores_by_quality(const Quadrilaterals& of, std::size_t count,
                                          float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i)
    out[i] = score_of<SwapCriterion::kAspectRatio>(of.p[i], of.q[i], of.left[i], of.right[i]);
}

}  // namespace

Result<std::vector<float>> swap_scores(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                       SwapCriterion criterion) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(detail::require_triangles(mesh, "swap_scores"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    const auto corners = mesh.origins(), twins = mesh.twins();
    const auto opposite = [&](std::size_t h) { return positions[corners[h % 3 == 0 ? h + 2 : h - 1]]; };
    const auto take = [&](Quadrilaterals& block, std::size_t i, std::uint32_t h) {
      const std::uint32_t t = twins[h];
      block.p[i] = positions[corners[h]];
      block.q[i] = positions[corners[t]];
      block.left[i] = opposite(h);
      block.right[i] = opposite(t);
    };
    const auto compute = [&](const Quadrilaterals& block, std::size_t count, std::span<float> out) {
      const bool by_angle = criterion == SwapCriterion::kMinAngle;
      (by_angle ? scores_by_angle : scores_by_quality)(block, count, out.data());
    };
    return detail::edge_values<Quadrilaterals>(mesh, false, kNoSwap, take, compute);
  });
}

}  // namespace vkmesh
