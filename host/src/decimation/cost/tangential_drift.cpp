#include "decimation/cost/tangential_drift.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "math/vector3.h"
#include "simd/target_clones.h"

namespace vkmesh::detail {
namespace {

using Vector = Vector3;
constexpr std::int32_t kBlock = CollapseNeighbourhood::kBlock;

// Squared, of a point from a triangle (C. Ericson, "Real-time collision detection", 2005); NaN where the
// triangle has a corner at no place.
float squared_distance_to(const Vector& x, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = minus(b, a), ac = minus(c, a), ax = minus(x, a);
  const auto from = [&](float s, float t) {
    const Vector rest = {ax[0] - s * ab[0] - t * ac[0], ax[1] - s * ab[1] - t * ac[1],
                         ax[2] - s * ab[2] - t * ac[2]};
    return dot(rest, rest);
  };
  const float d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return from(0, 0);
  const Vector bx = minus(x, b);
  const float d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0 && d4 <= d3) return from(1, 0);
  const float of_c = d1 * d4 - d3 * d2;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return from(d1 / (d1 - d3), 0);
  const Vector cx = minus(x, c);
  const float d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0 && d5 <= d6) return from(0, 1);
  const float of_b = d5 * d2 - d1 * d6;
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return from(0, d2 / (d2 - d6));
  const float of_a = d3 * d6 - d5 * d4;
  if (of_a <= 0 && d4 >= d3 && d5 >= d6) {
    const float t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return from(1 - t, t);
  }
  const float all = of_a + of_b + of_c;
  return from(of_b / all, of_c / all);
}

// What lies where: the new point, and relative to it the ends of the edge.
struct Lie {
  Vector place, p, q;
  std::int32_t at_p, faces;
};
// Upper bounds of squared distances, one lane a face.
constexpr std::size_t kMostBounds = 32;
using BoundLanes = std::array<float, kMostBounds>;
struct SpokeBounds {
  BoundLanes before,
      after;  // from the middle of the edge to the second corner to the faces at it on the other side
};

// Squared, from (x, y, z) to a point of a triangle, most often the nearest; A, B and C are its corners.
[[gnu::always_inline]] inline float to_point_of(float x, float y, float z, float ax, float ay, float az,
                                                float bx, float by, float bz, float cx, float cy, float cz) {
  const float ux = bx - ax, uy = by - ay, uz = bz - az, vx = cx - ax, vy = cy - ay, vz = cz - az;
  const float wx = x - ax, wy = y - ay, wz = z - az;
  const float uu = ux * ux + uy * uy + uz * uz, uv = ux * vx + uy * vy + uz * vz,
              vv = vx * vx + vy * vy + vz * vz, uw = ux * wx + uy * wy + uz * wz,
              vw = vx * wx + vy * wy + vz * wz;
  const float over = 1.0f / (uu * vv - uv * uv);
  float s = (vv * uw - uv * vw) * over, t;
  s = s > 0 ? s : 0.0f;
  s = s < 1 ? s : 1.0f;
  t = (vw - s * uv) / vv;
  t = t > 0 ? t : 0.0f;
  t = t < 1 - s ? t : 1 - s;
  const float rx = wx - s * ux - t * vx, ry = wy - s * uy - t * vy, rz = wz - s * uz - t * vz;
  return rx * rx + ry * ry + rz * rz;
}

VKMESH_CLONES void bound_spokes(const float* __restrict cx, const float* __restrict cy,
                                const float* __restrict cz, const Lie& lie, float* __restrict before,
                                float* __restrict after) {
  const float x0 = lie.place[0], x1 = lie.place[1], x2 = lie.place[2];
  const float p0 = lie.p[0], p1 = lie.p[1], p2 = lie.p[2], q0 = lie.q[0], q1 = lie.q[1], q2 = lie.q[2];
  for (std::int32_t left = lie.faces, at_p = lie.at_p; left > 0; left -= kBlock, at_p -= kBlock) {
    for (std::int32_t k = 0; k < kBlock; ++k) {  // so many and no others, or g++ 12 does it one by one
      const float ax = cx[k] - x0, ay = cy[k] - x1, az = cz[k] - x2;
      const float bx = cx[k + 1] - x0, by = cy[k + 1] - x1, bz = cz[k + 1] - x2;
      const float ex = cx[k + 2] - x0, ey = cy[k + 2] - x1, ez = cz[k + 2] - x2;
      // The old point of this face, and that of the next.
      const bool at_q = k >= at_p, next_at_q = (k + 1 >= at_p) & (k + 1 < left);
      const float ox = at_q ? q0 : p0, oy = at_q ? q1 : p1, oz = at_q ? q2 : p2;
      const float nx = next_at_q ? q0 : p0, ny = next_at_q ? q1 : p1, nz = next_at_q ? q2 : p2;
      const float most = 0.25f * (ox * ox + oy * oy + oz * oz);
      const float sx = 0.5f * (ox + bx), sy = 0.5f * (oy + by), sz = 0.5f * (oz + bz);
      const float s1 = to_point_of(sx, sy, sz, 0, 0, 0, ax, ay, az, bx, by, bz),
                  s2 = to_point_of(sx, sy, sz, 0, 0, 0, bx, by, bz, ex, ey, ez);
      const float tx = 0.5f * bx, ty = 0.5f * by, tz = 0.5f * bz;
      const float t1 = to_point_of(tx, ty, tz, ox, oy, oz, ax, ay, az, bx, by, bz),
                  t2 = to_point_of(tx, ty, tz, nx, ny, nz, bx, by, bz, ex, ey, ez);
      const float s = s1 < most ? s1 : most, t = t1 < most ? t1 : most;
      before[k] = s2 < s ? s2 : s;
      after[k] = t2 < t ? t2 : t;
    }
    cx += kBlock;
    cy += kBlock;
    cz += kBlock;
    before += kBlock;
    after += kBlock;
  }
}

// Squared, from a point to each of the faces, the new ones or the old ones at p and q; most often the least.
VKMESH_CLONES void bound_faces(const float* __restrict cx, const float* __restrict cy,
                               const float* __restrict cz, const Lie& lie, const Vector& point,
                               const Vector& third_at_p, const Vector& third_at_q, float* __restrict to) {
  const float x0 = lie.place[0], x1 = lie.place[1], x2 = lie.place[2];
  const float p0 = third_at_p[0], p1 = third_at_p[1], p2 = third_at_p[2];
  const float q0 = third_at_q[0], q1 = third_at_q[1], q2 = third_at_q[2];
  const float w0 = point[0], w1 = point[1], w2 = point[2];
  for (std::int32_t left = lie.faces, at_p = lie.at_p; left > 0; left -= kBlock, at_p -= kBlock) {
    for (std::int32_t k = 0; k < kBlock; ++k) {  // so many and no others, or g++ 12 does it one by one
      const bool at_q = k >= at_p;
      const float ox = at_q ? q0 : p0, oy = at_q ? q1 : p1, oz = at_q ? q2 : p2;
      to[k] = to_point_of(w0, w1, w2, ox, oy, oz, cx[k] - x0, cy[k] - x1, cz[k] - x2, cx[k + 1] - x0,
                          cy[k + 1] - x1, cz[k + 1] - x2);
    }
    cx += kBlock;
    cy += kBlock;
    cz += kBlock;
    to += kBlock;
  }
}

}  // namespace

float squared_distance_of_collapse(const CollapseNeighbourhood& around, const Vector& p, const Vector& q,
                                   const Vector& x, float least) {
  const std::size_t faces = around.faces(), faces_at_p = around.faces_at_p();
  const auto corner = [&](std::size_t k) { return around.corner(k, p, x); };
  // All relative to p + x, where the new point lies.
  const auto half = [](const Vector& a, const Vector& b) {
    return Vector{0.5f * (a[0] + b[0]), 0.5f * (a[1] + b[1]), 0.5f * (a[2] + b[2])};
  };
  const Vector at_p = {-x[0], -x[1], -x[2]},
               at_q = {q[0] - p[0] - x[0], q[1] - p[1] - x[1], q[2] - p[2] - x[2]}, middle = half(at_p, at_q);
  const float from_p = dot(at_p, at_p), from_q = dot(at_q, at_q);
  float far = least;
  if (!(from_p > far) && !(from_q > far)) return far;
  const std::size_t some = std::min(faces, kMostBounds);
  const Lie lie = {{p[0] + x[0], p[1] + x[1], p[2] + x[2]},
                   at_p,
                   at_q,
                   static_cast<std::int32_t>(faces_at_p),
                   static_cast<std::int32_t>(some)};

  // `near`: a distance that is known. All faces at once tell most often that it is near enough.
  const auto to_faces = [&](const Vector& point, float near, const Vector& third_at_p,
                            const Vector& third_at_q) {
    if (near > far) {
      BoundLanes bounds;
      bound_faces(around.x(), around.y(), around.z(), lie, point, third_at_p, third_at_q, bounds.data());
      for (std::size_t k = 0; k < some; ++k) near = bounds[k] < near ? bounds[k] : near;
    }
    for (std::size_t k = 0; k < faces && near > far; ++k) {
      const float d =
          squared_distance_to(point, k < faces_at_p ? third_at_p : third_at_q, corner(k), corner(k + 1));
      near = d < near ? d : near;
    }
    return near;
  };
  const auto to_new = [&](const Vector& point, float near) {
    if (!(dot(point, point) >= 0)) return;  // it lies nowhere
    near = to_faces(point, near, {}, {});
    far = near > far ? near : far;
  };
  const auto to_old = [&](const Vector& point, float near) {
    // The faces of the edge lie in the midst.
    for (const std::size_t side : {std::size_t{0}, faces_at_p}) {
      if (!(near > far)) break;
      const float d = squared_distance_to(point, at_p, at_q, corner(side));
      near = d < near ? d : near;
    }
    near = to_faces(point, near, at_p, at_q);
    far = near > far ? near : far;
  };
  to_new(at_p, from_p);
  to_new(at_q, from_q);
  to_new(middle, dot(middle, middle));
  if (far > least) return far;  // far enough for now
  SpokeBounds spokes;
  bound_spokes(around.x(), around.y(), around.z(), lie, spokes.before.data(), spokes.after.data());
  // Both have an edge to where their rings meet; of the one, it is the second at this corner.
  to_new(half(at_p, corner(0)), 0.25f * from_p);
  to_new(half(at_q, corner(faces_at_p)), 0.25f * from_q);
  for (std::size_t k = 0; k < faces; ++k) {
    const bool known = k < some;
    if (known && !(spokes.before[k] > far) && !(spokes.after[k] > far)) continue;
    const Vector to = corner(k + 1);
    if (!(dot(to, to) >= 0)) continue;  // it lies nowhere
    const Vector& end = k < faces_at_p ? at_p : at_q;
    const float near = 0.25f * dot(end, end);
    to_new(half(end, to), known ? spokes.before[k] : near);
    to_old(half({}, to), known ? spokes.after[k] : near);
  }
  return far;
}

}  // namespace vkmesh::detail
