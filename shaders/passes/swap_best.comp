#version 460
#extension GL_GOOGLE_include_directive : require
// The best swap of all in whose quadrilateral a vertex is: of a vertex of too many edges none. Twin of
// host/src/passes/swap_rounds.cpp, find_best().
#include "lib/kernel.glsl"
#include "lib/half_edges.glsl"
#include "passes/swap_rounds_params.h"

VKMESH_PUSH_CONSTANTS(SwapBestParams);

void consider(uint side, inout float most, inout uint best) {
  const uint t = p.twins.at[side];
  if (t == 0xffffffffu) return;
  const uint e = min(side, t);
  const float gain = p.gains.at[e];
  if (gain > most || (gain == most && gain > 0.0 && e < best)) {
    most = gain;
    best = e;
  }
}

void main() {
  VKMESH_THREAD_INDEX(v);
  VKMESH_SURPLUS_THREADS_LEAVE;
  const uint leading = p.leading.at[v];
  uint best = 0xffffffffu, h = leading;
  float most = 0.0;
  bool ended = leading == 0xffffffffu;
  for (uint steps = 0; steps < VKMESH_MAX_SWAP_VALENCE && !ended; ++steps) {
    const uint before = previous_half_edge(h);
    consider(h, most, best);
    consider(next_half_edge(h), most, best);
    consider(before, most, best);
    h = p.twins.at[before];
    ended = h == 0xffffffffu || h == leading;
  }
  p.best.at[v] = ended ? best : 0xffffffffu;
}
