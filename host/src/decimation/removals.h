// The main loop, for each kind of removal.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>

#include "decimation/decimation_state.h"

namespace vkmesh::detail {

/// Removes, the cheapest first, until a limit is met or no legal removal is left; with the attributes in the
/// state, or without. The state has a Stop. Errors: kInterrupted.
template <bool kAttributes>
[[nodiscard]] Result<Outcome> remove_cheapest(DecimationState& state, DecimateOperation operation);

}  // namespace vkmesh::detail
