#version 460
#extension GL_GOOGLE_include_directive : require
// Gathers the normals of the faces around each vertex, by their angles there, in ascending order of faces.
#include "lib/kernel.glsl"
#include "passes/vertex_normals_params.h"

VKMESH_PUSH_CONSTANTS(VertexNormalsByAngleParams);

vec3 weighted(uint h, vec3 here) {
  const vec3 p1 = load3(p.positions, p.corners.at[h % 3 == 2 ? h - 2 : h + 1]);
  const vec3 p2 = load3(p.positions, p.corners.at[h % 3 == 0 ? h + 2 : h - 1]);
  const float angle = corner_angle(corner_product(here, p1, p2), vector_length(area_vector(here, p1, p2)));
  precise vec3 result = zero_below(angle, VKMESH_TINY_DIRECTION) * load3(p.face_normals, h / 3);
  return result;
}

void main() {
  VKMESH_THREAD_INDEX(v);
  const vec3 here = load3(p.positions, v);
  precise vec3 sum = vec3(0.0);
  const uint begin = p.corner_offsets.at[v];
  const uint end = p.corner_offsets.at[v + 1];
  for (uint k = 0; k < VKMESH_UNMASKED; ++k) {
    const uint c = begin + k;
    precise vec3 more = sum + weighted(p.corner_half_edges.at[VKMESH_CLAMPED(c, end)], here);
    sum = c < end ? more : sum;
  }
  for (uint c = begin + VKMESH_UNMASKED; c < end; ++c) sum = sum + weighted(p.corner_half_edges.at[c], here);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.normals, v, unit_vector(sum));
}
