// The run until a limit is met, whatever is removed.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include <vkmesh/decimation/decimate.h>

#include "decimation/decimation_state.h"
#include "decimation/parallel/coarsen.h"

namespace vkmesh::detail {

/// Removes until a limit is met or nothing is left to remove. `Removals` has, as PartitionedCollapses does,
/// fill(), step(), kStep, count_blocked(), which counts what blocks the candidates that are left, and
/// kMayCoarsen: whether the cheapest need not go first while much is to go.
template <class Removals>
Result<Outcome> run_removals(DecimationState& state, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const Limits& limits = state.limits;
  if constexpr (Removals::kMayCoarsen) coarsen_if_far_from_target(state);
  Removals removals(state);
  if (!state.reached()) removals.fill();
  const std::size_t first_faces = state.faces, first_vertices = state.vertices;
  std::size_t steps = 0;
  while (!state.reached()) {
    if (steps++ % (kRemovalsBetweenReports / Removals::kStep) == 0) {
      if (progress) {
        const auto share = [](std::size_t first, std::size_t now, std::size_t last) {
          return first <= last ? 1.0 : static_cast<double>(first - now) / static_cast<double>(first - last);
        };
        const double done = std::max(share(first_faces, state.faces, limits.faces),
                                     share(first_vertices, state.vertices, limits.vertices));
        if (!progress(std::min(done, 1.0))) return fail(ErrorCode::kInterrupted, "decimation was cancelled");
      }
      if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >= limits.seconds) {
        state.outcome.stop = DecimateStop::kTimeLimit;
        break;
      }
    }
    if (!removals.step()) {
      removals.count_blocked();
      const bool by_error = state.outcome.blocked[Reason::kErrorBound] > 0;
      state.outcome.stop = by_error ? DecimateStop::kErrorBound : DecimateStop::kNoLegalCollapse;
      break;
    }
  }
  if (progress && !progress(1.0)) return fail(ErrorCode::kInterrupted, "decimation was cancelled");
  return std::move(state.outcome);
}

}  // namespace vkmesh::detail
