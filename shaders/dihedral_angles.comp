#version 460
#extension GL_GOOGLE_include_directive : require
// The angle between the normals of the two faces at each edge; the thread of the smaller half-edge writes both.
#include "kernel.glsl"

VKMESH_PUSH_CONSTANTS(DihedralAnglesParams);

void main() {
  VKMESH_THREAD_INDEX(h);
  const uint t = p.twins.at[h];
  const bool boundary = t == 0xffffffffu;
  const float angle = angle_between(load3(p.normals, h / 3), load3(p.normals, (boundary ? h : t) / 3));
  VKMESH_SURPLUS_THREADS_LEAVE;
  if (boundary) p.angles.at[h] = 0.0;
  if (boundary || t < h) return;
  p.angles.at[h] = angle;
  p.angles.at[t] = angle;
}
