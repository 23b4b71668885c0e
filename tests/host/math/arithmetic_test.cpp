#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include <vkmesh/math/arithmetic.h>

#include "support/data.h"

using namespace vkmesh;

namespace {

// The distance of `actual` from `exact`, in units of the last place of a float near `exact`.
double ulps(float actual, long double exact) {
  const float near = static_cast<float>(exact);
  const float ulp = std::nextafter(std::fabs(near), std::numeric_limits<float>::infinity()) - std::fabs(near);
  return static_cast<double>(std::fabs(static_cast<long double>(actual) - exact) /
                             static_cast<long double>(ulp));
}

// Every float in [low, high] whose bits are a multiple of `stride` above those of `low`.
template <class F>
void sweep(float low, float high, std::uint32_t stride, F&& f) {
  const std::uint32_t last = std::bit_cast<std::uint32_t>(high);
  for (std::uint64_t bits = std::bit_cast<std::uint32_t>(low); bits <= last; bits += stride)
    f(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
}

// The largest errors over the floats whose bits are multiples of `stride`, the whole range of each function.
struct WorstErrors {
  double arccosine = 0, exponential = 0;
  std::size_t undefined = 0;  // Results outside of what is promised.
};

WorstErrors worst_errors(std::uint32_t stride) {
  WorstErrors worst;
  const long double smallest = std::numeric_limits<float>::min(), largest = std::numeric_limits<float>::max();
  for (std::uint64_t bits = 0; bits <= 0xffffffffu; bits += stride) {
    const float x = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    const float angle = exact::arccosine(x), power = exact::exponential(x);
    worst.undefined += !(angle >= 0.0f && angle <= 3.1415927f && power >= 0.0f && power <= largest);
    if (std::isnan(x)) continue;
    const long double held = std::clamp(static_cast<long double>(x), -1.0L, 1.0L);
    worst.arccosine = std::max(worst.arccosine, ulps(angle, std::acos(held)));
    // Past the range of floats the ends of the range are the answers.
    const long double exact = std::exp(static_cast<long double>(x));
    if (exact < smallest * (1 - 0x1p-24L))
      worst.undefined += power != 0.0f;
    else if (exact > largest)
      worst.undefined += power != std::numeric_limits<float>::max();
    else
      worst.exponential = std::max(worst.exponential, ulps(power, exact));
  }
  return worst;
}

void check_errors(const WorstErrors& worst) {
  INFO("arccosine " << worst.arccosine << " ULP, exponential " << worst.exponential << " ULP");
  CHECK(worst.arccosine <= 1.5);
  CHECK(worst.exponential <= 1.0);
  CHECK(worst.undefined == 0);
}

}  // namespace

TEST_CASE("arccosine within 1.5 ULP, exponential within 1 ULP, over their whole range") {
  check_errors(worst_errors(4093));
}

TEST_CASE("arccosine and exponential on every float", "[.long]") {
  check_errors(worst_errors(1));
}

// Over the floats of which the bits are multiples of `stride`.
double worst_cube_root(float low, float high, std::uint32_t stride) {
  double worst = 0;
  sweep(low, high, stride, [&](float x) {
    worst = std::max(worst, ulps(exact::cube_root(x), std::cbrt(static_cast<long double>(x))));
  });
  return worst;
}

// The arctangent of y as the angle of (1, y).
double worst_arctangent(float low, float high, std::uint32_t stride) {
  double worst = 0;
  sweep(low, high, stride, [&](float y) {
    worst =
        std::max(worst, ulps(exact::first_quadrant_angle(y, 1.0f), std::atan(static_cast<long double>(y))));
  });
  return worst;
}

TEST_CASE("cube root within 0.51 ULP: a sixteenth of the mantissas, every exponent") {
  const double worst = worst_cube_root(0x1p-126f, std::numeric_limits<float>::max(), 4093);
  const double mantissas = worst_cube_root(1.0f, 7.9999995f, 17);
  INFO("worst " << worst << " and " << mantissas);
  CHECK(worst <= 0.51);
  CHECK(mantissas <= 0.51);
  CHECK(exact::cube_root(27.0f) == 3.0f);
  CHECK(exact::cube_root(0x1p-126f) == 0x1p-42f);
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float x : {0.0f, -0.0f, -8.0f, 0x1p-127f, infinity, std::numeric_limits<float>::quiet_NaN()})
    CHECK(std::bit_cast<std::uint32_t>(exact::cube_root(x)) == 0u);
}

TEST_CASE("cube root on every normal float, arctangent on every float of its range", "[.long]") {
  const double cube = worst_cube_root(0x1p-126f, std::numeric_limits<float>::max(), 1);
  const double arctangent = worst_arctangent(0x1p-61f, 0x1p60f, 1);
  INFO("cube root " << cube << " ULP, arctangent " << arctangent << " ULP");
  CHECK(cube <= 0.51);
  CHECK(arctangent <= 4.0);
}

TEST_CASE("reciprocal and the roots on every normal float", "[.long]") {
  double worst_reciprocal = 0, worst_reciprocal_root = 0;
  std::size_t wrong = 0;
  sweep(0x1p-126f, std::numeric_limits<float>::max(), 1, [&](float x) {
    const long double exact = std::sqrt(static_cast<long double>(x));
    // Where 1 / x is subnormal the answer is 0.
    if (x <= 0x1p126f)
      worst_reciprocal = std::max(worst_reciprocal, ulps(exact::reciprocal(x), 1.0L / x));
    else
      wrong += exact::reciprocal(x) != 0.0f;
    worst_reciprocal_root = std::max(worst_reciprocal_root, ulps(exact::reciprocal_root(x), 1.0L / exact));
    wrong += exact::root(x) != static_cast<float>(exact);
  });
  INFO("reciprocal " << worst_reciprocal << " ULP, reciprocal root " << worst_reciprocal_root << " ULP");
  CHECK(worst_reciprocal <= 0.5001);
  CHECK(worst_reciprocal_root <= 0.5001);
  CHECK(wrong == 0);
}

TEST_CASE("arccosine and exponential at their ends") {
  const float infinity = std::numeric_limits<float>::infinity(),
              nan = std::numeric_limits<float>::quiet_NaN();
  for (const float x : {1.0f, 1.5f, infinity, nan}) {
    CHECK(exact::arccosine(x) == 0.0f);
    CHECK(exact::arccosine(-x) == 3.14159265f);
  }
  CHECK(exact::exponential(-infinity) == 0.0f);
  CHECK(exact::exponential(-nan) == 0.0f);
  CHECK(exact::arccosine(0.0f) == 1.57079633f);
  CHECK(exact::arccosine(-0x1p-149f) == 1.57079633f);
  CHECK(exact::exponential(0.0f) == 1.0f);
  CHECK(exact::exponential(0x1p-149f) == 1.0f);
  CHECK(exact::exponential(infinity) == std::numeric_limits<float>::max());
  CHECK(exact::exponential(nan) == std::numeric_limits<float>::max());
  CHECK(exact::exponential(-87.4f) == 0.0f);
}

TEST_CASE(
    "reciprocal and reciprocal root within 0.5001 ULP, root correctly rounded: every mantissa, every "
    "exponent") {
  // The steps depend on the mantissa and on the parity of the exponent only; exponents are integer
  // arithmetic.
  double worst_reciprocal = 0, worst_reciprocal_root = 0;
  std::size_t wrong = 0;
  const auto check = [&](float x) {
    const long double exact = std::sqrt(static_cast<long double>(x));
    worst_reciprocal = std::max(worst_reciprocal, ulps(exact::reciprocal(x), 1.0L / x));
    worst_reciprocal_root = std::max(worst_reciprocal_root, ulps(exact::reciprocal_root(x), 1.0L / exact));
    wrong += exact::root(x) != static_cast<float>(exact);
    wrong += exact::reciprocal(-x) != -exact::reciprocal(x);
  };
  sweep(1.0f, 3.9999998f, test::kSanitized ? 17 : 1, check);
  sweep(0x1p-126f, 0x1p126f, 4093, check);
  CHECK(worst_reciprocal <= 0.5001);
  CHECK(worst_reciprocal_root <= 0.5001);
  CHECK(wrong == 0);
}

TEST_CASE("reciprocal and the roots are zero where they are not defined") {
  const float infinity = std::numeric_limits<float>::infinity(),
              nan = std::numeric_limits<float>::quiet_NaN();
  for (const float x : {0.0f, -0.0f, 0x1p-127f, -0x1p-149f, infinity, -infinity, nan}) {
    CHECK(std::bit_cast<std::uint32_t>(exact::reciprocal(x)) == 0u);
    CHECK(std::bit_cast<std::uint32_t>(exact::reciprocal_root(x)) == 0u);
    CHECK(std::bit_cast<std::uint32_t>(exact::root(x)) == 0u);
  }
  CHECK(std::bit_cast<std::uint32_t>(exact::root(-2.0f)) == 0u);
  CHECK(std::bit_cast<std::uint32_t>(exact::reciprocal_root(-2.0f)) == 0u);
  CHECK(exact::reciprocal(0x1p126f) == 0x1p-126f);
  CHECK(exact::reciprocal(std::nextafter(0x1p126f, infinity)) == 0.0f);
  CHECK(exact::reciprocal(std::numeric_limits<float>::max()) == 0.0f);
  CHECK(exact::root(std::numeric_limits<float>::max()) == 0x1.fffffep63f);
}

TEST_CASE("first-quadrant angle is within 4 ULP") {
  double worst = 0;
  sweep(0x1p-61f, 0x1p60f, 1009, [&](float y) {
    for (const float x : {1.0f, 0.7f, 1.9999999f, 0x1p-61f, 0x1p60f})
      worst = std::max(worst, ulps(exact::first_quadrant_angle(y, x),
                                   std::atan2(static_cast<long double>(y), static_cast<long double>(x))));
  });
  INFO("worst " << worst);
  CHECK(worst <= 4.0);
  CHECK(exact::first_quadrant_angle(0.0f, 1.0f) == 0.0f);
  CHECK(ulps(exact::first_quadrant_angle(1.0f, 0.0f), std::acos(0.0L)) <= 0.5);
}

TEST_CASE("unit vectors have length 1 and the direction of their argument, from tiny to huge") {
  std::mt19937 random(3);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const auto component = [&] {
      const float mantissa = static_cast<float>(random() >> 8) / 8388608.0f - 1.0f;
      return mantissa * std::ldexp(1.0f, static_cast<int>(random() % 20u));
    };
    const int exponent = static_cast<int>(random() % 200u) - 100;
    const Vec3 v = Vec3(component(), component(), component()) * std::ldexp(1.0f, exponent);
    const long double x = v.x, y = v.y, z = v.z, length = std::sqrt(x * x + y * y + z * z);
    const Vec3 u = unit_vector(v);
    // Absolute, in units of the last place of 1: a component far below the others has no more to say.
    for (const auto& [a, b] : {std::pair{u.x, x / length}, {u.y, y / length}, {u.z, z / length}})
      worst = std::max(worst, static_cast<double>(std::fabs(a - b)) / 0x1p-23);
  }
  INFO("worst " << worst);
  CHECK(worst <= 4.0);
}

TEST_CASE("unit vectors of zero, infinite and undefined vectors are zero") {
  const float infinity = std::numeric_limits<float>::infinity(),
              nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3 v :
       {Vec3(0.0f), Vec3(-0.0f), Vec3(infinity, 1, 1), Vec3(1, nan, 1), Vec3(0, 0, -infinity)}) {
    const Vec3 u = unit_vector(v);
    for (int k = 0; k < 3; ++k) CHECK(std::bit_cast<std::uint32_t>(u[k]) == 0u);
  }
}

TEST_CASE("the angle between unit vectors is accurate from flat to folded") {
  double worst = 0;
  for (int i = 0; i <= 20000; ++i) {
    // Angles from 1e-7 to π, dense at both ends.
    const double t = i / 20000.0, angle = 3.14159 * t * t * (3 - 2 * t) + 1e-7;
    const Vec3 a = unit_vector(Vec3(0.3f, -0.5f, 0.8f));
    const Vec3 p = unit_vector(Vec3(0.8f, 0.0f, -0.3f));
    const Vec3 b =
        unit_vector(a * static_cast<float>(std::cos(angle)) + p * static_cast<float>(std::sin(angle)));
    const DVec3 da(a), db(b);
    const DVec3 c(da.y * db.z - da.z * db.y, da.z * db.x - da.x * db.z, da.x * db.y - da.y * db.x);
    const double exact =
        std::atan2(std::sqrt(c.x * c.x + c.y * c.y + c.z * c.z), da.x * db.x + da.y * db.y + da.z * db.z);
    // The lengths of a and b may be off by 4 ULP each, which turns into as much of the angle at either end.
    worst = std::max(worst, std::fabs(static_cast<double>(angle_between(a, b)) - exact) / 0x1p-23);
  }
  INFO("worst " << worst);
  CHECK(worst <= 8.0);
  CHECK(angle_between(Vec3(0, 0, 1), Vec3(0, 0, 1)) == 0.0f);
  CHECK(angle_between(Vec3(0, 0, 1), Vec3(0, 0, -1)) == 3.14159265f);
  CHECK(angle_between(Vec3(0.0f), Vec3(0, 0, 1)) == 0.0f);
}

TEST_CASE("length, cotangent and angle of a corner, from tiny to huge") {
  std::mt19937 random(5);
  double worst_length = 0, worst_cotangent = 0, worst_angle = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto component = [&] { return static_cast<float>(random() >> 8) / 8388608.0f - 1.0f; };
    const float unit = std::ldexp(1.0f, static_cast<int>(random() % 80u) - 40);
    const Vec3 p0(0.0f), p1 = Vec3(component(), component(), component()) * unit,
                         p2 = Vec3(component(), component(), component()) * unit;
    const DVec3 a(p1), b(p2);
    const DVec3 c(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    const double dot = a.x * b.x + a.y * b.y + a.z * b.z, area = std::sqrt(c.x * c.x + c.y * c.y + c.z * c.z),
                 sizes = std::sqrt((a.x * a.x + a.y * a.y + a.z * a.z) * (b.x * b.x + b.y * b.y + b.z * b.z));
    const float twice_area = vector_length(area_vector(p0, p1, p2)), product = corner_product(p0, p1, p2);
    worst_length = std::max(
        worst_length,
        ulps(vector_length(p1), std::sqrt(static_cast<long double>(a.x * a.x + a.y * a.y + a.z * a.z))));
    // Both products carry roundings of |a||b|, which move the angle by as much.
    worst_angle = std::max(worst_angle, std::fabs(corner_angle(product, twice_area) - std::atan2(area, dot)));
    if (area > 0.01 * sizes)
      worst_cotangent = std::max(worst_cotangent, std::fabs(cotangent(product, twice_area) - dot / area) *
                                                      std::pow(area / sizes, 2));
  }
  INFO("length " << worst_length << " ULP, angle " << worst_angle / 0x1p-23 << ", cotangent "
                 << worst_cotangent / 0x1p-23);
  CHECK(worst_length <= 4.0);
  CHECK(worst_angle <= 8 * 0x1p-23);
  CHECK(worst_cotangent <= 8 * 0x1p-23);
}

TEST_CASE("cotangents are bounded, and corners without area have angles 0 or π") {
  const Vec3 o(0.0f), x(1, 0, 0);
  const auto cotangent_at = [](Vec3 p0, Vec3 p1, Vec3 p2) {
    return cotangent(corner_product(p0, p1, p2), vector_length(area_vector(p0, p1, p2)));
  };
  const auto angle_at = [](Vec3 p0, Vec3 p1, Vec3 p2) {
    return corner_angle(corner_product(p0, p1, p2), vector_length(area_vector(p0, p1, p2)));
  };
  CHECK(cotangent_at(o, x, Vec3(0, 2, 0)) == 0.0f);
  CHECK(cotangent_at(o, x, Vec3(1, 1, 0)) == 1.0f);
  CHECK(cotangent_at(o, x, Vec3(-1, 1, 0)) == -1.0f);
  CHECK(cotangent_at(o, 0x1p59f * x, Vec3(0x1p59f, 0x1p-60f, 0)) == 1024.0f);
  CHECK(cotangent_at(o, 0x1p59f * x, Vec3(-0x1p59f, 0x1p-60f, 0)) == -1024.0f);
  CHECK(cotangent_at(o, x, 2.0f * x) == 0.0f);
  CHECK(cotangent_at(o, o, o) == 0.0f);
  CHECK(angle_at(o, x, 2.0f * x) == 0.0f);
  CHECK(angle_at(o, x, -2.0f * x) == 3.14159265f);
  CHECK(angle_at(o, x, Vec3(0, 0x1p-59f, 0)) == 1.57079633f);
  CHECK(angle_at(o, o, x) == 0.0f);
}

TEST_CASE("no step of the geometry makes a subnormal: tiny values count as zero") {
  const float tiny = 0x1p-140f;
  CHECK(area_vector(Vec3(0.0f), Vec3(tiny, 0, 0), Vec3(0, tiny, 0)) == Vec3(0.0f));
  CHECK(area_vector(Vec3(0.0f), Vec3(0x1p-51f, 0, 0), Vec3(0, 0x1p-50f, 0)) == Vec3(0.0f));
  CHECK(area_vector(Vec3(0.0f), Vec3(0x1p-50f, 0, 0), Vec3(0, 0x1p-50f, 0)) == Vec3(0, 0, 0x1p-100f));
  CHECK(std::signbit(zero_below(-tiny, 0x1p-100f)) == false);
  CHECK(std::signbit(zero_below(-0.0f, 0x1p-100f)) == false);
}

TEST_CASE("positions beyond the range of the arithmetic are refused, by vertex") {
  std::vector<Vec3> positions(3, Vec3(1.0f)), prepared(3);
  CHECK(prepare_positions(positions, prepared));
  positions[1] = Vec3(-0.0f, 0x1p-120f, -0x1p-100f);
  REQUIRE(prepare_positions(positions, prepared));
  CHECK(prepared[1] == Vec3(0, 0, -0x1p-100f));
  for (const float bad :
       {0x1p60f, -0x1p61f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    positions[2] = Vec3(0, bad, 0);
    const auto result = prepare_positions(positions, prepared);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kUnsuitable);
    CHECK_THAT(result.error().message, Catch::Contains("coordinate 1 of vertex 2"));
  }
  CHECK(prepare_positions(positions, std::span(prepared).first(2)).error().code == ErrorCode::kUsage);
}
