// The arithmetic that gives the same bytes on every device: 32-bit + - *, comparisons and integers, in one order.
// Twin of <vkmesh/math/arithmetic.h>, function by function, which documents domains and errors.
#ifndef VKMESH_ARITHMETIC_GLSL
#define VKMESH_ARITHMETIC_GLSL

#include "vkmesh/math/arithmetic_constants.h"

float zero_below(float x, float limit) { return abs(x) < limit ? 0.0 : x; }

vec3 zero_below(vec3 v, float limit) {
  return vec3(zero_below(v.x, limit), zero_below(v.y, limit), zero_below(v.z, limit));
}

float residual(float x, float a, float b) {
  float ah = uintBitsToFloat(floatBitsToUint(a) & 0xfffff000u);
  float bh = uintBitsToFloat(floatBitsToUint(b) & 0xfffff000u);
  precise float al = a - ah;
  precise float bl = b - bh;
  precise float r = (((x - ah * bh) - ah * bl) - al * bh) - al * bl;
  return r;
}

float rough_reciprocal_root(float m) {
  precise float y = uintBitsToFloat(VKMESH_RECIPROCAL_ROOT_SEED - (floatBitsToUint(m) >> 1));
  precise float half_m = 0.5 * m;
  for (int i = 0; i < 3; ++i) y = y * (1.5 - (half_m * y) * y);
  return y;
}

float even_mantissa(uint x) {
  return uintBitsToFloat((x & 0x007fffffu) | ((x & 0x00800000u) != 0u ? 0x3f800000u : 0x40000000u));
}

float reciprocal(float x) {
  uint magnitude = floatBitsToUint(x) & 0x7fffffffu;
  uint exponent = magnitude >> 23;
  float m = uintBitsToFloat((magnitude & 0x007fffffu) | 0x3f800000u);
  precise float y = uintBitsToFloat(VKMESH_RECIPROCAL_SEED - floatBitsToUint(m));
  for (int i = 0; i < 3; ++i) y = y * (2.0 - m * y);
  y = y + y * residual(1.0, m, y);
  uint result = floatBitsToUint(y) + (127u << 23) - (exponent << 23);
  bool defined = exponent - 1u < 253u && (result & 0x7f800000u) != 0u;
  return defined ? uintBitsToFloat(result | (floatBitsToUint(x) & 0x80000000u)) : 0.0;
}

float reciprocal_root(float x) {
  uint b = floatBitsToUint(x);
  uint exponent = b >> 23;
  float m = even_mantissa(b);
  float y = rough_reciprocal_root(m);
  precise float square = y * y;
  precise float r = residual(1.0, m, square) + m * residual(square, y, y);
  precise float refined = y + y * (0.5 * r);
  return exponent - 1u < 254u
             ? uintBitsToFloat(floatBitsToUint(refined) + (127u << 23) - (((exponent + 127u) >> 1) << 23))
             : 0.0;
}

float root(float x) {
  uint b = floatBitsToUint(x);
  uint exponent = b >> 23;
  float m = even_mantissa(b);
  float y = rough_reciprocal_root(m);
  precise float s = m * y;
  precise float refined = s + (0.5 * y) * residual(m, s, s);
  return exponent - 1u < 254u
             ? uintBitsToFloat(floatBitsToUint(refined) - (127u << 23) + (((exponent + 127u) >> 1) << 23))
             : 0.0;
}

float cube_root(float x) {
  uint b = floatBitsToUint(x);
  uint exponent = b >> 23;
  float m = uintBitsToFloat((b & 0x007fffffu) | ((127u + (exponent + 2u) % 3u) << 23));
  precise float y = uintBitsToFloat(VKMESH_RECIPROCAL_CUBE_ROOT_SEED - floatBitsToUint(m) / 3u);
  precise float third = VKMESH_THIRD * m;
  for (int i = 0; i < 4; ++i) y = y * (VKMESH_FOUR_THIRDS - third * ((y * y) * y));
  precise float square = y * y;
  precise float z = m * square;
  precise float s = z * z;
  precise float r = residual(m, s, z) + residual(s, z, z) * z;
  precise float refined = z + (VKMESH_THIRD * square) * r;
  return exponent - 1u < 254u
             ? uintBitsToFloat(floatBitsToUint(refined) + (((exponent + 2u) / 3u) << 23) - (43u << 23))
             : 0.0;
}

float first_quadrant_angle(float y, float x) {
  bool steep = y > x;
  precise float t = (steep ? x : y) * reciprocal(steep ? y : x);
  precise float square = t * t;
  float u = zero_below(square, VKMESH_TINY_COORDINATE);
  precise float p = VKMESH_ATAN_9;
  p = p * u + VKMESH_ATAN_8;
  p = p * u + VKMESH_ATAN_7;
  p = p * u + VKMESH_ATAN_6;
  p = p * u + VKMESH_ATAN_5;
  p = p * u + VKMESH_ATAN_4;
  p = p * u + VKMESH_ATAN_3;
  p = p * u + VKMESH_ATAN_2;
  p = p * u + VKMESH_ATAN_1;
  p = p * u + VKMESH_ATAN_0;
  precise float angle = t * p;
  precise float complement = (VKMESH_HALF_PI_HIGH - angle) + VKMESH_HALF_PI_LOW;
  return steep ? complement : angle;
}

float arccosine(float x) {
  uint magnitude = min(floatBitsToUint(x) & 0x7fffffffu, 0x3f800000u);
  bool negative = (floatBitsToUint(x) >> 31) != 0u;
  float size = zero_below(uintBitsToFloat(magnitude), VKMESH_TINY_LENGTH);
  bool steep = size > 0.5;
  precise float half_rest = 0.5 * (1.0 - size);
  precise float square = size * size;
  float z = zero_below(steep ? half_rest : square, VKMESH_TINY_DIRECTION);
  float s = steep ? root(z) : (negative ? -size : size);
  precise float p = VKMESH_ASIN_5;
  p = p * z + VKMESH_ASIN_4;
  p = p * z + VKMESH_ASIN_3;
  p = p * z + VKMESH_ASIN_2;
  p = p * z + VKMESH_ASIN_1;
  p = p * z + VKMESH_ASIN_0;
  precise float more = s * (z * p);
  precise float complement = VKMESH_HALF_PI_HIGH - (s - (VKMESH_HALF_PI_LOW - more));
  precise float direct = s + more;
  precise float twice = 2.0 * (negative ? complement : direct);
  return steep ? twice : complement;
}

float exponential(float x) {
  bool negative = (floatBitsToUint(x) >> 31) != 0u;
  bool far = (floatBitsToUint(x) & 0x7fffffffu) > VKMESH_EXP_RANGE;
  float v = zero_below(far ? 0.0 : x, VKMESH_TINY_DIRECTION);
  precise float shifted = v * VKMESH_LOG2_E + VKMESH_ROUNDING;
  precise float k = shifted - VKMESH_ROUNDING;
  precise float rest = (v - k * VKMESH_LN2_HIGH) - k * VKMESH_LN2_LOW;
  float r = zero_below(rest, VKMESH_TINY_DIRECTION);
  precise float p = VKMESH_EXP_4;
  p = p * r + VKMESH_EXP_3;
  p = p * r + VKMESH_EXP_2;
  p = p * r + VKMESH_EXP_1;
  p = p * r + VKMESH_EXP_0;
  precise float y = 1.0 + (r + (r * r) * p);
  uint power = floatBitsToUint(shifted) - VKMESH_ROUNDING_BITS;
  bool in_range = !far && (floatBitsToUint(y) >> 23) + power - 1u < 254u;
  return in_range ? uintBitsToFloat(floatBitsToUint(y) + (power << 23)) : (negative ? 0.0 : VKMESH_LARGEST);
}

float squared_length(vec3 v) {
  precise float s = (v.x * v.x + v.y * v.y) + v.z * v.z;
  return s;
}

vec3 area_vector(vec3 p0, vec3 p1, vec3 p2) {
  precise vec3 a = p1 - p0;
  precise vec3 b = p2 - p0;
  a = zero_below(a, VKMESH_TINY_LENGTH);
  b = zero_below(b, VKMESH_TINY_LENGTH);
  precise vec3 n = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  return zero_below(n, VKMESH_TINY_AREA);
}

vec3 unit_vector(vec3 v) {
  uvec3 m = floatBitsToUint(v) & 0x7fffffffu;
  uint largest = max(max(m.x, m.y), m.z);
  if (largest == 0u || largest >= 0x7f800000u) return vec3(0.0);
  float scale = uintBitsToFloat(max(0x7f000000u - (largest & 0x7f800000u), 0x00800000u));
  precise vec3 w = v * scale;
  w = zero_below(w, VKMESH_TINY_DIRECTION);
  precise vec3 result = w * reciprocal_root(squared_length(w));
  return result;
}

float angle_between(vec3 a, vec3 b) {
  if (squared_length(a) == 0.0 || squared_length(b) == 0.0) return 0.0;
  precise vec3 difference = a - b;
  precise vec3 sum = a + b;
  const float apart = root(squared_length(zero_below(difference, VKMESH_TINY_LENGTH)));
  const float along = root(squared_length(zero_below(sum, VKMESH_TINY_LENGTH)));
  precise float angle = 2.0 * first_quadrant_angle(apart, along);
  return angle;
}

float dihedral_angle(vec3 left, vec3 right, vec3 along) {
  precise vec3 c = vec3(left.y * right.z - left.z * right.y, left.z * right.x - left.x * right.z,
                        left.x * right.y - left.y * right.x);
  c = zero_below(c, VKMESH_TINY_DIRECTION);
  vec3 e = zero_below(along, VKMESH_TINY_LENGTH);
  float angle = angle_between(left, right);
  precise float side = (c.x * e.x + c.y * e.y) + c.z * e.z;
  return side < 0.0 ? -angle : angle;
}

float vector_length(vec3 v) {
  uvec3 m = floatBitsToUint(v) & 0x7fffffffu;
  uint largest = max(max(m.x, m.y), m.z);
  float scale = uintBitsToFloat(max(0x7f000000u - (largest & 0x7f800000u), 0x00800000u));
  precise vec3 w = v * scale;
  precise float size = root(squared_length(zero_below(w, VKMESH_TINY_DIRECTION))) * uintBitsToFloat(largest & 0x7f800000u);
  return size;
}

float corner_product(vec3 p0, vec3 p1, vec3 p2) {
  precise vec3 a = p1 - p0;
  precise vec3 b = p2 - p0;
  a = zero_below(a, VKMESH_TINY_LENGTH);
  b = zero_below(b, VKMESH_TINY_LENGTH);
  precise float s = (a.x * b.x + a.y * b.y) + a.z * b.z;
  return zero_below(s, VKMESH_TINY_AREA);
}

float bounded_quotient(float x, float y, float bound, float inverse_bound) {
  precise float scaled = x * inverse_bound;
  bool high = scaled >= y, low = -scaled >= y;
  precise float ratio = (high || low ? 0.0 : x) * reciprocal(y);
  ratio = zero_below(ratio, VKMESH_TINY_COORDINATE);
  return y == 0.0 ? 0.0 : (high ? bound : (low ? -bound : ratio));
}

float cotangent(float product, float twice_area) {
  return zero_below(bounded_quotient(product, twice_area, VKMESH_COTANGENT_BOUND, VKMESH_COTANGENT_BOUND_INVERSE),
                    VKMESH_TINY_DIRECTION);
}

float corner_angle(float product, float twice_area) {
  uint largest = max(floatBitsToUint(product) & 0x7fffffffu, floatBitsToUint(twice_area) & 0x7fffffffu);
  float scale = uintBitsToFloat(0x7f000000u - (largest & 0x7f800000u));
  precise float scaled_product = product * scale;
  precise float scaled_area = twice_area * scale;
  float x = zero_below(scaled_product, VKMESH_TINY_LENGTH);
  float y = zero_below(scaled_area, VKMESH_TINY_LENGTH);
  float angle = first_quadrant_angle(y, abs(x));
  precise float supplement = (2.0 * VKMESH_HALF_PI_HIGH - angle) + 2.0 * VKMESH_HALF_PI_LOW;
  return x < 0.0 ? supplement : angle;
}

#endif
