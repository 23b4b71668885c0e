// The sums behind surface_measures(), for the passes that go on with them.
#pragma once

#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/surface_measures.h>

namespace vkmesh::detail {

/// The measures of triangles, by their corners, and prepared positions (see prepare_positions()). O(faces).
[[nodiscard]] VKMESH_API RawMeasures raw_measures(std::span<const std::uint32_t> corners,
                                                  std::span<const Vec3> positions);

/// Errors: kUsage, as vertex_quadrics().
[[nodiscard]] VKMESH_API Result<void> require_collapse_cost_options(const CollapseCostOptions& options);

}  // namespace vkmesh::detail
