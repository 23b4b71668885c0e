#include <algorithm>
#include <string>
#include <utility>

#include <vkmesh/math/arithmetic.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/passes/detail/bilateral_grid.h>

#include "base/parallel.h"

namespace vkmesh::detail {

Result<void> require_bilateral_options(const BilateralSmoothingOptions& options) {
  constexpr float kLeast = 0x1p-40f, kMost = 0x1p40f;
  for (const auto& [value, name] :
       {std::pair{options.spatial, "spatial"}, std::pair{options.influence, "influence"}})
    if (!(value >= kLeast && value <= kMost))
      return fail(ErrorCode::kUsage, std::string("the width '") + name + "' must lie in [2^-40, 2^40], not " +
                                         std::to_string(value));
  return {};
}

Result<BilateralGrid> bilateral_grid(const HalfEdgeMesh& mesh, std::span<const Vec3> p,
                                     const BilateralSmoothingOptions& options) {
  const auto corners = mesh.origins();
  Bounds bounds;
  std::vector<std::uint32_t> used;
  std::vector<Vec3> used_positions;
  for (std::uint32_t v = 0; v < p.size(); ++v) {
    if (mesh.is_isolated(VertexId(v))) continue;
    used.push_back(v);
    used_positions.push_back(p[v]);
    bounds.add(p[v]);
  }
  for (int k = 0; k < 3; ++k)
    if (!(bounds.high[k] - bounds.low[k] <= 0x1p20f * options.spatial))
      return fail(ErrorCode::kUnsuitable,
                  "the mesh is more than 2^20 times as wide as the spatial width of the smoothing");

  std::vector<Vec3> centroids(mesh.face_count());
  const float third = exact::reciprocal(3.0f);
  parallel_ranges(centroids.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Vec3 a = p[corners[3 * f]], b = p[corners[3 * f + 1]], c = p[corners[3 * f + 2]];
      centroids[f] = zero_below(((a + b) + c) * third, VKMESH_TINY_COORDINATE);
    }
  });
  // A centroid may lie below the smallest vertex by a rounding.
  for (const Vec3& c : centroids) bounds.add(c);
  const float cells_per_unit = 0.998f * exact::reciprocal(options.spatial);
  return BilateralGrid{PointGrid(centroids, bounds.low, cells_per_unit),
                       PointGrid(used_positions, bounds.low, cells_per_unit), std::move(used),
                       std::move(used_positions), std::move(centroids)};
}

}  // namespace vkmesh::detail
