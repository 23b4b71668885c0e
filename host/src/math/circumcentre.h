// Circumcentres and bisectors of points in the plane, rounded and exact.
#pragma once

#include <cmath>
#include <limits>

#include "math/filtered_predicates.h"

namespace vkmesh::detail {

// Exact, for all finite coordinates. Triangles (a, b, c) turn counter-clockwise.

/// Where the circumcentre lies of the line from k to l: 1 left, 0 on it, -1 right.
[[nodiscard]] int exact_circumcentre_side(DVec2 a, DVec2 b, DVec2 c, DVec2 k, DVec2 l);
/// The circumcentre, each coordinate off by less than 0.51 units in the last place.
[[nodiscard]] DVec2 exact_circumcentre(DVec2 a, DVec2 b, DVec2 c);
/// Where k lies of the bisector of p and q: 1 nearer to q, 0 on it, -1 nearer to p.
[[nodiscard]] int exact_bisector_side(DVec2 p, DVec2 q, DVec2 k);
/// The share of the way from k to l where the bisector of p and q crosses it.
[[nodiscard]] double exact_bisector_crossing(DVec2 p, DVec2 q, DVec2 k, DVec2 l);
/// The sign of the scalar product of the vectors from p to q and from k to l.
[[nodiscard]] int sign_of_product(DVec2 p, DVec2 q, DVec2 k, DVec2 l);

struct RoundedCircumcentre {
  DVec2 place;
  double error;      // of each coordinate, at most; not finite where rounding leaves nothing
  double tolerance;  // a small part, 2^-50, of the coordinates of the corners and the centre
};

/// For points that are in_filter_range(). With u = 2^-53 the area is off by 4 u of what it is of absolute
/// values, each numerator by 7 u, and the quotient and the sum are rounded once each.
[[nodiscard]] inline RoundedCircumcentre rounded_circumcentre(DVec2 a, DVec2 b, DVec2 c) {
  constexpr double kUnit = 0x1p-53;
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const double left = bx * cy, right = by * cx, area = left - right;
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy, scale = 0.5 / area;
  const double x = (cy * b2 - by * c2) * scale, y = (bx * c2 - cx * b2) * scale;
  const double absolute_area = std::fabs(left) + std::fabs(right);
  const double terms = (std::fabs(cx) + std::fabs(cy)) * b2 + (std::fabs(bx) + std::fabs(by)) * c2;
  const double distance = std::fabs(x) + std::fabs(y), size = distance + std::fabs(a.x) + std::fabs(a.y);
  const DVec2 place(a.x + x, a.y + y);
  const double error = 12 * kUnit * std::fabs(scale) * (terms + distance * absolute_area) + 2 * kUnit * size;
  // Where the area may be half as large or less, the bound above is none.
  return {place, area > 16 * kUnit * absolute_area ? error : std::numeric_limits<double>::infinity(),
          8 * kUnit * size};
}

/// The difference of the squared distances from k to p and to q, and a bound of its error. For points that
/// are in_filter_range().
struct RoundedDifference {
  double value, error;
};
[[nodiscard]] inline RoundedDifference rounded_bisector_side(DVec2 p, DVec2 q, DVec2 k) {
  constexpr double kUnit = 0x1p-53;
  const double dx = q.x - p.x, dy = q.y - p.y;
  const double px = k.x - p.x, py = k.y - p.y, qx = k.x - q.x, qy = k.y - q.y;
  return {dx * (px + qx) + dy * (py + qy), 8 * kUnit *
                                               (std::fabs(dx) * (std::fabs(px) + std::fabs(qx)) +
                                                std::fabs(dy) * (std::fabs(py) + std::fabs(qy)))};
}

}  // namespace vkmesh::detail
