#version 460
#extension GL_GOOGLE_include_directive : require
// Every function of the arithmetic on given values, for the check against the host (engine/src/core/canary.cpp).
#include "lib/kernel.glsl"
#include "core/canary_params.h"

VKMESH_PUSH_CONSTANTS(CanaryParams);

void store_result(uint i, uint which, float value) { p.results.at[VKMESH_CANARY_RESULTS * i + which] = value; }

void store_results(uint i, uint which, vec3 v) {
  store_result(i, which, v.x);
  store_result(i, which + 1, v.y);
  store_result(i, which + 2, v.z);
}

void main() {
  VKMESH_THREAD_INDEX(i);
  const uint at = VKMESH_CANARY_INPUTS / 3 * i;
  const vec3 a = load3(p.inputs, at);
  const vec3 b = load3(p.inputs, at + 1);
  const vec3 c = load3(p.inputs, at + 2);
  const float x = abs(a.x), y = abs(a.y);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store_result(i, 0, zero_below(a.x, y));
  store_result(i, 1, reciprocal(x));
  store_result(i, 2, reciprocal_root(x));
  store_result(i, 3, root(y));
  store_result(i, 4, first_quadrant_angle(y, x));
  store_result(i, 5, squared_length(b));
  store_results(i, 6, area_vector(a, b, c));
  store_results(i, 9, unit_vector(a));
  store_result(i, 12, angle_between(unit_vector(a), unit_vector(b)));
  precise float blend = c.x + c.y * (b.x - c.x);
  store_result(i, 13, blend);
  store_result(i, 14, reciprocal(float(i + 1)));
  store_result(i, 15, float(i * VKMESH_CANARY_UINT_STEP));
  store_result(i, 16, arccosine(unit_vector(a).x));
  store_result(i, 17, exponential(a.y));
  store_result(i, 18, vector_length(b));
  const float twice_area = vector_length(area_vector(a, b, c));
  store_result(i, 19, cotangent(corner_product(a, b, c), twice_area));
  store_result(i, 21, cube_root(y));
  store_result(i, 22, dihedral_angle(unit_vector(a), unit_vector(b), c));
  store_result(i, 20, corner_angle(corner_product(a, b, c), twice_area));
}
