#version 460
#extension GL_GOOGLE_include_directive : require
// One Jacobi step of uniform Laplacian smoothing.
#include "kernel.glsl"

VKMESH_PUSH_CONSTANTS(LaplacianSmoothingParams);

void main() {
  VKMESH_THREAD_INDEX(v);
  const vec3 here = load3(p.source, v);
  const uint begin = p.neighbour_offsets.at[v];
  const uint end = p.neighbour_offsets.at[v + 1];
  const bool fixed_here = p.use_fixed == 1 && ((p.fixed_bits.at[v / 32] >> (v % 32)) & 1u) != 0u;
  precise vec3 sum = vec3(0.0);
  for (uint k = 0; k < VKMESH_UNMASKED; ++k) {
    const uint n = begin + k;
    precise vec3 more = sum + load3(p.source, p.neighbour_ids.at[VKMESH_CLAMPED(n, end)]);
    sum = n < end ? more : sum;
  }
  for (uint n = begin + VKMESH_UNMASKED; n < end; ++n) sum = sum + load3(p.source, p.neighbour_ids.at[n]);
  precise vec3 mean = sum * reciprocal(float(end - begin));
  mean = zero_below(mean, VKMESH_TINY_COORDINATE);
  precise vec3 move = p.lambda * (mean - here);
  move = zero_below(move, VKMESH_TINY_COORDINATE);
  precise vec3 there = here + move;
  there = zero_below(there, VKMESH_TINY_COORDINATE);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.target, v, begin == end || fixed_here ? here : there);
}
