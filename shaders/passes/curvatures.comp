#version 460
#extension GL_GOOGLE_include_directive : require
// Mean and Gaussian curvature at each vertex, from the ring of its neighbours.
#include "lib/kernel.glsl"
#include "passes/curvatures_params.h"

VKMESH_PUSH_CONSTANTS(CurvaturesParams);

// What one triangle gives to the vertex `here`; its other corners are q and r.
struct Share {
  vec3 area_vector;
  float at_q, at_r;  // Cotangents.
  float angle;
  float area;  // Eight times.
};

float squared_distance(vec3 a, vec3 b) {
  precise vec3 apart = b - a;
  return squared_length(zero_below(apart, VKMESH_TINY_LENGTH));
}

Share share(vec3 here, vec3 q, vec3 r) {
  Share s;
  s.area_vector = area_vector(here, q, r);
  const float twice_area = vector_length(s.area_vector);
  const float product = corner_product(here, q, r);
  s.at_q = cotangent(corner_product(q, r, here), twice_area);
  s.at_r = cotangent(corner_product(r, here, q), twice_area);
  s.angle = corner_angle(product, twice_area);
  precise float beside_q = squared_distance(here, q) * s.at_r;
  precise float beside_r = squared_distance(here, r) * s.at_q;
  precise float voronoi = zero_below(beside_q, VKMESH_TINY_AREA) + zero_below(beside_r, VKMESH_TINY_AREA);
  precise float half_of_it = 2.0 * twice_area;
  const bool obtuse_elsewhere = s.at_q < 0.0 || s.at_r < 0.0;
  s.area = product < 0.0 ? half_of_it : (obtuse_elsewhere ? twice_area : voronoi);
  return s;
}

struct Sums {
  vec3 laplacian, normal;
  float angles, area;
};

Sums add(Sums sums, Share s, vec3 here, vec3 q, float before) {
  precise float both = before + s.at_r;
  precise vec3 apart = here - q;
  precise vec3 laplacian = sums.laplacian + zero_below(both, VKMESH_TINY_DIRECTION) * zero_below(apart, VKMESH_TINY_LENGTH);
  precise vec3 normal = sums.normal + s.area_vector;
  precise float angles = sums.angles + s.angle;
  precise float area = sums.area + s.area;
  return Sums(laplacian, normal, angles, area);
}

void main() {
  VKMESH_THREAD_INDEX(v);
  const vec3 here = load3(p.positions, v);
  const uint begin = p.neighbour_offsets.at[v];
  const uint end = p.neighbour_offsets.at[v + 1];
  const bool open = ((p.boundary_bits.at[v / 32] >> (v % 32)) & 1u) != 0u;
  const vec3 last = load3(p.positions, p.neighbour_ids.at[VKMESH_CLAMPED(end - 1u, end)]);
  const vec3 first = load3(p.positions, p.neighbour_ids.at[VKMESH_CLAMPED(begin, end)]);
  const float closing = share(here, last, first).at_q;
  float before = open ? 0.0 : closing;
  vec3 q = first;
  Sums sums = Sums(vec3(0.0), vec3(0.0), 0.0, 0.0);
  for (uint n = begin; n < end || n < begin + VKMESH_UNMASKED; ++n) {
    const bool is_last = n + 1 >= end;
    const vec3 r = load3(p.positions, p.neighbour_ids.at[VKMESH_CLAMPED(is_last ? begin : n + 1, end)]);
    Share s = share(here, q, r);
    if (is_last && open) s = Share(vec3(0.0), 0.0, 0.0, 0.0, 0.0);
    const Sums more = add(sums, s, here, q, before);
    if (n < end) sums = more;
    before = s.at_q;
    q = r;
  }
  const float whole = open ? 1.0 : 2.0;
  precise float defect =
      (whole * (2.0 * VKMESH_HALF_PI_HIGH) - sums.angles) + whole * (2.0 * VKMESH_HALF_PI_LOW);
  precise float area = 0.125 * sums.area;
  precise float four_areas = 0.5 * sums.area;
  const vec3 a = unit_vector(sums.laplacian), b = unit_vector(sums.normal);
  precise float along = (a.x * b.x + a.y * b.y) + a.z * b.z;
  const float size = bounded_quotient(vector_length(sums.laplacian), four_areas, VKMESH_CURVATURE_BOUND,
                                      VKMESH_CURVATURE_BOUND_INVERSE);
  const float gaussian =
      bounded_quotient(defect, area, VKMESH_CURVATURE_BOUND, VKMESH_CURVATURE_BOUND_INVERSE);
  const bool isolated = begin == end;
  VKMESH_SURPLUS_THREADS_LEAVE;
  p.curvatures.at[4 * v] = open || isolated ? 0.0 : (along < 0.0 ? -size : size);
  p.curvatures.at[4 * v + 1] = open || isolated ? 0.0 : gaussian;
  p.curvatures.at[4 * v + 2] = isolated ? 0.0 : defect;
  p.curvatures.at[4 * v + 3] = isolated ? 0.0 : area;
}
