#include "decimation/legality/judge.h"

#include <array>
#include <cstddef>
#include <vector>

#include <catch2/catch.hpp>

namespace vkmesh {
namespace {

/// Fails some conditions, and notes which were asked for.
struct Change {
  std::array<bool, kReasons.size() + 1> fails{};
  std::vector<Reason> asked;

  bool fail(Reason reason) {
    asked.push_back(reason);
    return fails[static_cast<std::size_t>(reason)];
  }
  bool is_locked() { return fail(Reason::kLocked); }
  bool keeps_seams() { return !fail(Reason::kSeam); }
  bool exceeds_error() { return fail(Reason::kErrorBound); }
  bool meets_link_condition() { return !fail(Reason::kLinkCondition); }
  bool folds_over() { return fail(Reason::kFoldOver); }
  bool meets_criteria() { return !fail(Reason::kCriterion); }
};

}  // namespace

TEST_CASE("a removal is refused for the first condition that it fails, in the order of Reason",
          "[decimate]") {
  CHECK(detail::judge(detail::AlwaysLegal{}) == Reason::kNone);
  Change legal;
  CHECK(detail::judge(legal) == Reason::kNone);
  std::vector<Reason> order;
  for (const Reason reason : kReasons)
    if (reason != Reason::kBoundary) order.push_back(reason);  // which only counts at the end
  CHECK(legal.asked == order);
  for (std::size_t first = 0; first < order.size(); ++first)
    for (std::size_t other = first; other < order.size(); ++other) {
      Change change;
      change.fails[static_cast<std::size_t>(order[first])] = true;
      change.fails[static_cast<std::size_t>(order[other])] = true;
      CHECK(detail::judge(change) == order[first]);
      CHECK(change.asked.size() == first + 1);
    }
}

TEST_CASE("counts by reason add up", "[decimate]") {
  CountByReason counts, more;
  ++counts[Reason::kSeam];
  more[Reason::kSeam] = 2;
  more[Reason::kCriterion] = 3;
  counts += more;
  for (const Reason reason : kReasons)
    CHECK(counts[reason] == (reason == Reason::kSeam ? 3u : reason == Reason::kCriterion ? 3u : 0u));
}

}  // namespace vkmesh
