// Coarsening: bulk half-edge collapses without a queue, far from the target.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "decimation/collapse_operator.h"
#include "decimation/decimation_state.h"
#include "decimation/parallel/coarsen_batch.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Collapses vertices of a range into neighbours, in the order of memory and up to a cost: far from the
/// target the order of collapses hardly changes the result. Each vertex goes to the neighbour where that
/// costs least, if the surface is smooth there. Vertices that stay do not move; later collapses place them by
/// their quadrics.
///
/// A vertex with a neighbour outside the range neither goes nor absorbs another: no face with a corner
/// outside changes, and of a vertex next to the outside nothing but its leading half-edge. So ranges can be
/// coarsened side by side. They are ranges of numbers, not Partitions, because numbers follow a space-filling
/// curve: who owns a vertex is known without a label, and the surface is partitioned only afterwards, when
/// most of it has gone. Partitions must stay compact through many rounds, which ranges do not; their labels
/// would have to be made for all vertices first.
class RangeCoarsening {
 public:
  /// No vertex goes at a higher cost than `max_cost`. `state` counts the removals of this range, or of all.
  RangeCoarsening(DecimationState& state, const VertexRange& range, float max_cost);

  /// Tries all vertices of the range.
  void run_all();
  /// Tries these vertices, in this order.
  void run(std::span<const std::uint32_t> candidates);
  /// Vertices that did not go because a neighbour, or one's neighbour, lies outside the range or at the
  /// boundary.
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
  CollapseOperator<false> operator_;
  std::unique_ptr<CoarsenBatch> batch_ = std::make_unique<CoarsenBatch>();
  std::vector<CoarsenBatch::Ring> at_target_ = std::vector<CoarsenBatch::Ring>(CoarsenBatch::kSize);
  std::vector<std::uint32_t> touched_;  // and kept, by this batch
  std::vector<std::uint32_t> deferred_;
};

/// The cost that this share of the vertices does not exceed, by a sample; 0 where there are none.
[[nodiscard]] float cost_of_share(const CollapseMesh& mesh, double share);

/// Coarsens a large surface if it is at least eight times as large as its target, and nothing depends on the
/// order of collapses: no history, no error bound, no attributes or criteria. O(n), on all cores; the result
/// does not depend on how many there are.
void coarsen_if_far_from_target(DecimationState& state);

}  // namespace vkmesh::detail
