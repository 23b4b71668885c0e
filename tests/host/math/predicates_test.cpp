#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include <catch2/catch.hpp>

#include <vkmesh/math/predicates.h>

#include "math/filtered_predicates.h"
#include "math/whole_number.h"

using namespace vkmesh;
using detail::WholeNumber;

namespace {

double next(double x, double towards = HUGE_VAL) {
  return std::nextafter(x, towards);
}

/// in_circle() of whole coordinates below 2^13, by the textbook's determinant.
int textbook(const std::array<std::array<std::int64_t, 2>, 4>& p) {
  std::array<std::array<std::int64_t, 3>, 3> m;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t x = p[i][0] - p[3][0], y = p[i][1] - p[3][1];
    m[i] = {x, y, x * x + y * y};
  }
  const std::int64_t sum = m[0][2] * (m[1][0] * m[2][1] - m[2][0] * m[1][1]) -
                           m[1][2] * (m[0][0] * m[2][1] - m[2][0] * m[0][1]) +
                           m[2][2] * (m[0][0] * m[1][1] - m[1][0] * m[0][1]);
  return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

}  // namespace

TEST_CASE("Orientation is the sign of the exact area", "[predicates]") {
  CHECK(orientation({0, 0}, {1, 0}, {0, 1}) == 1);
  CHECK(orientation({0, 0}, {0, 1}, {1, 0}) == -1);
  CHECK(orientation({0.1, 0.1}, {0.3, 0.3}, {0.7, 0.7}) == 0);
  // A last bit off the line, where rounded arithmetic sees nothing.
  const double x = 0.5 + 0x1p-53 * 12;
  CHECK(orientation({12, 12}, {24, 24}, {x, x}) == 0);
  CHECK(orientation({12, 12}, {24, 24}, {x, next(x)}) == 1);
  CHECK(orientation({12, 12}, {24, 24}, {next(x), x}) == -1);
  // Coordinates far apart in size, and subnormal ones.
  for (const double large : {1e3, 1e100, 1e300})
    for (const double small : {1e-3, 1e-100, 1e-320}) {
      CHECK(orientation({0, 0}, {large, small}, {-large, -small}) == 0);
      CHECK(orientation({0, 0}, {large, small}, {-large, -next(small)}) == -1);
      CHECK(orientation({0, 0}, {large, small}, {-large, -next(small, 0)}) == 1);
      CHECK(orientation({large, small}, {0, 0}, {large, next(small)}) == -1);
    }
}

TEST_CASE("In-circle is the sign of the textbook's determinant", "[predicates]") {
  std::mt19937 random(3);
  std::array<int, 3> seen{};
  for (int i = 0; i < 20000; ++i) {
    const unsigned range = i % 3 == 0 ? 8 : i % 3 == 1 ? 64 : 8192;
    std::array<std::array<std::int64_t, 2>, 4> p;
    std::array<DVec2, 4> q;
    const double unit = std::ldexp(1.0, i % 2 == 0 ? static_cast<int>(random() % 2000) - 1060 : 0);
    for (std::size_t k = 0; k < 4; ++k) {
      p[k] = {static_cast<std::int64_t>(random() % range), static_cast<std::int64_t>(random() % range)};
      q[k] = {static_cast<double>(p[k][0]) * unit, static_cast<double>(p[k][1]) * unit};
    }
    const int expected = textbook(p);
    ++seen[static_cast<std::size_t>(expected + 1)];
    if (in_circle(q[0], q[1], q[2], q[3]) != expected) FAIL("set " << i);
    if (detail::exact_in_circle(q[0], q[1], q[2], q[3]) != expected) FAIL("set " << i << ", exact");
  }
  for (const int n : seen) CHECK(n > 400);
}

TEST_CASE("In-circle knows rectangles of any shape, and a last bit", "[predicates]") {
  for (const double width : {1e300, 1e60, 3.0, 1e-60, 1e-320})
    for (const double height : {1e300, 1e60, 3.0, 1e-60, 1e-320}) {
      const DVec2 a(0, 0), b(width, 0), c(width, height), d(0, height);
      CHECK(in_circle(a, b, c, d) == 0);
      CHECK(in_circle(b, c, d, a) == 0);
      CHECK(in_circle(a, b, c, {0, next(height)}) == -1);
      CHECK(in_circle(a, b, c, {0, next(height, 0)}) == 1);
      CHECK(in_circle(a, c, b, {0, next(height, 0)}) == -1);
    }
}

TEST_CASE("In-circle of differences near the largest that machine words hold", "[predicates]") {
  for (int exponent = 50; exponent < 80; ++exponent) {
    const double width = std::ldexp(3.0, exponent);
    const DVec2 a(0, 0), b(width, 0), c(width, 3);
    CHECK(detail::exact_in_circle(a, b, c, {0, 4}) == -1);
    CHECK(detail::exact_in_circle(a, b, c, {0, 3}) == 0);
    CHECK(detail::exact_in_circle(a, b, c, {0, 2}) == 1);
    CHECK(detail::exact_orientation(a, c, {-width, -4}) == -1);
    CHECK(detail::exact_orientation(a, c, {-width, -2}) == 1);
  }
}

TEST_CASE("The perturbed circle has no fourth point", "[predicates]") {
  // The greatest point is lifted most: it is outside the circle of others, and takes the diagonal from those
  // beside it.
  const DVec2 a(0, 0), b(1, 0), c(1, 1), d(0, 1);
  CHECK(in_circle_perturbed(a, b, d, c) == -1);
  CHECK(in_circle_perturbed(a, b, c, d) == 1);
  CHECK(in_circle_perturbed(b, c, d, a) == -1);
  CHECK(in_circle_perturbed(a, c, d, b) == 1);
  // The least is no other's opposite here, so that lifting it would give the other diagonal.
  CHECK(in_circle_perturbed({4, 3}, {3, 4}, {-5, 0}, {5, 0}) == -1);
  CHECK(in_circle_perturbed({5, 0}, {4, 3}, {3, 4}, {-5, 0}) == 1);
  // An even permutation keeps the sign, an odd one turns it.
  const std::array<DVec2, 4> p = {DVec2(0, 5), DVec2(5, 0), DVec2(4, -3), DVec2(-3, 4)};
  std::array<std::size_t, 4> i = {0, 1, 2, 3};
  do {
    int inversions = 0;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t m = k + 1; m < 4; ++m) inversions += i[k] > i[m] ? 1 : 0;
    const int sign = inversions % 2 == 0 ? 1 : -1;
    CHECK(in_circle_perturbed(p[i[0]], p[i[1]], p[i[2]], p[i[3]]) ==
          sign * in_circle_perturbed(p[0], p[1], p[2], p[3]));
  } while (std::next_permutation(i.begin(), i.end()));
}

TEST_CASE("Whole numbers of many words add and multiply", "[predicates]") {
  std::mt19937_64 random(9);
  const auto any = [&] {
    return WholeNumber(static_cast<std::int64_t>(random() >> 10) - (std::int64_t{1} << 53),
                       static_cast<int>(random() % 2045));
  };
  for (int i = 0; i < 2000; ++i) {
    const WholeNumber a = any(), b = any(), c = any(), d = any();
    CHECK(((a + b) - b - a).sign() == 0);
    CHECK(((a + b) * (a - b) - (a * a - b * b)).sign() == 0);
    CHECK(((a - b) * (c - d) - (a * c - a * d - b * c + b * d)).sign() == 0);
    CHECK((a * b).sign() == a.sign() * b.sign());
    CHECK((a - WholeNumber(1, 0) - a).sign() == -1);
  }
  for (int i = 0; i < 2000; ++i) {
    const auto x = static_cast<std::int32_t>(random()), y = static_cast<std::int32_t>(random());
    const std::int64_t sum = std::int64_t{x} + y, product = std::int64_t{x} * y;
    CHECK((WholeNumber(x, 0) + WholeNumber(y, 0) - WholeNumber(sum, 0)).sign() == 0);
    CHECK((WholeNumber(x, 700) * WholeNumber(y, 3) - WholeNumber(product, 703)).sign() == 0);
  }
}
