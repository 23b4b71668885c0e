#version 460
#extension GL_GOOGLE_include_directive : require
// One Jacobi step of Laplacian smoothing with cotangent weights.
#include "lib/smoothing.glsl"

// The cotangents at q and r of the triangle here, q, r.
vec2 cotangents(vec3 here, vec3 q, vec3 r) {
  const float twice_area = vector_length(area_vector(here, q, r));
  return vec2(cotangent(corner_product(q, r, here), twice_area), cotangent(corner_product(r, here, q), twice_area));
}

struct Mean {
  vec3 sum;
  float total;
};

Mean add(Mean mean, vec3 q, float weight) {
  precise vec3 weighted = weight * q;
  precise vec3 sum = mean.sum + zero_below(weighted, VKMESH_TINY_COORDINATE);
  precise float total = mean.total + weight;
  return Mean(sum, total);
}

void main() {
  VKMESH_THREAD_INDEX(v);
  const vec3 here = load3(p.source, v);
  const uint begin = p.neighbour_offsets.at[v];
  const uint end = p.neighbour_offsets.at[v + 1];
  const bool boundary = bit_of(p.boundary_bits, v);
  const bool ends_only = boundary && p.boundary_rule == VKMESH_BOUNDARY_ALONG_ITSELF;
  const vec3 last = load3(p.source, p.neighbour_ids.at[VKMESH_CLAMPED(end - 1u, end)]);
  const vec3 first = load3(p.source, p.neighbour_ids.at[VKMESH_CLAMPED(begin, end)]);
  // The angle opposite each edge in the triangle before it, and in the one after it; on the boundary there is no
  // triangle between the last neighbour and the first.
  const float closing = cotangents(here, last, first).x;
  float before = boundary ? 0.0 : closing;
  vec3 q = first;
  Mean mean = Mean(vec3(0.0), 0.0);
  for (uint n = begin; n < end || n < begin + VKMESH_UNMASKED; ++n) {
    const bool is_last = n + 1 >= end;
    const vec3 r = load3(p.source, p.neighbour_ids.at[VKMESH_CLAMPED(is_last ? begin : n + 1, end)]);
    const vec2 both = cotangents(here, q, r);
    const vec2 after = is_last && boundary ? vec2(0.0) : both;
    precise float sum = before + after.y;
    const float weight = sum > VKMESH_TINY_WEIGHT ? sum : 0.0;
    const Mean more = add(mean, q, ends_only ? 1.0 : weight);
    if (n < end && (!ends_only || n == begin || is_last)) mean = more;
    before = after.x;
    q = r;
  }
  const vec3 there = step_towards(here, mean.sum, reciprocal(mean.total));
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.target, v, mean.total == 0.0 || stays(v, boundary) ? here : there);
}
