// Decimation until a limit is met, by each kind of removal: compiled one by one, since each takes long.
#pragma once

#include <vkmesh/base/progress.h>
#include <vkmesh/decimation/decimate.h>

#include "decimation/decimation_state.h"

namespace vkmesh::detail {

/// `exact`: the cheapest at any time, from a heap. With attributes in the state or without.
template <bool kAttributes>
Result<Outcome> run_edge_collapses(DecimationState& state, const DecimateOptions& options, bool exact,
                                   const Progress& progress);
template <bool kAttributes>
Result<Outcome> run_vertex_removals(DecimationState& state, bool exact, const Progress& progress);

}  // namespace vkmesh::detail
