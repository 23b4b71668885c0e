#version 460
#extension GL_GOOGLE_include_directive : require
// Flips the edges selected, of which no two share a vertex of their quadrilaterals: each thread reads and writes what no
// other does. Twin of host/src/passes/swap_rounds.cpp, flip().
#include "lib/kernel.glsl"
#include "lib/half_edges.glsl"
#include "passes/swap_rounds_params.h"

VKMESH_PUSH_CONSTANTS(SwapFlipParams);

void set_side(uint side, uint beyond) {
  p.twins.at[side] = beyond;
  if (beyond != 0xffffffffu) p.twins.at[beyond] = side;
}

void lead(uint side, uint f, uint g) {
  const uint v = p.corners.at[side], leading = p.leading.at[v];
  if (p.twins.at[side] == 0xffffffffu || leading / 3 == f || leading / 3 == g) p.leading.at[v] = side;
}

void main() {
  VKMESH_THREAD_INDEX(h);
  VKMESH_SURPLUS_THREADS_LEAVE;
  if (p.selected.at[h] != p.round) return;
  const uint t = p.twins.at[h], nh = next_half_edge(h), ph = previous_half_edge(h), nt = next_half_edge(t),
             pt = previous_half_edge(t);
  const uint from = p.corners.at[h], to = p.corners.at[t], a = p.corners.at[ph], b = p.corners.at[pt];
  const uint beyond_qa = p.twins.at[nh], beyond_ap = p.twins.at[ph], beyond_pb = p.twins.at[nt], beyond_bq = p.twins.at[pt];
  const uint from_p = p.sources.at[h], from_q = p.sources.at[t], from_a = p.sources.at[ph], from_b = p.sources.at[pt];
  p.sources.at[h] = from_b;
  p.sources.at[nh] = from_a;
  p.sources.at[ph] = from_p;
  p.sources.at[t] = from_a;
  p.sources.at[nt] = from_b;
  p.sources.at[pt] = from_q;
  p.corners.at[h] = b;
  p.corners.at[nh] = a;
  p.corners.at[ph] = from;
  p.corners.at[t] = a;
  p.corners.at[nt] = b;
  p.corners.at[pt] = to;
  set_side(nh, beyond_ap);
  set_side(ph, beyond_pb);
  set_side(nt, beyond_bq);
  set_side(pt, beyond_qa);
  if (p.lock_count != 0u) {
    const uint lock_qa = p.locked.at[nh], lock_ap = p.locked.at[ph], lock_pb = p.locked.at[nt], lock_bq = p.locked.at[pt];
    p.locked.at[nh] = lock_ap;
    p.locked.at[ph] = lock_pb;
    p.locked.at[nt] = lock_bq;
    p.locked.at[pt] = lock_qa;
  }
  const uint f = h / 3, g = t / 3;
  lead(nh, f, g);
  lead(ph, f, g);
  lead(nt, f, g);
  lead(pt, f, g);
  p.changed.at[f] = p.round;
  p.changed.at[g] = p.round;
}
