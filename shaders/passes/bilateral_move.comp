#version 460
#extension GL_GOOGLE_include_directive : require
// Each vertex at the mean of its predictions by the tangent planes around it. Reads no other vertex, so that it may
// write in place.
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
      const vec3 n = load3(p.normals, face);
      precise float along_normal = (n.x * to.x + n.y * to.y) + n.z * to.z;
      const float height = zero_below(along_normal, VKMESH_TINY_DIRECTION);
      precise float scaled = height * p.spatial_over_influence;
      const float across = zero_below(scaled, VKMESH_TINY_DIRECTION);
      const float held = abs(across) < VKMESH_BILATERAL_FAR ? across : VKMESH_BILATERAL_FAR;
      const bool counts = squared < 4.0;
      precise float exponent = -0.5 * (squared + held * held);
      const float gaussian = exponential(counts ? exponent : -4.0);
      const float area = n == vec3(0.0) ? 0.0 : p.faces.at[4 * face + 3];
      const float weight = counts ? area_weight(area, gaussian) : 0.0;
      precise float product = weight * height;
      const float along = zero_below(product, VKMESH_TINY_GAUSSIAN);
      sum = sum + along * n;
      total = total + weight;
    }
  }
  const vec3 there = moved(here, sum, total, p.spatial);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.target, v, there);
}
