#version 460
#extension GL_GOOGLE_include_directive : require
// The largest angle of the edges around each vertex: those of its half-edges and of those before them.
#include "kernel.glsl"

VKMESH_PUSH_CONSTANTS(VertexMaximaParams);

void main() {
  VKMESH_THREAD_INDEX(v);
  float largest = 0.0;
  const uint end = p.corner_offsets.at[v + 1];
  for (uint c = p.corner_offsets.at[v]; c < end; ++c) {
    const uint h = p.corner_half_edges.at[c];
    const uint before = h % 3 == 0 ? h + 2 : h - 1;
    const float a = p.angles.at[h];
    const float b = p.angles.at[before];
    if (a > largest) largest = a;
    if (b > largest) largest = b;
  }
  p.maxima.at[v] = largest;
}
