// The arithmetic that gives the same bytes on every device: 32-bit + - *, comparisons and integers, in one order.
// Twin of <vkmesh/passes/arithmetic.h>, function by function, which documents domains and errors.
#ifndef VKMESH_ARITHMETIC_GLSL
#define VKMESH_ARITHMETIC_GLSL

#include "vkmesh/passes/arithmetic_constants.h"

float zero_below(float x, float limit) { return abs(x) < limit ? 0.0 : x; }

vec3 zero_below(vec3 v, float limit) {
  return vec3(zero_below(v.x, limit), zero_below(v.y, limit), zero_below(v.z, limit));
}

float reciprocal(float x) {
  precise float y = uintBitsToFloat(VKMESH_RECIPROCAL_SEED - floatBitsToUint(x));
  for (int i = 0; i < 3; ++i) y = y * (2.0 - x * y);
  precise float refined = y + y * (1.0 - x * y);
  return refined;
}

float reciprocal_root(float x) {
  precise float y = uintBitsToFloat(VKMESH_RECIPROCAL_ROOT_SEED - (floatBitsToUint(x) >> 1));
  precise float half_x = 0.5 * x;
  for (int i = 0; i < 3; ++i) y = y * (1.5 - (half_x * y) * y);
  precise float refined = y + y * (0.5 - (half_x * y) * y);
  return refined;
}

float root(float x) {
  precise float r = x * reciprocal_root(x);
  return x == 0.0 ? 0.0 : r;
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

#endif
