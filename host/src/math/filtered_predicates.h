// The predicates of <vkmesh/math/predicates.h> for inner loops: a filter in line, and what it leaves to
// exact arithmetic out of line.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <vkmesh/math/predicates.h>

namespace vkmesh::detail {

// As orientation() and in_circle(), without a filter.
[[nodiscard]] int exact_orientation(DVec2 a, DVec2 b, DVec2 c);
[[nodiscard]] int exact_in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d);
/// in_circle_perturbed() of points for which in_circle() is 0.
[[nodiscard]] int perturbed_cocircular(DVec2 a, DVec2 b, DVec2 c, DVec2 d);

/// Where the segments ab and cd cross, each end of one strictly on another side of the other. Each coordinate
/// is off by less than 0.51 units in the last place, and within the bounds of both.
[[nodiscard]] DVec2 crossing_of(DVec2 a, DVec2 b, DVec2 c, DVec2 d);

/// Whether products of four differences of such coordinates neither overflow nor underflow, so that the
/// bounds of rounding errors hold: 0, or from 2^-198 to 2^250 in size.
[[nodiscard]] inline bool in_filter_range(double x) {
  const double size = std::fabs(x);
  return size == 0 || (size >= 0x1p-198 && size <= 0x1p250);
}
[[nodiscard]] inline bool in_filter_range(DVec2 p) {
  return in_filter_range(p.x) && in_filter_range(p.y);
}

[[nodiscard]] inline bool all_in_filter_range(std::span<const DVec2> points) {
  return std::all_of(points.begin(), points.end(), [](DVec2 p) { return in_filter_range(p); });
}

/// Predicates of points whose range is known.
class FilteredPredicates {
 public:
  /// `in_range`: whether all points are in_filter_range(). If not, exact arithmetic decides everything.
  explicit FilteredPredicates(bool in_range)
      : orientation_bound_(in_range ? 4 * kUnit : std::numeric_limits<double>::infinity()),
        circle_bound_(in_range ? 12 * kUnit : std::numeric_limits<double>::infinity()) {}

  [[nodiscard]] int orientation(DVec2 a, DVec2 b, DVec2 c) const {
    const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x), sum = left - right;
    const double bound = orientation_bound_ * (std::fabs(left) + std::fabs(right));
    if (sum > bound) return 1;
    if (sum < -bound) return -1;
    return bound == 0 ? 0 : exact_orientation(a, b, c);
  }

  /// The angles at a and at d over the edge from b to c come to more than π where d is inside, and then the
  /// sine of their sum, sin α cos δ + cos α sin δ, is negative. Each of the four sums below is off by at most
  /// 4 u of what it is of absolute values, and the whole by 10 u, where u = 2^-53 and terms in u² are left
  /// out; the bound itself is rounded, too.
  [[nodiscard]] int in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d) const {
    const double abx = b.x - a.x, aby = b.y - a.y, acx = c.x - a.x, acy = c.y - a.y;
    const double dbx = b.x - d.x, dby = b.y - d.y, dcx = c.x - d.x, dcy = c.y - d.y;
    const double a1 = abx * acy, a2 = aby * acx, a3 = abx * acx, a4 = aby * acy;
    const double d1 = dcx * dby, d2 = dcy * dbx, d3 = dcx * dbx, d4 = dcy * dby;
    const double sum = (a1 - a2) * (d3 + d4) + (a3 + a4) * (d1 - d2);
    const double bound = circle_bound_ * ((std::fabs(a1) + std::fabs(a2)) * (std::fabs(d3) + std::fabs(d4)) +
                                          (std::fabs(a3) + std::fabs(a4)) * (std::fabs(d1) + std::fabs(d2)));
    if (sum < -bound) return 1;
    if (sum > bound) return -1;
    return exact_in_circle(a, b, c, d);
  }

  [[nodiscard]] int in_circle_perturbed(DVec2 a, DVec2 b, DVec2 c, DVec2 d) const {
    const int side = in_circle(a, b, c, d);
    return side != 0 ? side : perturbed_cocircular(a, b, c, d);
  }

 private:
  static constexpr double kUnit = 0x1p-53;

  double orientation_bound_, circle_bound_;
};

}  // namespace vkmesh::detail
