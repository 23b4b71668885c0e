#version 460
#extension GL_GOOGLE_include_directive : require
// The bounds of a block of points, or of a block of bounds.
#include "lib/kernel.glsl"
#include "passes/surface_measures_params.h"

VKMESH_PUSH_CONSTANTS(BoundsBlocksParams);

void main() {
  VKMESH_THREAD_INDEX(b);
  const uint begin = VKMESH_SUM_BLOCK * b;
  vec3 low = vec3(0.0), high = vec3(0.0);
  for (uint k = 0; k < VKMESH_SUM_BLOCK; ++k) {
    const uint i = min(begin + k, p.elements - 1u);
    const vec3 l = load3(p.source, p.vectors * i), h = load3(p.source, p.vectors * i + (p.vectors - 1u));
    const bool first = k == 0u;
    low = vec3(first || l.x < low.x ? l.x : low.x, first || l.y < low.y ? l.y : low.y, first || l.z < low.z ? l.z : low.z);
    high = vec3(first || h.x > high.x ? h.x : high.x, first || h.y > high.y ? h.y : high.y, first || h.z > high.z ? h.z : high.z);
  }
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.target, 2 * b, low);
  store3(p.target, 2 * b + 1, high);
}
