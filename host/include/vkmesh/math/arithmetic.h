// The arithmetic that gives the same bytes on every device: 32-bit + - *, comparisons and integers, in one
// order. Twin of shaders/lib/arithmetic.glsl, function by function; docs/exactness.md says why.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/arithmetic_constants.h>
#include <vkmesh/math/vec.h>

// The linker keeps one copy of an inline function, and the library's must be the exact one: a program
// compiled with -ffast-math keeps its copies to itself.
#if defined(__FAST_MATH__)
#define VKMESH_EXACT_INLINE static inline
#else
#define VKMESH_EXACT_INLINE inline
#endif

namespace vkmesh {

/// Coordinates must lie below this in magnitude (2^60), so that no sum of products overflows on the way.
inline constexpr float kMaxCoordinate = 1152921504606846976.0f;

/// x, or +0 where |x| < limit.
[[nodiscard]] VKMESH_EXACT_INLINE float zero_below(float x, float limit) {
  return std::fabs(x) < limit ? 0.0f : x;
}

[[nodiscard]] VKMESH_EXACT_INLINE Vec3 zero_below(Vec3 v, float limit) {
  return {zero_below(v.x, limit), zero_below(v.y, limit), zero_below(v.z, limit)};
}

namespace detail {

[[nodiscard]] VKMESH_EXACT_INLINE std::uint32_t bits(float x) {
  return std::bit_cast<std::uint32_t>(x);
}
[[nodiscard]] VKMESH_EXACT_INLINE float from_bits(std::uint32_t b) {
  return std::bit_cast<float>(b);
}

/// x − a·b, nearly exact where a·b is close to x: the products of 12-bit halves are exact (T. J. Dekker, "A
/// floating-point technique for extending the available precision", 1971, §5; halved by masking).
[[nodiscard]] VKMESH_EXACT_INLINE float residual(float x, float a, float b) {
  const float ah = from_bits(bits(a) & 0xfffff000u), al = a - ah;
  const float bh = from_bits(bits(b) & 0xfffff000u), bl = b - bh;
  return (((x - ah * bh) - ah * bl) - al * bh) - al * bl;
}

/// 1 / √m for m in [1, 4), within 2 ULP.
[[nodiscard]] VKMESH_EXACT_INLINE float rough_reciprocal_root(float m) {
  float y = from_bits(VKMESH_RECIPROCAL_ROOT_SEED - (bits(m) >> 1));
  const float half = 0.5f * m;
  for (int i = 0; i < 3; ++i) y = y * (1.5f - (half * y) * y);
  return y;
}

/// The part m in [1, 4) of x = m · 4^k.
[[nodiscard]] VKMESH_EXACT_INLINE float even_mantissa(std::uint32_t x) {
  return from_bits((x & 0x007fffffu) | ((x & 0x00800000u) != 0u ? 0x3f800000u : 0x40000000u));
}

}  // namespace detail

/// Scalar functions that <cmath> and GLSL leave inexact.
namespace exact {

/// 1 / x within 0.5001 ULP, by Newton's iteration from an integer seed and one step with an exact residual.
/// 0 where x is zero, subnormal or not finite, and where 1 / x would be subnormal.
[[nodiscard]] VKMESH_EXACT_INLINE float reciprocal(float x) {
  const std::uint32_t magnitude = detail::bits(x) & 0x7fffffffu, exponent = magnitude >> 23;
  const float m = detail::from_bits((magnitude & 0x007fffffu) | 0x3f800000u);
  float y = detail::from_bits(VKMESH_RECIPROCAL_SEED - detail::bits(m));
  for (int i = 0; i < 3; ++i) y = y * (2.0f - m * y);
  y = y + y * detail::residual(1.0f, m, y);
  // y lies in [1/2, 1]: shift its exponent by that of 1 / x, in integers, so that no step can be subnormal.
  const std::uint32_t result = detail::bits(y) + (127u << 23) - (exponent << 23);
  const bool defined = exponent - 1u < 253u && (result & 0x7f800000u) != 0u;
  return defined ? detail::from_bits(result | (detail::bits(x) & 0x80000000u)) : 0.0f;
}

/// 1 / √x within 0.5001 ULP, by the same means. 0 unless x is positive, normal and finite.
[[nodiscard]] VKMESH_EXACT_INLINE float reciprocal_root(float x) {
  const std::uint32_t b = detail::bits(x), exponent = b >> 23;
  const float m = detail::even_mantissa(b);
  const float y = detail::rough_reciprocal_root(m);
  const float square = y * y;
  const float r = detail::residual(1.0f, m, square) + m * detail::residual(square, y, y);
  const float refined = y + y * (0.5f * r);
  return exponent - 1u < 254u
             ? detail::from_bits(detail::bits(refined) + (127u << 23) - (((exponent + 127u) >> 1) << 23))
             : 0.0f;
}

/// √x, correctly rounded, by the same means. 0 unless x is positive, normal and finite.
[[nodiscard]] VKMESH_EXACT_INLINE float root(float x) {
  const std::uint32_t b = detail::bits(x), exponent = b >> 23;
  const float m = detail::even_mantissa(b);
  const float y = detail::rough_reciprocal_root(m);
  const float s = m * y;
  const float refined = s + (0.5f * y) * detail::residual(m, s, s);
  return exponent - 1u < 254u
             ? detail::from_bits(detail::bits(refined) - (127u << 23) + (((exponent + 127u) >> 1) << 23))
             : 0.0f;
}

/// ∛x within 0.51 ULP, by the same means. 0 unless x is positive, normal and finite.
[[nodiscard]] VKMESH_EXACT_INLINE float cube_root(float x) {
  const std::uint32_t b = detail::bits(x), exponent = b >> 23;
  // x = m · 8^k with m in [1, 8).
  const float m = detail::from_bits((b & 0x007fffffu) | ((127u + (exponent + 2u) % 3u) << 23));
  float y = detail::from_bits(VKMESH_RECIPROCAL_CUBE_ROOT_SEED - detail::bits(m) / 3u);
  const float third = VKMESH_THIRD * m;
  for (int i = 0; i < 4; ++i) y = y * (VKMESH_FOUR_THIRDS - third * ((y * y) * y));
  const float square = y * y;
  const float z = m * square;
  const float s = z * z;
  const float r = detail::residual(m, s, z) + detail::residual(s, z, z) * z;
  const float refined = z + (VKMESH_THIRD * square) * r;
  return exponent - 1u < 254u
             ? detail::from_bits(detail::bits(refined) + (((exponent + 2u) / 3u) << 23) - (43u << 23))
             : 0.0f;
}

/// The angle in [0, π/2] of the vector (x, y), for x and y in {0} ∪ [2^-61, 2^60]; within 4 ULP. 0 for (0,
/// 0).
[[nodiscard]] VKMESH_EXACT_INLINE float first_quadrant_angle(float y, float x) {
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

/// arccos x in [0, π], within 1.5 ULP; x is held in [−1, 1] (a NaN counts as 1 with its sign).
[[nodiscard]] VKMESH_EXACT_INLINE float arccosine(float x) {
  const std::uint32_t magnitude = std::min(detail::bits(x) & 0x7fffffffu, 0x3f800000u);
  const bool negative = (detail::bits(x) >> 31) != 0u;
  const float size = zero_below(detail::from_bits(magnitude), VKMESH_TINY_LENGTH);
  // Beyond 1/2, arccos x = 2 arcsin √((1 − x) / 2), in which 1 − x is exact.
  const bool steep = size > 0.5f;
  const float z = zero_below(steep ? 0.5f * (1.0f - size) : size * size, VKMESH_TINY_DIRECTION);
  const float s = steep ? root(z) : (negative ? -size : size);
  float p = VKMESH_ASIN_5;
  p = p * z + VKMESH_ASIN_4;
  p = p * z + VKMESH_ASIN_3;
  p = p * z + VKMESH_ASIN_2;
  p = p * z + VKMESH_ASIN_1;
  p = p * z + VKMESH_ASIN_0;
  const float more = s * (z * p);
  const float complement = VKMESH_HALF_PI_HIGH - (s - (VKMESH_HALF_PI_LOW - more));
  return steep ? 2.0f * (negative ? complement : s + more) : complement;
}

/// e^x, within 1 ULP; 0 where that would be subnormal, and the largest float where it would be larger (a NaN
/// counts as an infinity with its sign).
[[nodiscard]] VKMESH_EXACT_INLINE float exponential(float x) {
  const bool negative = (detail::bits(x) >> 31) != 0u;
  const bool far = (detail::bits(x) & 0x7fffffffu) > VKMESH_EXP_RANGE;
  const float v = zero_below(far ? 0.0f : x, VKMESH_TINY_DIRECTION);
  // x = k ln 2 + r.
  const float shifted = v * VKMESH_LOG2_E + VKMESH_ROUNDING;
  const float k = shifted - VKMESH_ROUNDING;
  const float r = zero_below((v - k * VKMESH_LN2_HIGH) - k * VKMESH_LN2_LOW, VKMESH_TINY_DIRECTION);
  float p = VKMESH_EXP_4;
  p = p * r + VKMESH_EXP_3;
  p = p * r + VKMESH_EXP_2;
  p = p * r + VKMESH_EXP_1;
  p = p * r + VKMESH_EXP_0;
  const float y = 1.0f + (r + (r * r) * p);
  const std::uint32_t power = detail::bits(shifted) - VKMESH_ROUNDING_BITS;
  const bool in_range = !far && (detail::bits(y) >> 23) + power - 1u < 254u;
  return in_range ? detail::from_bits(detail::bits(y) + (power << 23)) : (negative ? 0.0f : VKMESH_LARGEST);
}

}  // namespace exact

/// |v|² for components in {0} ∪ [2^-61, 2^50].
[[nodiscard]] VKMESH_EXACT_INLINE float squared_length(Vec3 v) {
  return (v.x * v.x + v.y * v.y) + v.z * v.z;
}

/// (p1 − p0) × (p2 − p0): twice the area of the triangle, along its normal.
[[nodiscard]] VKMESH_EXACT_INLINE Vec3 area_vector(Vec3 p0, Vec3 p1, Vec3 p2) {
  const Vec3 a = zero_below(p1 - p0, VKMESH_TINY_LENGTH);
  const Vec3 b = zero_below(p2 - p0, VKMESH_TINY_LENGTH);
  return zero_below(Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x),
                    VKMESH_TINY_AREA);
}

/// v / |v| for components in {0} ∪ [2^-126, 2^127], each within 4 ULP of 1; the zero vector where v is zero
/// or not finite.
[[nodiscard]] VKMESH_EXACT_INLINE Vec3 unit_vector(Vec3 v) {
  const auto magnitude = [](float x) { return std::bit_cast<std::uint32_t>(x) & 0x7fffffffu; };
  const std::uint32_t largest = std::max(std::max(magnitude(v.x), magnitude(v.y)), magnitude(v.z));
  const bool defined = largest - 1u < 0x7f7fffffu;
  // A power of two brings the largest component into [1, 4): squares then neither overflow nor vanish.
  const float scale = std::bit_cast<float>(std::max(0x7f000000u - (largest & 0x7f800000u), 0x00800000u));
  const Vec3 w = zero_below(v * scale, VKMESH_TINY_DIRECTION);
  const float r = exact::reciprocal_root(squared_length(w));
  // No branch, so that a loop of these fills vector registers.
  return {defined ? w.x * r : 0.0f, defined ? w.y * r : 0.0f, defined ? w.z * r : 0.0f};
}

/// The angle between two unit vectors, in [0, π], within 8 ULP; 0 where either is the zero vector.
/// W. Kahan's 2 atan2(|a − b|, |a + b|): accurate for small and for nearly straight angles.
[[nodiscard]] VKMESH_EXACT_INLINE float angle_between(Vec3 a, Vec3 b) {
  const float length_a = squared_length(a), length_b = squared_length(b);
  // No branch, so that a loop of these fills vector registers.
  const bool defined = (length_a != 0.0f) & (length_b != 0.0f);
  const float apart = exact::root(squared_length(zero_below(a - b, VKMESH_TINY_LENGTH)));
  const float along = exact::root(squared_length(zero_below(a + b, VKMESH_TINY_LENGTH)));
  return defined ? 2.0f * exact::first_quadrant_angle(apart, along) : 0.0f;
}

/// angle_between(left, right), the normals of the faces to the left and the right of an edge that runs along
/// `along`: negative where they meet in a valley, as seen from the side that the normals point to.
/// Components of `along` lie in {0} ∪ [2^-149, 2^61].
[[nodiscard]] VKMESH_EXACT_INLINE float dihedral_angle(Vec3 left, Vec3 right, Vec3 along) {
  const Vec3 c = zero_below(Vec3(left.y * right.z - left.z * right.y, left.z * right.x - left.x * right.z,
                                 left.x * right.y - left.y * right.x),
                            VKMESH_TINY_DIRECTION);
  const Vec3 e = zero_below(along, VKMESH_TINY_LENGTH);
  const float angle = angle_between(left, right);
  return (c.x * e.x + c.y * e.y) + c.z * e.z < 0.0f ? -angle : angle;
}

/// |v| within 4 ULP, for components in {0} ∪ [2^-126, 2^126].
[[nodiscard]] VKMESH_EXACT_INLINE float vector_length(Vec3 v) {
  const std::uint32_t largest =
      std::max(std::max(detail::bits(v.x) & 0x7fffffffu, detail::bits(v.y) & 0x7fffffffu),
               detail::bits(v.z) & 0x7fffffffu);
  const float scale = detail::from_bits(std::max(0x7f000000u - (largest & 0x7f800000u), 0x00800000u));
  const Vec3 w = zero_below(v * scale, VKMESH_TINY_DIRECTION);
  return exact::root(squared_length(w)) * detail::from_bits(largest & 0x7f800000u);
}

/// (p1 − p0) · (p2 − p0), as area_vector() is the other product.
[[nodiscard]] VKMESH_EXACT_INLINE float corner_product(Vec3 p0, Vec3 p1, Vec3 p2) {
  const Vec3 a = zero_below(p1 - p0, VKMESH_TINY_LENGTH);
  const Vec3 b = zero_below(p2 - p0, VKMESH_TINY_LENGTH);
  return zero_below((a.x * b.x + a.y * b.y) + a.z * b.z, VKMESH_TINY_AREA);
}

/// x / y for y in {0} ∪ [2^-104, 2^125], held within ±bound, a power of two of which the inverse is given; 0
/// where y is 0, and where the quotient is below 2^-100.
[[nodiscard]] VKMESH_EXACT_INLINE float bounded_quotient(float x, float y, float bound, float inverse_bound) {
  // Compared before the division, which could overflow.
  const float scaled = x * inverse_bound;
  const bool high = scaled >= y, low = -scaled >= y;
  const float ratio = zero_below((high || low ? 0.0f : x) * exact::reciprocal(y), VKMESH_TINY_COORDINATE);
  return y == 0.0f ? 0.0f : (high ? bound : (low ? -bound : ratio));
}

/// The cotangent of a corner's angle, from its corner_product() and the length of its area_vector(), held
/// within ±2^10; 0 for a triangle without area, and below 2^-40.
[[nodiscard]] VKMESH_EXACT_INLINE float cotangent(float product, float twice_area) {
  return zero_below(
      bounded_quotient(product, twice_area, VKMESH_COTANGENT_BOUND, VKMESH_COTANGENT_BOUND_INVERSE),
      VKMESH_TINY_DIRECTION);
}

/// The angle in [0, π] of the vector (product, twice_area), which is that of a corner of a triangle; 0 for
/// (0, 0), and exactly 0 or π for a triangle without area. Within 4 ULP of its arguments' angle.
[[nodiscard]] VKMESH_EXACT_INLINE float corner_angle(float product, float twice_area) {
  const std::uint32_t largest =
      std::max(detail::bits(product) & 0x7fffffffu, detail::bits(twice_area) & 0x7fffffffu);
  const float scale = detail::from_bits(0x7f000000u - (largest & 0x7f800000u));
  const float x = zero_below(product * scale, VKMESH_TINY_LENGTH);
  const float y = zero_below(twice_area * scale, VKMESH_TINY_LENGTH);
  const float angle = exact::first_quadrant_angle(y, std::fabs(x));
  return x < 0.0f ? (2.0f * VKMESH_HALF_PI_HIGH - angle) + 2.0f * VKMESH_HALF_PI_LOW : angle;
}

/// What every pass asks of positions. O(n).
/// Errors: kUnsuitable for a coordinate that is not below kMaxCoordinate in magnitude (or not finite), by
/// vertex.
[[nodiscard]] VKMESH_API Result<void> check_positions(std::span<const Vec3> positions);

/// check_positions(), and a copy in which coordinates below 2^-100 in magnitude are +0, as smoothing works
/// on. (Normals and angles need no such copy: beside the thresholds for lengths, coordinates as small as
/// these change nothing.) Errors: kUsage when the sizes differ; as check_positions().
[[nodiscard]] VKMESH_API Result<void> prepare_positions(std::span<const Vec3> positions,
                                                        std::span<Vec3> prepared);

}  // namespace vkmesh

#undef VKMESH_EXACT_INLINE
