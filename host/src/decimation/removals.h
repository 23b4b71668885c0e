// The main loop, for each kind of removal.
#pragma once

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>

#include "decimation/decimation_state.h"

namespace vkmesh::detail {

/// Removes, the cheapest first, until a limit is met or no legal removal is left; with the attributes in the
/// state, or without. Errors: kInterrupted.
template <bool kAttributes>
[[nodiscard]] Result<Outcome> remove_cheapest(DecimationState& state, DecimateOperation operation,
                                              const Progress& progress);

}  // namespace vkmesh::detail
