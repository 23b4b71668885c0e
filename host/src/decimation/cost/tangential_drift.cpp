#include "decimation/cost/tangential_drift.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "math/vector3.h"

namespace vkmesh::detail {
namespace {

// Squared, of a point from a triangle (C. Ericson, "Real-time collision detection", 2005); NaN where the
// triangle has a corner at no place.
float squared_distance_to(const Vector3& x, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = minus(b, a), ac = minus(c, a), ax = minus(x, a);
  const auto from = [&](float s, float t) {
    const Vector3 rest = {ax[0] - s * ab[0] - t * ac[0], ax[1] - s * ab[1] - t * ac[1],
                          ax[2] - s * ab[2] - t * ac[2]};
    return dot(rest, rest);
  };
  const float d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return from(0, 0);
  const Vector3 bx = minus(x, b);
  const float d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0 && d4 <= d3) return from(1, 0);
  const float of_c = d1 * d4 - d3 * d2;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return from(d1 / (d1 - d3), 0);
  const Vector3 cx = minus(x, c);
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

}  // namespace

float squared_distance_of_collapse(const CollapseNeighbourhood& around, const Vector3& p, const Vector3& q,
                                   const Vector3& x, float least) {
  const std::size_t faces = around.faces(), faces_at_p = around.faces_at_p();
  const auto corner = [&](std::size_t k) { return around.corner(k, p, x); };
  // All relative to p + x, where the new point lies.
  const auto half = [](const Vector3& a, const Vector3& b) {
    return Vector3{0.5f * (a[0] + b[0]), 0.5f * (a[1] + b[1]), 0.5f * (a[2] + b[2])};
  };
  const Vector3 at_p = {-x[0], -x[1], -x[2]},
                at_q = {q[0] - p[0] - x[0], q[1] - p[1] - x[1], q[2] - p[2] - x[2]},
                middle = half(at_p, at_q);
  const float from_p = dot(at_p, at_p), from_q = dot(at_q, at_q);
  float far = least;
  if (!(from_p > far) && !(from_q > far)) return far;
  // `near`: a distance that is known. `first`: the face that is most often near enough, so that no other
  // counts.
  const auto to_faces = [&](const Vector3& point, float near, std::size_t first, const Vector3& third_at_p,
                            const Vector3& third_at_q) {
    for (std::size_t i = 0; i < faces && near > far; ++i) {
      const std::size_t k = first + i < faces ? first + i : first + i - faces;
      const float d =
          squared_distance_to(point, k < faces_at_p ? third_at_p : third_at_q, corner(k), corner(k + 1));
      near = d < near ? d : near;
    }
    return near;
  };
  const auto to_new = [&](const Vector3& point, float near, std::size_t first) {
    if (!(dot(point, point) >= 0)) return;  // it lies nowhere
    near = to_faces(point, near, first, {}, {});
    far = near > far ? near : far;
  };
  const auto to_old = [&](const Vector3& point, float near, std::size_t first) {
    // The faces of the edge lie in the midst.
    for (const std::size_t side : {std::size_t{0}, faces_at_p}) {
      if (!(near > far)) break;
      const float d = squared_distance_to(point, at_p, at_q, corner(side));
      near = d < near ? d : near;
    }
    near = to_faces(point, near, first, at_p, at_q);
    far = near > far ? near : far;
  };
  to_new(at_p, from_p, 0);
  to_new(at_q, from_q, faces_at_p);
  to_new(middle, dot(middle, middle), 0);
  if (far > least) return far;  // far enough for now
  // Both have an edge to where their rings meet; of the one, it is the second at this corner.
  to_new(half(at_p, corner(0)), 0.25f * from_p, 0);
  to_new(half(at_q, corner(faces_at_p)), 0.25f * from_q, faces_at_p);
  for (std::size_t k = 0; k < faces; ++k) {
    const Vector3 to = corner(k + 1);
    if (!(dot(to, to) >= 0)) continue;  // it lies nowhere
    const Vector3& end = k < faces_at_p ? at_p : at_q;
    const float near = 0.25f * dot(end, end);
    to_new(half(end, to), near, k);
    to_old(half({}, to), near, k);
  }
  return far;
}

}  // namespace vkmesh::detail
