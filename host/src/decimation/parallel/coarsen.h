// What a surface that is far from its target loses at once.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "decimation/decimation_state.h"
#include "decimation/edge_merger.h"
#include "decimation/parallel/coarsen_batch.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Merges vertices into neighbours in the order of memory, with no queue, up to a cost: what goes first of so
/// many leaves hardly a trace in the end. Each vertex goes to where that costs least, where the surface is
/// smooth, and those that stay do not move; the collapses that follow place them anew, by all the planes.
///
/// It keeps to a range. Where a vertex has a neighbour elsewhere, it neither goes nor takes another in: no
/// face that has a corner elsewhere changes, and of a vertex next to those elsewhere nothing but where its
/// fan begins. So several ranges can be coarsened side by side.
class RangeCoarsening {
 public:
  /// No vertex goes at more than the cost `max_cost`. `state`: of this range, or of all.
  RangeCoarsening(DecimationState& state, const VertexRange& range, float max_cost);

  void run_all();
  /// Over these, in this order.
  void run(std::span<const std::uint32_t> candidates);
  /// Those that could not go because of what lies beyond the range; at the boundary, too.
  [[nodiscard]] std::span<const std::uint32_t> deferred() const { return deferred_; }

 private:
  [[nodiscard]] bool is_candidate(std::uint32_t v) const;
  void coarsen(std::span<const std::uint32_t> candidates);
  void coarsen_batch();
  void attempt(std::size_t i);

  DecimationState& state_;
  CollapseMesh& mesh_;
  LargeArray<VertexRecord>& vertices_;
  VertexRange range_;
  float max_cost_;
  EdgeMerger<false> merger_;
  std::unique_ptr<CoarsenBatch> batch_ = std::make_unique<CoarsenBatch>();
  std::vector<CoarsenBatch::Ring> at_target_ = std::vector<CoarsenBatch::Ring>(CoarsenBatch::kSize);
  std::vector<std::uint32_t> touched_;  // and kept, by this batch
  std::vector<std::uint32_t> deferred_;
};

/// What this share of the vertices would cost at most, by a sample; 0 where there are none.
[[nodiscard]] float cost_of_share(const CollapseMesh& mesh, double share);

/// Coarsens a large surface that is so far from its target that the order of what goes first hardly matters,
/// where no error is promised: a history tells that order. O(n), on all cores; what goes does not depend on
/// how many there are. Does nothing else.
void coarsen_if_far_from_target(DecimationState& state);

}  // namespace vkmesh::detail
