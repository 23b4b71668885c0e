#version 460
#extension GL_GOOGLE_include_directive : require
// One Jacobi step of Laplacian smoothing with uniform weights.
#include "lib/smoothing.glsl"

void main() {
  VKMESH_THREAD_INDEX(v);
  const vec3 here = load3(p.source, v);
  const uint begin = p.neighbour_offsets.at[v];
  const uint end = p.neighbour_offsets.at[v + 1];
  const bool boundary = bit_of(p.boundary_bits, v);
  // Along the boundary only the first neighbour and the last count.
  const bool ends_only = boundary && p.boundary_rule == VKMESH_BOUNDARY_ALONG_ITSELF;
  precise vec3 sum = vec3(0.0);
  const uint neighbours[VKMESH_UNMASKED] = load_list(p.neighbour_ids, begin, end);
  for (uint k = 0; k < VKMESH_UNMASKED; ++k) {
    const uint n = begin + k;
    precise vec3 more = sum + load3(p.source, neighbours[k]);
    sum = n < end && (!ends_only || k == 0u || n + 1 == end) ? more : sum;
  }
  for (uint n = begin + VKMESH_UNMASKED; n < end; ++n) {
    precise vec3 more = sum + load3(p.source, p.neighbour_ids.at[n]);
    sum = !ends_only || n + 1 == end ? more : sum;
  }
  const vec3 there = step_towards(here, sum, reciprocal(ends_only ? 2.0 : float(end - begin)));
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.target, v, begin == end || stays(v, boundary) ? here : there);
}
