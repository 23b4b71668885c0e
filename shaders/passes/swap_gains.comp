#version 460
#extension GL_GOOGLE_include_directive : require
// What swapping each edge gains, for rounds of swaps; less than 0 where the new edge exists. Twin of
// host/src/passes/swap_rounds.cpp, find_gain().
#include "lib/kernel.glsl"
#include "lib/half_edges.glsl"
#include "lib/swap_geometry.glsl"
#include "passes/swap_rounds_params.h"

VKMESH_PUSH_CONSTANTS(SwapGainsParams);

float larger(float a, float b) { return b < a ? a : b; }

float triangle_score(float a, float b, float c) {
  const float low = smaller(a, b), high = larger(a, b);
  const float longest = larger(high, c);
  const float shortest = smaller(low, c), middle = larger(low, smaller(high, c));
  const float inverse = reciprocal(longest);
  precise float short_share = shortest * inverse;
  precise float middle_share = middle * inverse;
  const float x = zero_below(short_share, VKMESH_TINY_LENGTH), y = zero_below(middle_share, VKMESH_TINY_LENGTH);
  precise float sum = x + y;
  precise float rest = sum - 1.0;
  const float cosine = zero_below(rest, VKMESH_TINY_DIRECTION);
  // Not 4 x y: a product with a power of two is exact, and compilers fuse it with the difference all the same.
  precise float twice_x = 2.0 * x;
  precise float twice_y = 2.0 * y;
  precise float sixteenfold = twice_x * twice_y - cosine * cosine;
  const float area = zero_below(sixteenfold, VKMESH_TINY_AREA);
  const float positive = area > 0.0 ? area : 0.0;
  precise float fourfold = 4.0 * y;
  precise float sine = positive * reciprocal(fourfold);
  precise float threefold = 3.0 * positive;
  precise float sides = sum + 1.0;
  precise float quality = root(threefold) * reciprocal(sides);
  return p.criterion == VKMESH_SWAP_ROUNDS_BY_ANGLE ? sine : quality;
}

float gain_of(uint from, uint to, uint left, uint right) {
  const vec3 at_p = load3(p.positions, from), at_q = load3(p.positions, to), at_a = load3(p.positions, left),
             at_b = load3(p.positions, right);
  const float qa = squared_distance(at_q, at_a), ap = squared_distance(at_a, at_p), pb = squared_distance(at_p, at_b),
              bq = squared_distance(at_b, at_q), pq = squared_distance(at_p, at_q), ab = squared_distance(at_a, at_b);
  const float before = smaller(triangle_score(pq, qa, ap), triangle_score(pq, pb, bq));
  const float after = smaller(triangle_score(ab, ap, pb), triangle_score(ab, bq, qa));
  precise float gain = after - before;
  if (!(gain > 0.0)) return 0.0;
  precise vec3 both_areas = area_vector(at_p, at_q, at_a) + area_vector(at_q, at_p, at_b);
  const vec3 mean = unit_vector(both_areas);
  const bool refused = faces_away(mean, area_vector(at_a, at_b, at_q)) || faces_away(mean, area_vector(at_b, at_a, at_p));
  return refused ? 0.0 : gain;
}

// Whether an edge joins a and b, or a has too many to tell.
bool has_edge(uint a, uint b) {
  const uint leading = p.leading.at[a];
  uint h = leading;
  for (uint steps = 0; steps < VKMESH_MAX_SWAP_VALENCE; ++steps) {
    const uint before = previous_half_edge(h);
    if (p.corners.at[next_half_edge(h)] == b || p.corners.at[before] == b) return true;
    h = p.twins.at[before];
    if (h == 0xffffffffu || h == leading) return false;
  }
  return true;
}

bool is_locked(uint h) { return p.lock_count != 0u && p.locked.at[h] != 0u; }

void main() {
  VKMESH_THREAD_INDEX(h);
  VKMESH_SURPLUS_THREADS_LEAVE;
  const uint t = p.twins.at[h], last = p.round - 1u;
  if (last == 0u) {
    p.sources.at[h] = h;
    if (h % 3 == 0) p.changed.at[h / 3] = 0u;
  }
  if (t == 0xffffffffu || t < h) return;
  const uint a = p.corners.at[previous_half_edge(h)], b = p.corners.at[previous_half_edge(t)];
  float gain = p.gains.at[h];
  if (last == 0u || p.changed.at[h / 3] == last || p.changed.at[t / 3] == last)
    gain = is_locked(h) || is_locked(t) ? 0.0 : gain_of(p.corners.at[h], p.corners.at[t], a, b);
  if (gain != 0.0) gain = has_edge(a, b) ? -abs(gain) : abs(gain);
  p.gains.at[h] = gain;
}
