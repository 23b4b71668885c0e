// Costs of a triangle by the squares of its sides: of any surface that is unfolded, as an intrinsic one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace vkmesh::detail {

/// Squares of sides. All functions of it give the same bits for any order of the three.
struct SquaredSides {
  double a, b, c;  // ascending

  SquaredSides(double x, double y, double z) : a(std::min(x, y)), b(std::max(x, y)), c(std::max(b, z)) {
    b = std::min(b, z);
    const double least = std::min(a, b);
    b = std::max(a, b);
    a = least;
  }

  /// 16 area², 0 where the sides are no triangle's. The longest side against the two others (W. Kahan,
  /// "Miscalculating area and angles of a needle-like triangle", 2014): what cancels is small beside a b.
  [[nodiscard]] double sixteen_area2() const {
    const double cosine = a + b - c;
    return std::max(0.0, 4 * a * b - cosine * cosine);
  }
  [[nodiscard]] double area() const { return 0.25 * std::sqrt(sixteen_area2()); }

  /// sin² of the least angle, which is between the two longer sides: from 0 to 3/4.
  [[nodiscard]] double least_sine2() const {
    const double product = 4 * b * c;
    return product > 0 ? sixteen_area2() / product : 0;
  }
  /// 4√3 area over the sum of the squares: from 0 to 1.
  [[nodiscard]] double quality() const {
    const double sum = a + b + c;
    return sum > 0 ? std::sqrt(3 * sixteen_area2()) / sum : 0;
  }
  /// The sum of the cotangents of its angles: at least √3; infinite where there is no area.
  [[nodiscard]] double cotangents() const { return (a + b + c) / std::sqrt(sixteen_area2()); }
};

/// A cost as a whole number of 2^-bits, so that sums of them are exact and in any order the same. What is
/// larger than `most`, or no number, counts as that.
[[nodiscard]] inline std::int64_t fixed_point(double cost, double unit, double most) {
  const double scaled = cost * unit;
  return static_cast<std::int64_t>((scaled < most ? scaled : most) + 0.5);
}

}  // namespace vkmesh::detail
