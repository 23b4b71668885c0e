#version 460
#extension GL_GOOGLE_include_directive : require
// Each vertex at the mean of the centroids around it, by area and a Gaussian of half the spatial width.
#include "lib/bilateral.glsl"
#include "passes/bilateral_smoothing_params.h"

VKMESH_PUSH_CONSTANTS(BilateralSumParams);

void main() {
  VKMESH_THREAD_INDEX(i);
  const uint v = p.vertex_order.at[i];
  const vec3 here = load3(p.positions, v);
  const uint cell = p.cells.at[i];
  precise vec3 sum = vec3(0.0);
  precise float total = 0.0;
  const uint last_range = p.range_offsets.at[cell + 1];
  for (uint range = p.range_offsets.at[cell]; range < last_range; ++range) {
    const uint end = p.ranges.at[2 * range + 1];
    for (uint face = p.ranges.at[2 * range]; face < end; ++face) {
      const vec3 to = to_centroid(p.faces, face, here, p.per_spatial);
      const float squared = squared_length(to);
      precise float exponent = -2.0 * squared;
      const float gaussian = exponential(squared < 1.0 ? exponent : -2.0);
      const float weight = squared < 1.0 ? area_weight(p.faces.at[4 * face + 3], gaussian) : 0.0;
      sum = sum + weight * to;
      total = total + weight;
    }
  }
  const vec3 there = moved(here, sum, total, p.spatial);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.target, v, there);
}
