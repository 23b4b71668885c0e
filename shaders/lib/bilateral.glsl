// What the kernels of bilateral smoothing share: a vertex, and the faces around it.
#ifndef VKMESH_BILATERAL_GLSL
#define VKMESH_BILATERAL_GLSL

#include "lib/kernel.glsl"

// From `here` to a face's centroid, in units of the spatial width.
vec3 to_centroid(Floats faces, uint face, vec3 here, float per_spatial) {
  const vec3 middle = vec3(faces.at[4 * face], faces.at[4 * face + 1], faces.at[4 * face + 2]);
  precise vec3 to = (middle - here) * per_spatial;
  return zero_below(to, VKMESH_TINY_DIRECTION);
}

float area_weight(float area, float gaussian) {
  precise float weight = area * gaussian;
  return zero_below(weight, VKMESH_TINY_GAUSSIAN);
}

// `here` moved by the mean of what was summed.
vec3 moved(vec3 here, vec3 sum, float total, float spatial) {
  precise vec3 mean = sum * reciprocal(total);
  mean = zero_below(mean, VKMESH_TINY_DIRECTION);
  precise vec3 there = here + mean * spatial;
  return zero_below(there, VKMESH_TINY_COORDINATE);
}

#endif
