// The arithmetic that gives the same bytes on every device: 32-bit + - *, comparisons and integers, in one
// order. Twin of shaders/arithmetic.glsl, function by function; docs/exactness.md says why.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include <vkmesh/passes/arithmetic_constants.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

namespace vkmesh {

/// Coordinates must lie below this in magnitude (2^60), so that no sum of products overflows on the way.
inline constexpr float kMaxCoordinate = 1152921504606846976.0f;

/// x, or +0 where |x| < limit.
[[nodiscard]] inline float zero_below(float x, float limit) {
  return std::fabs(x) < limit ? 0.0f : x;
}

[[nodiscard]] inline Vec3 zero_below(Vec3 v, float limit) {
  return {zero_below(v.x, limit), zero_below(v.y, limit), zero_below(v.z, limit)};
}

/// 1 / x for x in [2^-100, 2^100], within 2 ULP: Newton's iteration from an integer seed.
[[nodiscard]] inline float reciprocal(float x) {
  float y = std::bit_cast<float>(VKMESH_RECIPROCAL_SEED - std::bit_cast<std::uint32_t>(x));
  for (int i = 0; i < 3; ++i) y = y * (2.0f - x * y);
  return y + y * (1.0f - x * y);
}

/// 1 / √x for x in [2^-122, 2^100], within 2 ULP: Newton's iteration from an integer seed.
[[nodiscard]] inline float reciprocal_root(float x) {
  float y = std::bit_cast<float>(VKMESH_RECIPROCAL_ROOT_SEED - (std::bit_cast<std::uint32_t>(x) >> 1));
  const float half = 0.5f * x;
  for (int i = 0; i < 3; ++i) y = y * (1.5f - (half * y) * y);
  return y + y * (0.5f - (half * y) * y);
}

/// √x for x = 0 or x in [2^-122, 2^100], within 2 ULP.
[[nodiscard]] inline float root(float x) {
  return x == 0.0f ? 0.0f : x * reciprocal_root(x);
}

/// The angle in [0, π/2] of the vector (x, y), for x and y in {0} ∪ [2^-61, 2^60], x + y > 0; within 4 ULP.
[[nodiscard]] inline float first_quadrant_angle(float y, float x) {
  const bool steep = y > x;
  const float t = (steep ? x : y) * reciprocal(steep ? y : x);
  const float u = zero_below(t * t, VKMESH_TINY_COORDINATE);
  float p = VKMESH_ATAN_9;
  p = p * u + VKMESH_ATAN_8;
  p = p * u + VKMESH_ATAN_7;
  p = p * u + VKMESH_ATAN_6;
  p = p * u + VKMESH_ATAN_5;
  p = p * u + VKMESH_ATAN_4;
  p = p * u + VKMESH_ATAN_3;
  p = p * u + VKMESH_ATAN_2;
  p = p * u + VKMESH_ATAN_1;
  p = p * u + VKMESH_ATAN_0;
  const float angle = t * p;
  return steep ? (VKMESH_HALF_PI_HIGH - angle) + VKMESH_HALF_PI_LOW : angle;
}

/// |v|² for components in {0} ∪ [2^-61, 2^50].
[[nodiscard]] inline float squared_length(Vec3 v) {
  return (v.x * v.x + v.y * v.y) + v.z * v.z;
}

/// (p1 − p0) × (p2 − p0): twice the area of the triangle, along its normal.
[[nodiscard]] inline Vec3 area_vector(Vec3 p0, Vec3 p1, Vec3 p2) {
  const Vec3 a = zero_below(p1 - p0, VKMESH_TINY_LENGTH);
  const Vec3 b = zero_below(p2 - p0, VKMESH_TINY_LENGTH);
  return zero_below(Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x),
                    VKMESH_TINY_AREA);
}

/// v / |v| for components in {0} ∪ [2^-126, 2^127], each within 4 ULP of 1; the zero vector where v is zero
/// or not finite.
[[nodiscard]] inline Vec3 unit_vector(Vec3 v) {
  const auto magnitude = [](float x) { return std::bit_cast<std::uint32_t>(x) & 0x7fffffffu; };
  const std::uint32_t largest = std::max(std::max(magnitude(v.x), magnitude(v.y)), magnitude(v.z));
  if (largest == 0u || largest >= 0x7f800000u) return Vec3(0.0f);
  // A power of two brings the largest component into [1, 4): squares then neither overflow nor vanish.
  const float scale = std::bit_cast<float>(std::max(0x7f000000u - (largest & 0x7f800000u), 0x00800000u));
  const Vec3 w = zero_below(v * scale, VKMESH_TINY_DIRECTION);
  return w * reciprocal_root(squared_length(w));
}

/// The angle between two unit vectors, in [0, π], within 8 ULP; 0 where either is the zero vector.
/// W. Kahan's 2 atan2(|a − b|, |a + b|): accurate for small and for nearly straight angles.
[[nodiscard]] inline float angle_between(Vec3 a, Vec3 b) {
  if (squared_length(a) == 0.0f || squared_length(b) == 0.0f) return 0.0f;
  const float apart = root(squared_length(zero_below(a - b, VKMESH_TINY_LENGTH)));
  const float along = root(squared_length(zero_below(a + b, VKMESH_TINY_LENGTH)));
  return 2.0f * first_quadrant_angle(apart, along);
}

/// What passes do to positions before they compute: coordinates below 2^-100 in magnitude become +0.
/// Errors: kUsage when the sizes differ; kUnsuitable for a coordinate that is not below kMaxCoordinate (or
/// not finite).
[[nodiscard]] Result<void> prepare_positions(std::span<const Vec3> positions, std::span<Vec3> prepared);

}  // namespace vkmesh
