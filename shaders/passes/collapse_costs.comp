#version 460
#extension GL_GOOGLE_include_directive : require
// What collapsing each edge costs; the thread of the smaller half-edge writes both.
#include "lib/quadrics.glsl"
#include "passes/collapse_costs_params.h"

VKMESH_PUSH_CONSTANTS(CollapseCostsParams);

void main() {
  VKMESH_THREAD_INDEX(h);
  const uint t = p.twins.at[h];
  const uint at_p = p.corners.at[h];
  const uint at_q = p.corners.at[h % 3 == 2 ? h - 2 : h + 1];
  const vec3 centre = vec3(p.centre_x, p.centre_y, p.centre_z);
  precise vec3 d = scaled_position(p.positions, at_q, centre, p.scale) -
                   scaled_position(p.positions, at_p, centre, p.scale);
  d = zero_below(d, VKMESH_TINY_DIRECTION);
  const Quadric qp = Quadric(load3(p.quadrics, 2 * at_p), load3(p.quadrics, 2 * at_p + 1));
  const Quadric qq = Quadric(load3(p.quadrics, 2 * at_q), load3(p.quadrics, 2 * at_q + 1));
  float cost = 0.0;
  if (p.placement == VKMESH_PLACEMENT_ENDPOINT) {
    const float cost_p = both(qp, qq, d, vec3(0.0)), cost_q = both(qp, qq, d, d);
    cost = cost_q <= cost_p ? cost_q : cost_p;
  } else {
    precise vec3 middle = 0.5 * d;
    cost = both(qp, qq, d, p.placement == VKMESH_PLACEMENT_OPTIMAL ? least_place(qp, qq, d) : middle);
  }
  cost = (floatBitsToUint(cost) & 0x7fffffffu) < 0x7f800000u ? cost : VKMESH_LARGEST;
  VKMESH_SURPLUS_THREADS_LEAVE;
  if (t < h) return;
  p.costs.at[h] = cost;
  if (t != 0xffffffffu) p.costs.at[t] = cost;
}
