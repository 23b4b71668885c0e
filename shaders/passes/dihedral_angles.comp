#version 460
#extension GL_GOOGLE_include_directive : require
// The signed angle between the normals of the two faces at each edge; the thread of the smaller half-edge writes both.
#include "lib/kernel.glsl"
#include "passes/dihedral_angles_params.h"

VKMESH_PUSH_CONSTANTS(DihedralAnglesParams);

void main() {
  VKMESH_THREAD_INDEX(h);
  const uint t = p.twins.at[h];
  const bool boundary = t == 0xffffffffu;
  const vec3 origin = load3(p.positions, p.corners.at[h]);
  precise vec3 along = load3(p.positions, p.corners.at[h % 3 == 2 ? h - 2 : h + 1]) - origin;
  const float angle = dihedral_angle(load3(p.normals, h / 3), load3(p.normals, (boundary ? h : t) / 3), along);
  VKMESH_SURPLUS_THREADS_LEAVE;
  if (boundary) p.angles.at[h] = 0.0;
  if (boundary || t < h) return;
  p.angles.at[h] = angle;
  p.angles.at[t] = angle;
}
