// The sums behind surface_measures(), for the passes that go on with them.
#pragma once

#include <span>

#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/surface_measures.h>

namespace vkmesh::detail {

/// Of triangles, by their corners, and prepared positions (see prepare_positions()). O(faces).
[[nodiscard]] RawMeasures raw_measures(std::span<const std::uint32_t> corners,
                                       std::span<const Vec3> positions);

/// Coordinates of the sums: (position − centre) · scale, the scale a power of two.
struct MeasuresFrame {
  Vec3 centre{0.0f};
  float scale = 0.0f, inverse_scale = 0.0f;
};
[[nodiscard]] MeasuresFrame frame_of_bounds(Vec3 low, Vec3 high);

/// Errors: kUsage, as vertex_quadrics().
[[nodiscard]] Result<void> require_collapse_cost_options(const CollapseCostOptions& options);

}  // namespace vkmesh::detail
