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

/// Whether two corners at one vertex are of one group and have the same values of all attributes.
[[nodiscard]] bool have_same_values(const DecimateOptions& options, std::uint32_t c, std::uint32_t d);

/// The wedges that attributes and corner groups make, if there are any. O(n). Where `stop` is set meanwhile
/// they are of no use.
[[nodiscard]] std::optional<Wedges> find_wedges(CollapseMesh& mesh, std::size_t vertex_count,
                                                const DecimateOptions& options, Stop& stop);

/// `wedges`, if any, are borrowed.
[[nodiscard]] ConstraintWeights constraint_weights(const DecimateCurves& curves,
                                                   const std::optional<Wedges>& wedges);

/// In local units; ratios are those of `faces`.
[[nodiscard]] Limits limits_of(const DecimateOptions& options, std::size_t faces, const Frame& frame);

/// The share of so many faces, or vertices, that is to be left.
[[nodiscard]] double share_asked_for(const Limits& limits, std::size_t faces, std::size_t vertices);

/// Raises the limit of the vertices, of which so many are held: they stay whatever goes, and a target that
/// they put out of reach would be bought with all the rest. Of those that may go an eighth of the share that
/// was asked for is left.
void keep_in_proportion(Limits& limits, double share, std::size_t vertices, std::size_t held);

/// The mean weight of vertices, by a sample.
[[nodiscard]] double mean_weight_of(const CollapseMesh& mesh);

}  // namespace vkmesh::detail
