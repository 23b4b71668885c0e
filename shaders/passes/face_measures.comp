#version 460
#extension GL_GOOGLE_include_directive : require
// Area, moment and volume of a block of triangles, in coordinates relative to the bounds.
#include "lib/kernel.glsl"
#include "passes/surface_measures_params.h"

VKMESH_PUSH_CONSTANTS(FaceMeasuresParams);

vec3 scaled(uint h, vec3 centre, float scale) {
  precise vec3 q = (load3(p.positions, p.corners.at[h]) - centre) * scale;
  return zero_below(q, VKMESH_TINY_DIRECTION);
}

void main() {
  VKMESH_THREAD_INDEX(b);
  const vec3 low = load3(p.bounds, 0);
  precise vec3 extent = load3(p.bounds, 1) - low;
  const uint largest =
      max(max(floatBitsToUint(extent.x), floatBitsToUint(extent.y)), floatBitsToUint(extent.z)) & 0x7f800000u;
  const float scale = uintBitsToFloat(0x7f000000u - largest);
  precise vec3 half_extent = 0.5 * extent;
  precise vec3 centre = low + zero_below(half_extent, VKMESH_TINY_COORDINATE);
  const uint begin = VKMESH_SUM_BLOCK * b;
  precise float area_sum = 0.0;
  precise vec3 moment_sum = vec3(0.0);
  precise float volume_sum = 0.0;
  for (uint k = 0; k < VKMESH_SUM_BLOCK; ++k) {
    const uint f = min(begin + k, p.faces - 1u);
    const vec3 q0 = scaled(3 * f, centre, scale);
    const vec3 q1 = scaled(3 * f + 1, centre, scale);
    const vec3 q2 = scaled(3 * f + 2, centre, scale);
    const vec3 area = area_vector(q0, q1, q2);
    const float twice_area = vector_length(area);
    precise vec3 middle = (q0 + q1) + q2;
    precise vec3 moment = twice_area * zero_below(middle, VKMESH_TINY_DIRECTION);
    precise vec3 parts = q0 * area;
    parts = zero_below(parts, VKMESH_TINY_AREA);
    precise float more_area = area_sum + twice_area;
    precise vec3 more_moment = moment_sum + zero_below(moment, VKMESH_TINY_AREA);
    precise float more_volume = volume_sum + ((parts.x + parts.y) + parts.z);
    const bool counts = begin + k < p.faces;
    area_sum = counts ? more_area : area_sum;
    moment_sum = counts ? more_moment : moment_sum;
    volume_sum = counts ? more_volume : volume_sum;
  }
  VKMESH_SURPLUS_THREADS_LEAVE;
  p.sums.at[5 * b] = area_sum;
  p.sums.at[5 * b + 1] = moment_sum.x;
  p.sums.at[5 * b + 2] = moment_sum.y;
  p.sums.at[5 * b + 3] = moment_sum.z;
  p.sums.at[5 * b + 4] = volume_sum;
}
