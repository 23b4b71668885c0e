// The steps between a mesh and the first removal, besides quadrics and pruning.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <vkmesh/decimation/decimate.h>

#include "decimation/decimation_state.h"
#include "decimation/legality/wedges.h"
#include "decimation/setup/frame.h"
#include "decimation/setup/initial_quadrics.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Locks the vertices that are to stay, those of edges and faces that are, and a boundary that is kept. O(n).
void lock_vertices(CollapseMesh& mesh, std::span<const std::uint32_t> corners,
                   const DecimateOptions& options);

/// The wedges that attributes and corner groups make, if there are any. O(n).
[[nodiscard]] std::optional<Wedges> find_wedges(CollapseMesh& mesh, std::size_t vertex_count,
                                                const DecimateOptions& options);

/// `wedges`, if any, are borrowed.
[[nodiscard]] ConstraintWeights constraint_weights(const DecimateCurves& curves,
                                                   const std::optional<Wedges>& wedges);

/// In local units; ratios are those of `faces`.
[[nodiscard]] Limits limits_of(const DecimateOptions& options, std::size_t faces, const Frame& frame);

/// Raises the limit of the vertices, of which there are so many, as faces, unless the target is to be forced:
/// where many stay whatever goes, a target that they put out of reach would be bought with all the rest. Of
/// those that may go an eighth of the share that was asked for is left. O(n) where any are locked.
void keep_in_proportion(Limits& limits, const CollapseMesh& mesh, const DecimateOptions& options,
                        std::size_t faces, std::size_t vertices);

/// The mean weight of vertices, by a sample.
[[nodiscard]] double mean_weight_of(const CollapseMesh& mesh);

}  // namespace vkmesh::detail
