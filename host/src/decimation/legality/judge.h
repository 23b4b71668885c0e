// Whether a removal may be done, and if not, why.
#pragma once

#include <vkmesh/decimation/reason.h>

namespace vkmesh::detail {

/// Judges the collapse of an edge, one of coarsening, or the removal of a vertex: the first condition, in the
/// order of Reason, that it does not meet. What is costly to tell comes last. `Change` derives from
/// AlwaysLegal and replaces what may forbid it.
template <class Change>
[[nodiscard]] Reason judge(Change&& change) {
  if (change.is_locked()) return Reason::kLocked;
  if (!change.keeps_seams()) return Reason::kSeam;
  if (change.exceeds_error()) return Reason::kErrorBound;
  if (!change.meets_link_condition()) return Reason::kLinkCondition;
  if (change.folds_over()) return Reason::kFoldOver;
  return change.meets_criteria() ? Reason::kNone : Reason::kCriterion;
}

struct AlwaysLegal {
  [[nodiscard]] static bool is_locked() { return false; }
  [[nodiscard]] static bool keeps_seams() { return true; }
  [[nodiscard]] static bool exceeds_error() { return false; }
  [[nodiscard]] static bool meets_link_condition() { return true; }
  [[nodiscard]] static bool folds_over() { return false; }
  [[nodiscard]] static bool meets_criteria() { return true; }
};

}  // namespace vkmesh::detail
