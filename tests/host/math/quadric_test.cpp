#include "math/quadric.h"

#include <array>
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

namespace vkmesh {
namespace {

using detail::DeviceArithmetic;
using detail::HostArithmetic;
using detail::Quadric;
using detail::Vector3;

using DVector = std::array<double, 3>;

/// A plane n·x = d with a weight, as the quadric should sum it: w (n·x − d)².
struct Plane {
  DVector n;
  double d, w;

  [[nodiscard]] double error(const DVector& x) const {
    const double apart = n[0] * x[0] + n[1] * x[1] + n[2] * x[2] - d;
    return w * apart * apart;
  }
};

DVector wide(const Vector3& x) {
  return {x[0], x[1], x[2]};
}
Vector3 narrow(const DVector& x) {
  return {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
}

/// Planes of random directions near the origin, or through it.
std::array<Plane, 5> some_planes(std::mt19937& random, bool through_origin) {
  std::uniform_real_distribution<double> any(-1, 1);
  std::array<Plane, 5> planes;
  for (Plane& plane : planes) {
    plane.n = {any(random), any(random), any(random)};
    const double length = std::hypot(plane.n[0], plane.n[1], plane.n[2]);
    for (double& x : plane.n) x /= length;
    plane.d = through_origin ? 0 : 0.1 * any(random);
    plane.w = 0.5 + 0.5 * any(random);
  }
  return planes;
}

Quadric sum_of(const std::array<Plane, 5>& planes) {
  Quadric sum;
  for (const Plane& plane : planes)
    sum.add_square(narrow(plane.n), static_cast<float>(-plane.d), static_cast<float>(plane.w));
  return sum;
}

double error(const std::array<Plane, 5>& planes, const DVector& x) {
  double sum = 0;
  for (const Plane& plane : planes) sum += plane.error(x);
  return sum;
}

}  // namespace

TEST_CASE("a quadric is the sum of weighted squared distances from planes", "[quadric]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 1000; ++round) {
    const auto planes = some_planes(random, false);
    Quadric quadric = sum_of(planes);
    const DVector x = {any(random), any(random), any(random)};
    CHECK(static_cast<double>(quadric.value(narrow(x))) == Approx(error(planes, x)).margin(2e-6));
    // About another origin, and a share of it.
    const Vector3 d = narrow({any(random), any(random), any(random)});
    quadric.shift(d);
    CHECK(static_cast<double>(quadric.c) == Approx(error(planes, wide(d))).margin(2e-6));
    const DVector from = {x[0] - d[0], x[1] - d[1], x[2] - d[2]};
    CHECK(static_cast<double>(quadric.value(narrow(from))) == Approx(error(planes, x)).margin(5e-6));
    Quadric half;
    half.add(quadric, 0.5f);
    CHECK(static_cast<double>(half.value(narrow(from))) == Approx(0.5 * error(planes, x)).margin(5e-6));
  }
}

TEST_CASE("a quadric is never less than 0", "[quadric]") {
  Quadric quadric;
  quadric.c = -1e-7f;
  CHECK(quadric.value({}) == 0);
  quadric.shift({});
  CHECK(quadric.c == 0);
}

TEST_CASE("planes through the origin have quadrics without linear and constant terms", "[quadric]") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 100; ++round) {
    const auto planes = some_planes(random, true);
    Quadric host, device;
    for (const Plane& plane : planes) {
      const auto n = narrow(plane.n);
      const auto w = static_cast<float>(plane.w);
      host.a = detail::plus(host.a, detail::plane_quadric<HostArithmetic>(n, w));
      device.a = detail::plus(device.a, detail::plane_quadric<DeviceArithmetic>(n, w));
    }
    const DVector x = {any(random), any(random), any(random)};
    CHECK(static_cast<double>(host.value(narrow(x))) == Approx(error(planes, x)).margin(2e-6));
    CHECK(static_cast<double>(device.value(narrow(x))) == Approx(error(planes, x)).margin(2e-6));
  }
}

TEMPLATE_TEST_CASE("the way to the least error leads to where the gradient vanishes", "[quadric]",
                   HostArithmetic, DeviceArithmetic) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 1000; ++round) {
    const auto planes = some_planes(random, false);
    const Quadric quadric = sum_of(planes);
    const Vector3 d = {1, 0.25f, -0.5f};
    const Vector3 s = detail::way_to_least<TestType>(quadric.a, quadric.b, d);
    if (s == Vector3{}) continue;
    // By Cramer's rule in double precision.
    const auto& a = quadric.a;
    const std::array<DVector, 3> m = {DVector{a[0], a[1], a[2]}, {a[1], a[3], a[4]}, {a[2], a[4], a[5]}};
    const auto det = [](const std::array<DVector, 3>& r) {
      return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
             r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
             r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
    };
    const double whole = det(m);
    if (whole < 1e-3) continue;  // nearly flat
    for (std::size_t k = 0; k < 3; ++k) {
      auto replaced = m;
      for (std::size_t row = 0; row < 3; ++row) replaced[row][k] = -static_cast<double>(quadric.b[row]);
      CHECK(static_cast<double>(s[k]) == Approx(det(replaced) / whole).margin(1e-4));
    }
  }
}

TEMPLATE_TEST_CASE("the way to the least error keeps to the middle where nothing is determined", "[quadric]",
                   HostArithmetic, DeviceArithmetic) {
  const Vector3 d = {1, 0, 0};
  // No planes, one plane, and two planes whose line passes near the middle.
  CHECK(detail::way_to_least<TestType>({}, {}, d) == Vector3{});
  Quadric one;
  one.add_square({0, 0, 1}, -0.5f, 1);
  const Vector3 up = detail::way_to_least<TestType>(one.a, one.b, d);
  CHECK(up[0] == Approx(0).margin(1e-6));
  CHECK(up[1] == Approx(0).margin(1e-6));
  CHECK(up[2] == Approx(0.5));
  // Farther than twice the edge.
  Quadric far;
  far.add_square({0, 0, 1}, -2.5f, 1);
  CHECK(detail::way_to_least<TestType>(far.a, far.b, d) == Vector3{});
}

}  // namespace vkmesh
