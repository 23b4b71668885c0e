// Several targets of one decimation, each begun where the one before ended.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/math/length.h>
#include <vkmesh/mesh/triangle_surface.h>

#include "decimation/decimation_state.h"

namespace vkmesh::detail {

/// Where a level ends: when so few faces are left, or when no removal of at most this error is.
struct LevelTarget {
  std::size_t faces = 0;
  std::optional<Length> error;
};

/// The surface at each of the levels, which take more and more away: quadrics, wedges and distances go on
/// from level to level, so that errors are those from the input; each level has an order of its own. The last
/// of the result is the first level that meets no target; where the time was over before anything was
/// removed, there is none. The target of `options` gives only the time and whether to go on by force; no
/// history is kept. The vertex map of each but the first is that of the level before. Costs what the last
/// level does, and about 20 ns for each face and vertex of the input a level. Errors: those of decimate().
[[nodiscard]] Result<std::vector<Decimated>> decimate_levels(const TriangleSurface& surface,
                                                             const DecimateOptions& options,
                                                             std::span<const LevelTarget> levels,
                                                             const PartitionSizes& sizes = {},
                                                             const Progress& progress = {});

}  // namespace vkmesh::detail
