#version 460
#extension GL_GOOGLE_include_directive : require
// The centroid of each face and its area in units of the squared spatial width, in the order of the grid.
#include "lib/kernel.glsl"
#include "passes/bilateral_smoothing_params.h"

VKMESH_PUSH_CONSTANTS(BilateralFacesParams);

void main() {
  VKMESH_THREAD_INDEX(i);
  const uint f = p.face_order.at[i];
  const vec3 a = load3(p.positions, p.corners.at[3 * f]);
  const vec3 b = load3(p.positions, p.corners.at[3 * f + 1]);
  const vec3 c = load3(p.positions, p.corners.at[3 * f + 2]);
  precise vec3 middle = ((a + b) + c) * reciprocal(3.0);
  middle = zero_below(middle, VKMESH_TINY_COORDINATE);
  precise float unit = p.spatial * p.spatial;
  const float area = bounded_quotient(vector_length(area_vector(a, b, c)), unit, VKMESH_BILATERAL_AREA_BOUND,
                                      VKMESH_BILATERAL_AREA_BOUND_INVERSE);
  VKMESH_SURPLUS_THREADS_LEAVE;
  p.faces.at[4 * i] = middle.x;
  p.faces.at[4 * i + 1] = middle.y;
  p.faces.at[4 * i + 2] = middle.z;
  p.faces.at[4 * i + 3] = area;
}
