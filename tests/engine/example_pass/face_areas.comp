#version 460
#extension GL_GOOGLE_include_directive : require
// Half the length of the area vector of each face.
#include "lib/kernel.glsl"
#include "face_areas_params.h"

VKMESH_PUSH_CONSTANTS(FaceAreasParams);

void main() {
  VKMESH_THREAD_INDEX(f);
  precise float area = 0.5 * vector_length(face_area_vector(p.positions, p.corners, f));
  VKMESH_SURPLUS_THREADS_LEAVE;
  p.areas.at[f] = area;
}
