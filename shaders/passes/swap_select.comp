#version 460
#extension GL_GOOGLE_include_directive : require
// Edges that are the best at each of their four vertices. Twin of host/src/passes/swap_rounds.cpp, select().
#include "lib/kernel.glsl"
#include "lib/half_edges.glsl"
#include "passes/swap_rounds_params.h"

VKMESH_PUSH_CONSTANTS(SwapSelectParams);

bool is_best_at(uint corner, uint h) { return p.best.at[p.corners.at[corner]] == h; }

void main() {
  VKMESH_THREAD_INDEX(h);
  VKMESH_SURPLUS_THREADS_LEAVE;
  const uint t = p.twins.at[h];
  bool swaps = t != 0xffffffffu && h < t;
  if (swaps) swaps = p.gains.at[h] > 0.0;
  if (swaps)
    swaps = is_best_at(h, h) && is_best_at(t, h) && is_best_at(previous_half_edge(h), h) && is_best_at(previous_half_edge(t), h);
  p.selected.at[h] = swaps ? p.round : 0u;
}
