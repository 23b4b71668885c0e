#version 460
#extension GL_GOOGLE_include_directive : require
// The largest magnitude of the angles of the edges around each vertex.
#include "lib/kernel.glsl"
#include "passes/dihedral_angles_params.h"

VKMESH_PUSH_CONSTANTS(VertexMaximaParams);

// The larger angle of a half-edge and of the one before it, which together meet every edge of a vertex.
float larger_around(uint h) {
  const float a = abs(p.angles.at[h]);
  const float b = abs(p.angles.at[h % 3 == 0 ? h + 2 : h - 1]);
  return a > b ? a : b;
}

void main() {
  VKMESH_THREAD_INDEX(v);
  float largest = 0.0;
  const uint begin = p.corner_offsets.at[v];
  const uint end = p.corner_offsets.at[v + 1];
  for (uint k = 0; k < VKMESH_UNMASKED; ++k) {
    const float angle = larger_around(p.corner_half_edges.at[VKMESH_CLAMPED(begin + k, end)]);
    if (begin + k < end && angle > largest) largest = angle;
  }
  for (uint c = begin + VKMESH_UNMASKED; c < end; ++c) {
    const float angle = larger_around(p.corner_half_edges.at[c]);
    if (angle > largest) largest = angle;
  }
  VKMESH_SURPLUS_THREADS_LEAVE;
  p.maxima.at[v] = largest;
}
