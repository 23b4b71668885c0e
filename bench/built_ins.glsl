// The functions of shaders/lib/arithmetic.glsl as one would write them who need not care for the same bytes on every device:
// with built-ins, free to be fused and reordered, nothing small set to zero. For the benchmark, which tells what
// exactness costs. The build defines `precise` away beside this file.
#ifndef VKMESH_BUILT_INS_GLSL
#define VKMESH_BUILT_INS_GLSL

#include "vkmesh/math/arithmetic_constants.h"

float zero_below(float x, float limit) { return x; }
vec3 zero_below(vec3 v, float limit) { return v; }
float reciprocal(float x) { return 1.0 / x; }
float reciprocal_root(float x) { return inversesqrt(x); }
float root(float x) { return sqrt(x); }
float cube_root(float x) { return pow(x, 1.0 / 3.0); }
float first_quadrant_angle(float y, float x) { return atan(y, x); }
float arccosine(float x) { return acos(clamp(x, -1.0, 1.0)); }
float exponential(float x) { return exp(x); }
float squared_length(vec3 v) { return dot(v, v); }
vec3 area_vector(vec3 p0, vec3 p1, vec3 p2) { return cross(p1 - p0, p2 - p0); }

vec3 unit_vector(vec3 v) {
  float size = dot(v, v);
  return size > 0.0 ? v * inversesqrt(size) : vec3(0.0);
}

float angle_between(vec3 a, vec3 b) {
  return dot(a, a) == 0.0 || dot(b, b) == 0.0 ? 0.0 : 2.0 * atan(length(a - b), length(a + b));
}

float dihedral_angle(vec3 left, vec3 right, vec3 along) {
  float angle = angle_between(left, right);
  return dot(cross(left, right), along) < 0.0 ? -angle : angle;
}

float vector_length(vec3 v) { return length(v); }
float corner_product(vec3 p0, vec3 p1, vec3 p2) { return dot(p1 - p0, p2 - p0); }

float bounded_quotient(float x, float y, float bound, float inverse_bound) {
  return y == 0.0 ? 0.0 : clamp(x / y, -bound, bound);
}

float cotangent(float product, float twice_area) {
  return bounded_quotient(product, twice_area, VKMESH_COTANGENT_BOUND, VKMESH_COTANGENT_BOUND_INVERSE);
}

float corner_angle(float product, float twice_area) { return atan(twice_area, product); }

#endif
