#include <algorithm>
#include <cmath>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/unit_frame.h>
#include <vkmesh/passes/detail/raw_measures.h>
#include <vkmesh/passes/restore_volume.h>

#include "base/parallel.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

struct Scaling {
  Vec3 centroid{0.0f};
  float factor = 1.0f;
};

// ∛(volume before / volume after), both sums in units of a power of two, the largest extent of each.
float factor_of(const RawMeasures& before, const RawMeasures& after) {
  const auto exponent = [](const RawMeasures& m) {
    const Vec3 extent = Vec3(m[3], m[4], m[5]) - Vec3(m[0], m[1], m[2]);
    return static_cast<std::int32_t>(
        std::max(std::max(detail::bits(extent.x), detail::bits(extent.y)), detail::bits(extent.z)) >> 23);
  };
  const float ratio = bounded_quotient(std::fabs(before[10]), std::fabs(after[10]), VKMESH_VOLUME_RATIO_BOUND,
                                       VKMESH_VOLUME_RATIO_BOUND_INVERSE);
  const bool alike = (before[10] < 0.0f) == (after[10] < 0.0f) && ratio > VKMESH_VOLUME_RATIO_BOUND_INVERSE &&
                     ratio < VKMESH_VOLUME_RATIO_BOUND;
  const std::int32_t larger = exponent(before) - exponent(after);
  const bool near = larger >= -10 && larger <= 10;
  return alike && near
             ? exact::cube_root(ratio) * detail::from_bits(static_cast<std::uint32_t>(127 + larger) << 23)
             : 1.0f;
}

Scaling scaling_of(const RawMeasures& before, const RawMeasures& after) {
  const detail::UnitFrame frame =
      detail::unit_frame_of({{after[0], after[1], after[2]}, {after[3], after[4], after[5]}});
  const Vec3 middle = zero_below(Vec3(after[7], after[8], after[9]) * exact::reciprocal(3.0f * after[6]),
                                 VKMESH_TINY_DIRECTION);
  return {frame.centre + zero_below(middle * frame.inverse_scale, VKMESH_TINY_COORDINATE),
          factor_of(before, after)};
}

}  // namespace

Result<std::vector<Vec3>> restore_volume(const HalfEdgeMesh& mesh, std::span<const Vec3> before,
                                         std::span<const Vec3> after) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(detail::require_triangles(mesh, "restore_volume"));
    VKMESH_CHECK(detail::require_positions(before, mesh.vertex_count()));
    VKMESH_CHECK(detail::require_positions(after, mesh.vertex_count()));
    if (mesh.boundary_half_edge_count() != 0)
      return fail(ErrorCode::kUnsuitable, "only a closed surface has a volume to restore");
    std::vector<Vec3> prepared(before.size()), result(after.size());
    VKMESH_CHECK(prepare_positions(before, prepared));
    VKMESH_CHECK(prepare_positions(after, result));
    const Scaling scaling = scaling_of(detail::raw_measures(mesh.origins(), prepared),
                                       detail::raw_measures(mesh.origins(), result));
    if (scaling.factor == 1.0f) return result;
    detail::parallel_ranges(result.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Vec3 from = zero_below(result[v] - scaling.centroid, VKMESH_TINY_COORDINATE);
        const Vec3 to = zero_below(from * scaling.factor, VKMESH_TINY_COORDINATE);
        result[v] = zero_below(scaling.centroid + to, VKMESH_TINY_COORDINATE);
      }
    });
    return result;
  });
}

}  // namespace vkmesh
