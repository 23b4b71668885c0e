// What the smoothing kernels share.
#ifndef VKMESH_SMOOTHING_GLSL
#define VKMESH_SMOOTHING_GLSL

#include "lib/kernel.glsl"
#include "passes/laplacian_smoothing_params.h"

VKMESH_PUSH_CONSTANTS(LaplacianSmoothingParams);

bool bit_of(Uints words, uint i) { return ((words.at[i / 32] >> (i % 32)) & 1u) != 0u; }

bool stays(uint v, bool boundary) {
  return bit_of(p.locked_bits, v) || (boundary && p.boundary_rule == VKMESH_BOUNDARY_FIXED);
}

vec3 step_towards(vec3 here, vec3 sum, float reciprocal_weight) {
  precise vec3 mean = sum * reciprocal_weight;
  mean = zero_below(mean, VKMESH_TINY_COORDINATE);
  precise vec3 move = p.factor * (mean - here);
  move = zero_below(move, VKMESH_TINY_COORDINATE);
  precise vec3 there = here + move;
  return zero_below(there, VKMESH_TINY_COORDINATE);
}

#endif
