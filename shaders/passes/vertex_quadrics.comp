#version 460
#extension GL_GOOGLE_include_directive : require
// The planes around each vertex, in ascending order of faces.
#include "lib/quadrics.glsl"
#include "passes/collapse_costs_params.h"

VKMESH_PUSH_CONSTANTS(QuadricsParams);

void main() {
  VKMESH_THREAD_INDEX(v);
  const vec3 centre = vec3(p.centre_x, p.centre_y, p.centre_z);
  const uint begin = p.corner_offsets.at[v];
  const uint end = p.corner_offsets.at[v + 1];
  Quadric sum = Quadric(vec3(0.0), vec3(0.0));
  for (uint c = begin; c < end || c < begin + VKMESH_UNMASKED; ++c) {
    const uint h = p.corner_half_edges.at[VKMESH_CLAMPED(c, end)];
    const uint next = h % 3 == 2 ? h - 2 : h + 1;
    const uint previous = h % 3 == 0 ? h + 2 : h - 1;
    const vec3 p0 = scaled_position(p.positions, p.corners.at[h], centre, p.scale);
    const vec3 p1 = scaled_position(p.positions, p.corners.at[next], centre, p.scale);
    const vec3 p2 = scaled_position(p.positions, p.corners.at[previous], centre, p.scale);
    // From the face's first corner on, as the reference has it.
    const uint i = h % 3;
    const vec3 area = area_vector(i == 0 ? p0 : (i == 1 ? p2 : p1), i == 0 ? p1 : (i == 1 ? p0 : p2),
                                  i == 0 ? p2 : (i == 1 ? p1 : p0));
    const vec3 n = unit_vector(area);
    precise float weight = 0.5 * vector_length(area);
    if (c < end) {
      sum = add(sum, plane(n, weight));
      if (p.twins.at[h] == 0xffffffffu) sum = add(sum, boundary_plane(p0, p1, n, p.boundary_weight));
      if (p.twins.at[previous] == 0xffffffffu) sum = add(sum, boundary_plane(p2, p0, n, p.boundary_weight));
    }
  }
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.quadrics, 2 * v, sum.x);
  store3(p.quadrics, 2 * v + 1, sum.yz);
}
