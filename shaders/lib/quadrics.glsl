// The arithmetic of quadrics. Twin of host/src/passes/collapse_costs.cpp.
#ifndef VKMESH_QUADRICS_GLSL
#define VKMESH_QUADRICS_GLSL

#include "lib/kernel.glsl"

// xx, xy, xz and yy, yz, zz.
struct Quadric {
  vec3 x, yz;
};

float seen(float x) { return zero_below(x, VKMESH_TINY_COORDINATE); }

vec3 scaled_position(Floats positions, uint v, vec3 centre, float scale) {
  precise vec3 q = (load3(positions, v) - centre) * scale;
  return zero_below(q, VKMESH_TINY_DIRECTION);
}

Quadric plane(vec3 n, float weight) {
  precise vec3 w = weight * n;
  w = zero_below(w, VKMESH_TINY_QUADRIC);
  precise vec3 x = w.x * n;
  precise vec3 yz = vec3(w.y * n.y, w.y * n.z, w.z * n.z);
  return Quadric(zero_below(x, VKMESH_TINY_QUADRIC), zero_below(yz, VKMESH_TINY_QUADRIC));
}

Quadric boundary_plane(vec3 p, vec3 q, vec3 n, float boundary_weight) {
  precise vec3 e = q - p;
  e = zero_below(e, VKMESH_TINY_DIRECTION);
  precise vec3 across = vec3(e.y * n.z - e.z * n.y, e.z * n.x - e.x * n.z, e.x * n.y - e.y * n.x);
  precise float weight = boundary_weight * squared_length(e);
  return plane(unit_vector(zero_below(across, VKMESH_TINY_AREA)), weight);
}

Quadric add(Quadric a, Quadric b) {
  precise vec3 x = a.x + b.x;
  precise vec3 yz = a.yz + b.yz;
  return Quadric(x, yz);
}

vec3 times(Quadric a, vec3 x) {
  precise vec3 product = vec3((a.x.x * x.x + a.x.y * x.y) + a.x.z * x.z, (a.x.y * x.x + a.yz.x * x.y) + a.yz.y * x.z,
                              (a.x.z * x.x + a.yz.y * x.y) + a.yz.z * x.z);
  return product;
}

float value(Quadric a, vec3 x) {
  const vec3 from = zero_below(x, VKMESH_TINY_DIRECTION);
  const vec3 ax = zero_below(times(a, from), VKMESH_TINY_COORDINATE);
  precise vec3 parts = from * ax;
  precise float sum = (seen(parts.x) + seen(parts.y)) + seen(parts.z);
  return sum > 0.0 ? sum : 0.0;
}

float both(Quadric p, Quadric q, vec3 d, vec3 x) {
  precise vec3 from_q = x - d;
  precise float sum = value(p, x) + value(q, from_q);
  return sum;
}

struct Factors {
  float r0, r1, r2, l1, l2, l3;
};

// a − b·c, the product seen.
float less_product(float a, float b, float c) {
  precise float product = b * c;
  precise float rest = a - seen(product);
  return rest;
}

float seen_product(float a, float b) {
  precise float product = a * b;
  return seen(product);
}

Factors factors_of(Quadric a) {
  Factors f;
  precise float e = ((a.x.x + a.yz.x) + a.yz.z) * VKMESH_FLAT_SHARE + VKMESH_FLAT_LEAST;
  precise float least = 0.5 * e;
  precise float p0 = a.x.x + e;
  f.r0 = reciprocal(p0);
  f.l1 = seen_product(a.x.y, f.r0);
  f.l2 = seen_product(a.x.z, f.r0);
  precise float yy = a.yz.x + e;
  const float p1 = less_product(yy, f.l1, a.x.y);
  f.r1 = reciprocal(p1 > least ? p1 : least);
  const float u = seen(less_product(a.yz.y, f.l2, a.x.y));
  f.l3 = seen_product(u, f.r1);
  precise float zz = a.yz.z + e;
  const float p2 = less_product(less_product(zz, f.l2, a.x.z), f.l3, u);
  f.r2 = reciprocal(p2 > least ? p2 : least);
  return f;
}

vec3 solve(Factors f, vec3 g) {
  const float w0 = -g.x;
  const float w1 = seen(less_product(-g.y, f.l1, w0));
  const float w2 = seen(less_product(less_product(-g.z, f.l2, w0), f.l3, w1));
  const float z = seen_product(w2, f.r2);
  const float y = seen(less_product(seen_product(w1, f.r1), f.l3, z));
  const float x = seen(less_product(less_product(seen_product(w0, f.r0), f.l1, y), f.l2, z));
  return vec3(x, y, z);
}

vec3 least_place(Quadric p, Quadric q, vec3 d) {
  precise vec3 m = 0.5 * d;
  const Quadric sum = add(p, q);
  precise vec3 difference_x = p.x - q.x;
  precise vec3 difference_yz = p.yz - q.yz;
  const Quadric difference = Quadric(zero_below(difference_x, VKMESH_TINY_COORDINATE),
                                     zero_below(difference_yz, VKMESH_TINY_COORDINATE));
  const vec3 g = zero_below(times(difference, m), VKMESH_TINY_COORDINATE);
  const Factors factors = factors_of(sum);
  const vec3 first = solve(factors, g);
  precise vec3 rest = g + times(sum, zero_below(first, VKMESH_TINY_DIRECTION));
  precise vec3 s = first + solve(factors, zero_below(rest, VKMESH_TINY_COORDINATE));
  s = zero_below(s, VKMESH_TINY_DIRECTION);
  precise float bound = 4.0 * squared_length(d);
  precise vec3 there = m + s;
  return squared_length(s) <= bound ? there : m;
}

#endif
