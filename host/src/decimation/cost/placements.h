// Where the point of a collapsed edge goes, and what is known of the cost.
#pragma once

#include <cstddef>

#include "decimation/cost/edge_batch.h"

namespace vkmesh::detail {

/// Which edges may cost less after a collapse: none, those that the vertex had which went, those of the kept
/// vertex, or those of its neighbours, too.
enum class MayFall { kNone, kOfGone, kAround };

struct OptimalPlacement {
  static constexpr MayFall kMayFall = MayFall::kNone;
  static constexpr bool kByCriteria = false;
  static constexpr bool kAtEnds = false;
  static void place(EdgeBatch& batch, std::size_t count) { place_optimally(batch, count); }
};
/// An edge r–p that became r–q may cost less than it did, but no less than the collapse of p into q. Those
/// that q had before only cost more.
struct EndPlacement {
  static constexpr MayFall kMayFall = MayFall::kOfGone;
  static constexpr bool kByCriteria = false;
  static constexpr bool kAtEnds = true;
  static void place(EdgeBatch& batch, std::size_t count) { place_at_end(batch, count); }
};

/// With weights of Criteria, which look at all faces at both ends.
template <class Placement>
struct ByCriteria : Placement {
  static constexpr MayFall kMayFall = MayFall::kAround;
  static constexpr bool kByCriteria = true;
};

}  // namespace vkmesh::detail
