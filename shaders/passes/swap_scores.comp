#version 460
#extension GL_GOOGLE_include_directive : require
// What swapping each edge gains; the thread of the smaller half-edge writes both. Twin of
// host/src/passes/swap_scores.cpp.
#include "lib/kernel.glsl"
#include "lib/swap_geometry.glsl"
#include "passes/swap_scores_params.h"

VKMESH_PUSH_CONSTANTS(SwapScoresParams);

float least_angle(vec3 a, vec3 b, vec3 c, float twice_area) {
  const float at_a = corner_angle(corner_product(a, b, c), twice_area);
  const float at_b = corner_angle(corner_product(b, c, a), twice_area);
  const float at_c = corner_angle(corner_product(c, a, b), twice_area);
  const float least = at_b < at_a ? at_b : at_a;
  return at_c < least ? at_c : least;
}

float quality(vec3 a, vec3 b, vec3 c, float twice_area) {
  precise float sides = (squared_distance(a, b) + squared_distance(b, c)) + squared_distance(c, a);
  precise float scaled = VKMESH_QUALITY_SCALE * twice_area;
  return bounded_quotient(scaled, zero_below(sides, VKMESH_TINY_AREA), 2.0, 0.5);
}

struct Triangle {
  vec3 area;
  float score;
};

Triangle triangle(vec3 a, vec3 b, vec3 c) {
  const vec3 area = area_vector(a, b, c);
  const float twice_area = vector_length(area);
  return Triangle(area, p.criterion == VKMESH_SWAP_BY_ANGLE ? least_angle(a, b, c, twice_area)
                                                            : quality(a, b, c, twice_area));
}

void main() {
  VKMESH_THREAD_INDEX(h);
  const uint t = p.twins.at[h];
  const bool boundary = t == 0xffffffffu;
  const uint other = boundary ? h : t;
  const vec3 from = load3(p.positions, p.corners.at[h]);
  const vec3 to = load3(p.positions, p.corners.at[h % 3 == 2 ? h - 2 : h + 1]);
  const vec3 left = load3(p.positions, p.corners.at[h % 3 == 0 ? h + 2 : h - 1]);
  const vec3 right = load3(p.positions, p.corners.at[other % 3 == 0 ? other + 2 : other - 1]);
  const Triangle t0 = triangle(from, to, left), t1 = triangle(to, from, right);
  const Triangle n0 = triangle(left, right, to), n1 = triangle(right, left, from);
  precise vec3 both_areas = t0.area + t1.area;
  const vec3 before = unit_vector(both_areas);
  precise float gain = smaller(n0.score, n1.score) - smaller(t0.score, t1.score);
  const bool refused = boundary || faces_away(before, n0.area) || faces_away(before, n1.area);
  VKMESH_SURPLUS_THREADS_LEAVE;
  if (t < h) return;
  p.scores.at[h] = refused ? VKMESH_NO_SWAP : gain;
  if (!boundary) p.scores.at[t] = refused ? VKMESH_NO_SWAP : gain;
}
