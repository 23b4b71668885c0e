// Axis-aligned bounding boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <vkmesh/math/vec.h>

namespace vkmesh {

/// An axis-aligned bounding box of points of type Vec3 or DVec3. Empty, with `low` above `high`, until a
/// point is added. A coordinate that is not a number counts for nothing.
template <class Point>
struct BasicBounds {
  using Scalar = typename Point::value_type;

  Point low{std::numeric_limits<Scalar>::infinity()}, high{-std::numeric_limits<Scalar>::infinity()};

  void add(const Point& p) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  BasicBounds& operator+=(const BasicBounds& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
    return *this;
  }

  [[nodiscard]] bool empty() const { return low.x > high.x; }
  /// The lengths of the sides; the box must not be empty.
  [[nodiscard]] Point extent() const { return high - low; }
  /// The axis of the longest side, the first of equal ones.
  [[nodiscard]] int longest_axis() const {
    const Point size = extent();
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  }
  /// The length of the diagonal, in double precision; 0 for an empty box.
  [[nodiscard]] double diagonal() const {
    if (empty()) return 0;
    const DVec3 size = DVec3(high) - DVec3(low);
    return std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
  }
  /// From a point to the box, 0 inside.
  [[nodiscard]] double squared_distance(const DVec3& p) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double outside = std::max({low[k] - p[k], p[k] - high[k], 0.0});
      sum += outside * outside;
    }
    return sum;
  }
};

using Bounds = BasicBounds<Vec3>;
using DBounds = BasicBounds<DVec3>;

/// The bounding box of points. O(points).
template <class Points>
[[nodiscard]] auto bounds_of(const Points& points) {
  BasicBounds<typename Points::value_type> bounds;
  for (const auto& p : points) bounds.add(p);
  return bounds;
}

}  // namespace vkmesh
