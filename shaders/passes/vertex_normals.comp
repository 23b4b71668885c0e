#version 460
#extension GL_GOOGLE_include_directive : require
// Gathers the area vectors of the faces around each vertex, in ascending order of faces.
#include "lib/kernel.glsl"
#include "passes/vertex_normals_params.h"

VKMESH_PUSH_CONSTANTS(VertexNormalsParams);

void main() {
  VKMESH_THREAD_INDEX(v);
  precise vec3 sum = vec3(0.0);
  const uint begin = p.corner_offsets.at[v];
  const uint end = p.corner_offsets.at[v + 1];
  const uint half_edges[VKMESH_UNMASKED] = load_list(p.corner_half_edges, begin, end);
  for (uint k = 0; k < VKMESH_UNMASKED; ++k) {
    precise vec3 more = sum + load3(p.areas, half_edges[k] / 3);
    sum = begin + k < end ? more : sum;
  }
  for (uint c = begin + VKMESH_UNMASKED; c < end; ++c) sum = sum + load3(p.areas, p.corner_half_edges.at[c] / 3);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.normals, v, unit_vector(sum));
}
