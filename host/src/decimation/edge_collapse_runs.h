// Which queue and placement edges are collapsed with.
#pragma once

#include "decimation/edge_collapses.h"
#include "decimation/legality/criteria.h"
#include "decimation/order/collapse_queues.h"
#include "decimation/parallel/partitioned_collapses.h"
#include "decimation/run_removals.h"
#include "decimation/runs.h"

namespace vkmesh::detail {

template <class Placement, bool kAttributes>
Result<Outcome> run_collapses(DecimationState& state, bool exact, const Progress& progress) {
  if (state.criteria != nullptr && state.criteria->ranks())
    return run_removals<PartitionedCollapses<ByCriteria<Placement>, ExactQueue, kAttributes>>(state,
                                                                                              progress);
  if constexpr (Placement::kMayFall != MayFall::kAll)
    if (!exact) return run_removals<PartitionedCollapses<Placement, LazyQueue, kAttributes>>(state, progress);
  return run_removals<PartitionedCollapses<Placement, ExactQueue, kAttributes>>(state, progress);
}

template <bool kAttributes>
Result<Outcome> run_edge_collapses(DecimationState& state, const DecimateOptions& options, bool exact,
                                   const Progress& progress) {
  if (options.operation == DecimateOperation::kHalfEdgeCollapse ||
      options.placement == CollapsePlacement::kEndpoint)
    return run_collapses<EndPlacement, kAttributes>(state, exact, progress);
  if (options.placement == CollapsePlacement::kMidpoint)
    return run_collapses<MidpointPlacement, kAttributes>(state, exact, progress);
  return run_collapses<OptimalPlacement, kAttributes>(state, exact, progress);
}

}  // namespace vkmesh::detail
