// What scores of swaps and rounds of them share. Twin of host/src/passes/swap_geometry.h.
#ifndef VKMESH_SWAP_GEOMETRY_GLSL
#define VKMESH_SWAP_GEOMETRY_GLSL

float squared_distance(vec3 a, vec3 b) {
  precise vec3 apart = b - a;
  return squared_length(zero_below(apart, VKMESH_TINY_LENGTH));
}

// Whether a triangle of this area vector does not look the way of a unit vector.
bool faces_away(vec3 unit, vec3 area) {
  const vec3 other = unit_vector(area);
  precise float along = (unit.x * other.x + unit.y * other.y) + unit.z * other.z;
  return !(along > 0.0);
}

float smaller(float a, float b) { return b < a ? b : a; }

#endif
