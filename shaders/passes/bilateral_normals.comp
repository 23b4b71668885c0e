#version 460
#extension GL_GOOGLE_include_directive : require
// The unit normals of the mollified faces, in the order of the grid.
#include "lib/kernel.glsl"
#include "passes/bilateral_smoothing_params.h"

VKMESH_PUSH_CONSTANTS(BilateralNormalsParams);

void main() {
  VKMESH_THREAD_INDEX(i);
  const uint f = p.face_order.at[i];
  const vec3 area = area_vector(load3(p.mollified, p.corners.at[3 * f]), load3(p.mollified, p.corners.at[3 * f + 1]),
                                load3(p.mollified, p.corners.at[3 * f + 2]));
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.normals, i, unit_vector(area));
}
