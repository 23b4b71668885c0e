// The main loop, compiled for each removal, order and cost: half in instantiations.cpp, half in
// instantiations_of_attributes.cpp, since it takes long.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "decimation/edge_collapses.h"
#include "decimation/legality/criteria.h"
#include "decimation/order/collapse_queues.h"
#include "decimation/parallel/partitioned_collapses.h"
#include "decimation/removals.h"
#include "decimation/vertex_removals.h"

namespace vkmesh::detail {

/// How much of the way to the nearest target is done, from 0 to 1.
inline double progress_of(const DecimationState& state, std::size_t first_faces, std::size_t first_vertices) {
  const auto share = [](std::size_t first, std::size_t now, std::size_t last) {
    return first <= last ? 1.0 : static_cast<double>(first - now) / static_cast<double>(first - last);
  };
  return std::min(1.0, std::max(share(first_faces, state.faces, state.limits.faces),
                                share(first_vertices, state.vertices, state.limits.vertices)));
}

/// `Removals` has, as PartitionedCollapses does, fill(), step(), kStep, how many removals a step is about,
/// and count_blocked(), which counts what blocks the candidates that are left.
template <class Removals>
Result<Outcome> run_removals(DecimationState& state) {
  Stop& stop = *state.stop;
  if (!state.reached()) {
    Removals removals(state);
    removals.fill();
    const std::size_t first_faces = state.faces, first_vertices = state.vertices;
    const bool none_left = run_steps(
        stop, kRemovalsBetweenReports / Removals::kStep, [&] { return state.reached(); },
        [&] { return removals.step(); },
        [&] {
          return state.progress_from +
                 (state.progress_to - state.progress_from) * progress_of(state, first_faces, first_vertices);
        });
    if (none_left) {
      removals.count_blocked();
      const bool by_error = state.outcome.blocked[Reason::kErrorBound] > 0;
      state.outcome.stop = by_error ? DecimateStop::kErrorBound : DecimateStop::kNoLegalCollapse;
    }
    if (state.at_target() && !state.at_what_was_asked()) removals.count_blocked();
  }
  if (!stop.is_cancelled()) stop.report(state.progress_to);
  VKMESH_CHECK(stop.check());
  if (state.outcome.stop == DecimateStop::kTargetReached && !state.at_target())
    state.outcome.stop = DecimateStop::kTimeLimit;
  if (state.outcome.stop == DecimateStop::kTargetReached && !state.at_what_was_asked())
    state.outcome.stop = DecimateStop::kOutOfProportion;
  return std::move(state.outcome);
}

/// Costs that may fall, as those of criteria, need a heap.
template <class Placement, bool kAttributes>
Result<Outcome> collapse_edges(DecimationState& state) {
  if (state.criteria != nullptr && state.criteria->ranks())
    return run_removals<PartitionedCollapses<ByCriteria<Placement>, ExactQueue, kAttributes>>(state);
  return run_removals<PartitionedCollapses<Placement, LazyQueue, kAttributes>>(state);
}

template <bool kAttributes>
Result<Outcome> remove_vertices(DecimationState& state) {
  if (state.criteria != nullptr && state.criteria->ranks())
    return run_removals<VertexRemovals<ExactQueue, kAttributes>>(state);
  return run_removals<VertexRemovals<LazyQueue, kAttributes>>(state);
}

template <bool kAttributes>
Result<Outcome> remove_cheapest(DecimationState& state, DecimateOperation operation) {
  switch (operation) {
    case DecimateOperation::kEdgeCollapse:
      return collapse_edges<OptimalPlacement, kAttributes>(state);
    case DecimateOperation::kHalfEdgeCollapse:
      return collapse_edges<EndPlacement, kAttributes>(state);
    case DecimateOperation::kVertexRemoval:
      break;
  }
  return remove_vertices<kAttributes>(state);
}

}  // namespace vkmesh::detail
