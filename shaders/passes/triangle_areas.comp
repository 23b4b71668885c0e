#version 460
#extension GL_GOOGLE_include_directive : require
// Twice the area of each triangle, along its normal.
#include "lib/kernel.glsl"
#include "passes/triangle_normals_params.h"

VKMESH_PUSH_CONSTANTS(TrianglesParams);

void main() {
  VKMESH_THREAD_INDEX(f);
  const vec3 area = face_area_vector(p.positions, p.corners, f);
  VKMESH_SURPLUS_THREADS_LEAVE;
  store3(p.vectors, f, area);
}
