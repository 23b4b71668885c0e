#version 460
#extension GL_GOOGLE_include_directive : require
// Scales the surface about its centroid to the volume it had. Twin of host/src/passes/restore_volume.cpp.
#include "lib/kernel.glsl"
#include "passes/restore_volume_params.h"

VKMESH_PUSH_CONSTANTS(RestoreVolumeParams);

vec3 extent_of(Floats m) {
  precise vec3 extent = load3(m, 1) - load3(m, 0);
  return extent;
}

uint largest_exponent(vec3 extent) {
  const uvec3 b = floatBitsToUint(extent);
  return max(max(b.x, b.y), b.z) >> 23;
}

void main() {
  VKMESH_THREAD_INDEX(v);
  const float six_before = p.before.at[10], six_after = p.after.at[10];
  const vec3 extent = extent_of(p.after);
  const uint exponent = largest_exponent(extent);
  const float ratio = bounded_quotient(abs(six_before), abs(six_after), VKMESH_VOLUME_RATIO_BOUND,
                                       VKMESH_VOLUME_RATIO_BOUND_INVERSE);
  const bool alike = (six_before < 0.0) == (six_after < 0.0) && ratio > VKMESH_VOLUME_RATIO_BOUND_INVERSE &&
                     ratio < VKMESH_VOLUME_RATIO_BOUND;
  const int larger = int(largest_exponent(extent_of(p.before))) - int(exponent);
  const bool near = larger >= -10 && larger <= 10;
  precise float scaled_root = cube_root(ratio) * uintBitsToFloat(uint(127 + larger) << 23);
  const float factor = alike && near ? scaled_root : 1.0;

  precise vec3 half_extent = 0.5 * extent;
  precise vec3 centre = load3(p.after, 0) + zero_below(half_extent, VKMESH_TINY_COORDINATE);
  precise float weight = 3.0 * p.after.at[6];
  precise vec3 middle = vec3(p.after.at[7], p.after.at[8], p.after.at[9]) * reciprocal(weight);
  precise vec3 offset = zero_below(middle, VKMESH_TINY_DIRECTION) * uintBitsToFloat(exponent << 23);
  precise vec3 pivot = centre + zero_below(offset, VKMESH_TINY_COORDINATE);

  const vec3 here = load3(p.positions, v);
  precise vec3 from = here - pivot;
  precise vec3 to = zero_below(from, VKMESH_TINY_COORDINATE) * factor;
  precise vec3 there = pivot + zero_below(to, VKMESH_TINY_COORDINATE);
  there = zero_below(there, VKMESH_TINY_COORDINATE);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.positions, v, factor == 1.0 ? here : there);
}
