#include "decimation/face_turns.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "decimation/four_rows.h"
#include "passes/clones.h"

namespace vkmesh::detail {
namespace {

/// A triangle of less area than this share of its squared sides has no reliable normal.
constexpr float kDegenerate = 1e-6f;
constexpr std::int32_t kBlock = FaceTurns::kBlock;
/// Cosine of the angle at which neighbours stand against each other.
constexpr float kAgainst = -0.5f;

// What `turn` finds.
constexpr std::int32_t kBroken = 1;   // a face turns too far or loses its area
constexpr std::int32_t kHadNone = 2;  // a face without area gets one
constexpr std::int32_t kOpposed = 4;  // neighbours stand against each other afterwards

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Of the angle between two vectors; 1 where one has no length.
float cosine(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  const float n = std::sqrt(dot(a, a)) * std::sqrt(dot(b, b));
  return n > 0 ? dot(a, b) / n : 1.0f;
}

// Squared, of a point from a triangle (C. Ericson, "Real-time collision detection", 2005); NaN where the
// triangle has a corner at no place.
float squared_distance_to(const std::array<float, 3>& x, const std::array<float, 3>& a,
                          const std::array<float, 3>& b, const std::array<float, 3>& c) {
  using Vector = std::array<float, 3>;
  const auto minus = [](const Vector& u, const Vector& v) {
    return Vector{u[0] - v[0], u[1] - v[1], u[2] - v[2]};
  };
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

struct Move {
  std::array<float, 3> p, d, x;  // q and the new place relative to p
  std::int32_t at_p, faces;
  float cos_deviation;
};

// Of the corners a and b and a third at 0, over about the squared sides, so that no square leaves the range
// of a float: a power of two, since to divide is slow.
struct Normal {
  float x, y, z, length2;
  float sides;  // the squared sides, in [1, 2) as a rule

  [[gnu::always_inline]] Normal(float ax, float ay, float az, float bx, float by, float bz) {
    constexpr std::int32_t kExponent = 0x7f800000, kTwiceBias = 0x7f000000;
    const float squared = (ax * ax + ay * ay + az * az) + (bx * bx + by * by + bz * bz) + 1e-36f;
    const float scale = std::bit_cast<float>(kTwiceBias - (std::bit_cast<std::int32_t>(squared) & kExponent));
    x = (ay * bz - az * by) * scale;
    y = (az * bx - ax * bz) * scale;
    z = (ax * by - ay * bx) * scale;
    length2 = x * x + y * y + z * z;
    sides = squared * scale;
  }
  [[nodiscard, gnu::always_inline]] bool exists() const {
    return length2 > kDegenerate * kDegenerate * (sides * sides);
  }
  [[nodiscard, gnu::always_inline]] float product(const Normal& n) const {
    return x * n.x + y * n.y + z * n.z;
  }
};

// What lies where: the new point, and relative to it the ends of the edge and its middle.
struct Lie {
  std::array<float, 3> place, p, q, middle;
  std::int32_t at_p, faces;
};
// Of distances, squared, in one lane a face: none is larger than what stands here.
constexpr std::size_t kMostBounds = 32;
using BoundLanes = std::array<float, kMostBounds>;
struct EndBounds {
  BoundLanes p, q, middle;  // from these to the new face
};
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

VKMESH_CLONES void bound_ends(const float* __restrict cx, const float* __restrict cy,
                              const float* __restrict cz, const Lie& lie, EndBounds& out) {
  float *const __restrict from_p = out.p.data(), *const __restrict from_q = out.q.data(),
                          *const __restrict from_middle = out.middle.data();
  const float x0 = lie.place[0], x1 = lie.place[1], x2 = lie.place[2];
  const float p0 = lie.p[0], p1 = lie.p[1], p2 = lie.p[2], q0 = lie.q[0], q1 = lie.q[1], q2 = lie.q[2];
  const float m0 = lie.middle[0], m1 = lie.middle[1], m2 = lie.middle[2];
  const std::int32_t faces = lie.faces;
  for (std::int32_t first = 0; first < faces; first += kBlock)
    for (std::int32_t k = first; k < first + kBlock; ++k) {
      const float ax = cx[k] - x0, ay = cy[k] - x1, az = cz[k] - x2;
      const float bx = cx[k + 1] - x0, by = cy[k + 1] - x1, bz = cz[k + 1] - x2;
      from_p[k] = to_point_of(p0, p1, p2, 0, 0, 0, ax, ay, az, bx, by, bz);
      from_q[k] = to_point_of(q0, q1, q2, 0, 0, 0, ax, ay, az, bx, by, bz);
      from_middle[k] = to_point_of(m0, m1, m2, 0, 0, 0, ax, ay, az, bx, by, bz);
    }
}

VKMESH_CLONES void bound_spokes(const float* __restrict cx, const float* __restrict cy,
                                const float* __restrict cz, const Lie& lie, SpokeBounds& out) {
  float* const __restrict before = out.before.data(), * const __restrict after = out.after.data();
  const float x0 = lie.place[0], x1 = lie.place[1], x2 = lie.place[2];
  const float p0 = lie.p[0], p1 = lie.p[1], p2 = lie.p[2], q0 = lie.q[0], q1 = lie.q[1], q2 = lie.q[2];
  const std::int32_t at_p = lie.at_p, faces = lie.faces;
  for (std::int32_t first = 0; first < faces; first += kBlock)
    for (std::int32_t k = first; k < first + kBlock; ++k) {
      const float ax = cx[k] - x0, ay = cy[k] - x1, az = cz[k] - x2;
      const float bx = cx[k + 1] - x0, by = cy[k + 1] - x1, bz = cz[k + 1] - x2;
      const float ex = cx[k + 2] - x0, ey = cy[k + 2] - x1, ez = cz[k + 2] - x2;
      // The old point of this face, and that of the next.
      const bool at_q = k >= at_p, next_at_q = (k + 1 >= at_p) & (k + 1 < faces);
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
}

// What happens to the faces. Each looks at the next one too, which costs less than to hand normals
// from lane to lane.
VKMESH_CLONES std::int32_t turn_faces(const float* px, const float* py, const float* pz, const Move& move) {
  const float p0 = move.p[0], p1 = move.p[1], p2 = move.p[2];
  const float d0 = move.d[0], d1 = move.d[1], d2 = move.d[2];
  const float x0 = move.x[0], x1 = move.x[1], x2 = move.x[2];
  const float square_cos = move.cos_deviation * std::fabs(move.cos_deviation);
  constexpr float kSquareAgainst = -(kAgainst * kAgainst);
  std::int32_t found = 0;
  for (std::int32_t left = move.faces, at_p = move.at_p; left > 0; left -= kBlock, at_p -= kBlock) {
    for (std::int32_t k = 0; k < kBlock; ++k) {  // so many and no others, or g++ 12 does it one by one
      const bool at_q = k >= at_p;
      const float ox = at_q ? d0 : 0.0f, oy = at_q ? d1 : 0.0f, oz = at_q ? d2 : 0.0f;
      const float sx = px[k] - p0, sy = py[k] - p1, sz = pz[k] - p2;
      const float tx = px[k + 1] - p0, ty = py[k + 1] - p1, tz = pz[k + 1] - p2;
      const float ux = px[k + 2] - p0, uy = py[k + 2] - p1, uz = pz[k + 2] - p2;
      const Normal before(sx - ox, sy - oy, sz - oz, tx - ox, ty - oy, tz - oz);
      const Normal after(sx - x0, sy - x1, sz - x2, tx - x0, ty - x1, tz - x2);
      const Normal next(tx - x0, ty - x1, tz - x2, ux - x0, uy - x1, uz - x2);
      const float turned = before.product(after), bent = after.product(next);
      const bool far = turned * std::fabs(turned) < square_cos * (before.length2 * after.length2);
      const bool opposed = bent * std::fabs(bent) < kSquareAgainst * (after.length2 * next.length2);
      const bool is = k < left, had = before.exists(), has = after.exists();
      found |= ((is & had & (!has | far)) ? kBroken : 0) | ((is & has & !had) ? kHadNone : 0) |
               ((is & has & next.exists() & opposed) ? kOpposed : 0);
    }
    px += kBlock;
    py += kBlock;
    pz += kBlock;
  }
  return found;
}

}  // namespace

std::uint32_t FaceTurns::set(const LargeArray<CollapseVertex>& vertices,
                             std::span<const std::uint32_t> around_p,
                             std::span<const std::uint32_t> around_q) {
  at_p_ = around_p.size() - 1;
  faces_ = at_p_ + around_q.size() - 1;
  const std::size_t corners = faces_ + 2;
  // Whole blocks are copied, and four corners are turned at a time: what is beyond does not matter.
  if (ids_.size() < corners + 2 * kBlock) {
    ids_.resize(2 * corners + 4 * kBlock);
    for (Lanes* lanes : {&x_, &y_, &z_}) lanes->resize(ids_.size());
  }
  std::uint32_t* const ids = ids_.data();
  const auto copy = [](std::span<const std::uint32_t> from, std::uint32_t* to) {
    std::memcpy(to, from.data(), kBlock * sizeof(std::uint32_t));
    for (std::size_t i = kBlock; i < from.size(); i += kBlock)
      [[unlikely]] std::memcpy(to + i, from.data() + i, kBlock * sizeof(std::uint32_t));
  };
  copy(around_p, ids);
  copy(around_q, ids + at_p_);  // which begins where that of p ends
  for (std::size_t i = 0; i < 4; ++i) ids[faces_ + 1 + i] = around_p[at_p_ > 0 ? 1 : 0];
  std::uint32_t flags = 0;
  std::array<float, 4> sources;
  float *const x = x_.data(), *const y = y_.data(), *const z = z_.data();
  const CollapseVertex* const all = vertices.data();
  for (std::size_t k = 0; k < corners; k += 4) {
    std::array<const void*, 4> rows;
    for (std::size_t i = 0; i < 4; ++i) {
      const CollapseVertex& vertex = all[ids[k + i]];
      rows[i] = &vertex;
      flags |= vertex.source;
    }
    turn_four(rows, {x + k, y + k, z + k, sources.data()});
  }
  return flags;
}

bool FaceTurns::folds_over(const Vector& p, const Vector& q, const Vector& x, float cos_deviation) const {
  const Vector d = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
  const auto at_p = static_cast<std::int32_t>(at_p_), faces = static_cast<std::int32_t>(faces_);
  const std::int32_t found =
      turn_faces(x_.data(), y_.data(), z_.data(), {p, d, x, at_p, faces, cos_deviation});
  if (found == 0) return false;
  if ((found & kBroken) != 0) return true;
  if ((found & kHadNone) != 0 && disagrees(p, d, x)) return true;
  return (found & kOpposed) != 0 && more_against(p, d, x);
}

float FaceTurns::squared_distance(const Vector& p, const Vector& q, const Vector& x, float least) const {
  // All relative to p + x, where the new point lies.
  const auto half = [](const Vector& a, const Vector& b) {
    return Vector{0.5f * (a[0] + b[0]), 0.5f * (a[1] + b[1]), 0.5f * (a[2] + b[2])};
  };
  const Vector at_p = {-x[0], -x[1], -x[2]},
               at_q = {q[0] - p[0] - x[0], q[1] - p[1] - x[1], q[2] - p[2] - x[2]}, middle = half(at_p, at_q);
  const float from_p = dot(at_p, at_p), from_q = dot(at_q, at_q);
  float far = least;
  if (!(from_p > far) && !(from_q > far)) return far;
  const std::size_t some = std::min(faces_, kMostBounds);
  const Lie lie = {
      {p[0] + x[0], p[1] + x[1], p[2] + x[2]}, at_p, at_q, middle, static_cast<std::int32_t>(at_p_),
      static_cast<std::int32_t>(some)};

  // `near`: a distance that is known. The faces from `first` on are the likeliest.
  const auto to_new = [&](const Vector& point, float near, std::size_t first) {
    if (!(dot(point, point) >= 0)) return;  // it lies nowhere
    std::size_t face = first;
    for (std::size_t i = 0; i < faces_ && near > far; ++i) {
      const float d = squared_distance_to(point, {}, corner(face, p, x), corner(face + 1, p, x));
      near = d < near ? d : near;
      face = face + 1 < faces_ ? face + 1 : 0;
    }
    far = near > far ? near : far;
  };
  const auto to_old = [&](const Vector& point, float near, std::size_t first) {
    // The faces of the edge lie in the midst.
    for (const std::size_t side : {std::size_t{0}, at_p_}) {
      if (!(near > far)) break;
      const float d = squared_distance_to(point, at_p, at_q, corner(side, p, x));
      near = d < near ? d : near;
    }
    std::size_t face = first;
    for (std::size_t i = 0; i < faces_ && near > far; ++i) {
      const float d =
          squared_distance_to(point, face < at_p_ ? at_p : at_q, corner(face, p, x), corner(face + 1, p, x));
      near = d < near ? d : near;
      face = face + 1 < faces_ ? face + 1 : 0;
    }
    far = near > far ? near : far;
  };
  const auto least_of = [&](const BoundLanes& lanes, float near) {
    for (std::size_t k = 0; k < some; ++k) near = lanes[k] < near ? lanes[k] : near;
    return near;
  };
  EndBounds ends;
  bound_ends(x_.data(), y_.data(), z_.data(), lie, ends);
  to_new(at_p, least_of(ends.p, from_p), 0);
  to_new(at_q, least_of(ends.q, from_q), at_p_);
  to_new(middle, least_of(ends.middle, dot(middle, middle)), 0);
  if (far > least) return far;  // far enough for now
  SpokeBounds spokes;
  bound_spokes(x_.data(), y_.data(), z_.data(), lie, spokes);
  // Both have an edge to where their rings meet; of the one, it is the second at this corner.
  to_new(half(at_p, corner(0, p, x)), 0.25f * from_p, 0);
  to_new(half(at_q, corner(at_p_, p, x)), 0.25f * from_q, at_p_);
  for (std::size_t k = 0; k < faces_; ++k) {
    const bool known = k < some;
    if (known && !(spokes.before[k] > far) && !(spokes.after[k] > far)) continue;
    const Vector to = corner(k + 1, p, x);
    if (!(dot(to, to) >= 0)) continue;  // it lies nowhere
    const Vector& end = k < at_p_ ? at_p : at_q;
    const float near = 0.25f * dot(end, end);
    to_new(half(end, to), known ? spokes.before[k] : near, k);
    to_old(half({}, to), known ? spokes.after[k] : near, k);
  }
  return far;
}

/// The normal of a face whose third corner lies at p + x, twice its area vector over the squared sides; 0 if
/// it has no area, or is none.
FaceTurns::Vector FaceTurns::normal(std::size_t face, const Vector& p, const Vector& x) const {
  const Vector u = corner(face, p, x), v = corner(face + 1, p, x);
  const Normal n(u[0], u[1], u[2], v[0], v[1], v[2]);
  return n.exists() ? Vector{n.x / n.sides, n.y / n.sides, n.z / n.sides} : Vector{};
}

/// Whether a face that had no area and has one now looks against the others.
bool FaceTurns::disagrees(const Vector& p, const Vector& d, const Vector& x) const {
  Vector sum{};
  for (std::size_t k = 0; k < faces_; ++k) {
    const Vector third = k < at_p_ ? Vector{} : d;
    const Vector n = normal(k, p, third), u = corner(k, p, third), v = corner(k + 1, p, third);
    if (n == Vector{}) continue;
    const float sides = dot(u, u) + dot(v, v);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += sides * n[i];
  }
  for (std::size_t k = 0; k < faces_; ++k)
    if (dot(sum, normal(k, p, x)) < 0) return true;
  return false;
}

/// Whether two neighbours about the kept vertex stand more against each other than any of the faces that
/// remain did before.
bool FaceTurns::more_against(const Vector& p, const Vector& d, const Vector& x) const {
  float after = 1, before = 1;
  for (std::size_t k = 0; k < faces_; ++k) {
    after = std::min(after, cosine(normal(k, p, x), normal(k + 1, p, x)));
    // Faces of p that follow each other have an edge in common, and so have those of q.
    if (k + 1 == at_p_ || k + 1 == faces_) continue;
    const Vector third = k < at_p_ ? Vector{} : d;
    before = std::min(before, cosine(normal(k, p, third), normal(k + 1, p, third)));
  }
  return after < before;
}

}  // namespace vkmesh::detail
