#include "decimation/legality/fold_over.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "simd/target_clones.h"

namespace vkmesh::detail {
namespace {

using Vector = CollapseNeighbourhood::Vector;

/// A triangle of less area than this share of its squared sides has no reliable normal.
constexpr float kDegenerate = 1e-6f;
constexpr std::int32_t kBlock = CollapseNeighbourhood::kBlock;
/// Cosine of the angle at which neighbours stand against each other.
constexpr float kAgainst = -0.5f;

// What `turn` finds.
constexpr std::int32_t kBroken = 1;   // a face turns too far or loses its area
constexpr std::int32_t kHadNone = 2;  // a face without area gets one
constexpr std::int32_t kOpposed = 4;  // neighbours stand against each other afterwards

float dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Of the angle between two vectors; 1 where one has no length.
float cosine(const Vector& a, const Vector& b) {
  const float n = std::sqrt(dot(a, a)) * std::sqrt(dot(b, b));
  return n > 0 ? dot(a, b) / n : 1.0f;
}

struct Move {
  Vector p, d, x;  // q and the new place relative to p
  std::int32_t at_p, faces;
  float cos_deviation;
};

// Of the corners a and b and a third at 0, over about the squared sides, so that no square leaves the range
// of a float: a power of two, since to divide is slow. Of several faces if Float and Int have several lanes.
template <class Float, class Int>
struct Normals {
  Float x, y, z, length2;
  Float sides;  // the squared sides, in [1, 2) as a rule

  [[gnu::always_inline]] Normals(const Float& ax, const Float& ay, const Float& az, const Float& bx,
                                 const Float& by, const Float& bz) {
    constexpr std::int32_t kExponent = 0x7f800000, kTwiceBias = 0x7f000000;
    const Float squared = (ax * ax + ay * ay + az * az) + (bx * bx + by * by + bz * bz) + 1e-36f;
    Int bits;
    std::memcpy(&bits, &squared, sizeof bits);
    bits = kTwiceBias - (bits & kExponent);
    Float scale;
    std::memcpy(&scale, &bits, sizeof scale);
    x = (ay * bz - az * by) * scale;
    y = (az * bx - ax * bz) * scale;
    z = (ax * by - ay * bx) * scale;
    length2 = x * x + y * y + z * z;
    sides = squared * scale;
  }
};

struct Normal : Normals<float, std::int32_t> {
  using Normals::Normals;

  [[nodiscard, gnu::always_inline]] bool exists() const {
    return length2 > kDegenerate * kDegenerate * (sides * sides);
  }
  [[nodiscard, gnu::always_inline]] float product(const Normal& n) const {
    return x * n.x + y * n.y + z * n.z;
  }
};

constexpr float kSquareAgainst = -(kAgainst * kAgainst);

// What happens to the faces. Each looks at the next one too, which costs less than to hand normals
// from lane to lane.
VKMESH_CLONES std::int32_t turn_many(const float* px, const float* py, const float* pz, const Move& move) {
  const float p0 = move.p[0], p1 = move.p[1], p2 = move.p[2];
  const float d0 = move.d[0], d1 = move.d[1], d2 = move.d[2];
  const float x0 = move.x[0], x1 = move.x[1], x2 = move.x[2];
  const float square_cos = move.cos_deviation * std::fabs(move.cos_deviation);
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

#if defined(VKMESH_HAS_CLONES)
// Few faces are one to a lane, and lanes hand on what the one before needs, too. Next to the last is the
// first again, if p has a face.
__attribute__((target("avx512f"))) std::int32_t turn_faces(const float* px, const float* py, const float* pz,
                                                           const Move& move) {
  using Floats = float __attribute__((vector_size(64)));
  using Ints = std::int32_t __attribute__((vector_size(64)));
  constexpr std::int32_t kLanes = 16;
  if (move.faces > kLanes || move.at_p == 0) [[unlikely]]
    return turn_many(px, py, pz, move);
  constexpr Ints kLane = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const Ints next = kLane + 1 < move.faces ? kLane + 1 : Ints{};
  const auto is = kLane < move.faces;
  const auto at_q = kLane >= move.at_p;
  Floats sx, sy, sz;
  __builtin_memcpy(&sx, px, sizeof sx);
  __builtin_memcpy(&sy, py, sizeof sy);
  __builtin_memcpy(&sz, pz, sizeof sz);
  sx -= move.p[0];
  sy -= move.p[1];
  sz -= move.p[2];
  const Floats tx = __builtin_shuffle(sx, next), ty = __builtin_shuffle(sy, next),
               tz = __builtin_shuffle(sz, next);
  const float x0 = move.x[0], x1 = move.x[1], x2 = move.x[2];
  const Normals<Floats, Ints> after(sx - x0, sy - x1, sz - x2, tx - x0, ty - x1, tz - x2);
  const Floats none{};
  const Floats ox = at_q ? none + move.d[0] : none, oy = at_q ? none + move.d[1] : none,
               oz = at_q ? none + move.d[2] : none;
  const Normals<Floats, Ints> before(sx - ox, sy - oy, sz - oz, tx - ox, ty - oy, tz - oz);
  const Floats turned = before.x * after.x + before.y * after.y + before.z * after.z;
  const Floats bent = after.x * __builtin_shuffle(after.x, next) +
                      after.y * __builtin_shuffle(after.y, next) + after.z * __builtin_shuffle(after.z, next);
  const float square_cos = move.cos_deviation * std::fabs(move.cos_deviation);
  constexpr float kSquare = kDegenerate * kDegenerate;
  const Floats square_turned = turned * (turned < 0 ? -turned : turned),
               square_bent = bent * (bent < 0 ? -bent : bent);
  const Ints far = square_turned < square_cos * (before.length2 * after.length2);
  const Ints opposed =
      square_bent < kSquareAgainst * (after.length2 * __builtin_shuffle(after.length2, next));
  const Ints had = is & (before.length2 > kSquare * (before.sides * before.sides)),
             has = is & (after.length2 > kSquare * (after.sides * after.sides));
  const Ints found = ((had & (~has | far)) & kBroken) | ((has & ~had) & kHadNone) |
                     ((has & __builtin_shuffle(has, next) & opposed) & kOpposed);
  const auto eight = __builtin_shufflevector(found, found, 0, 1, 2, 3, 4, 5, 6, 7) |
                     __builtin_shufflevector(found, found, 8, 9, 10, 11, 12, 13, 14, 15);
  const auto four =
      __builtin_shufflevector(eight, eight, 0, 1, 2, 3) | __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
  using Longs = std::uint64_t __attribute__((vector_size(16)));
  const auto two = reinterpret_cast<Longs>(four);
  const std::uint64_t all = two[0] | two[1];
  return static_cast<std::int32_t>(all | all >> 32);
}

__attribute__((target("default")))
#endif
std::int32_t
turn_faces(const float* px, const float* py, const float* pz, const Move& move) {
  return turn_many(px, py, pz, move);
}

// The normal of a face whose third corner lies at p + x, twice its area vector over the squared sides; 0 if
// it has no area, or is none.
Vector normal(const CollapseNeighbourhood& around, std::size_t face, const Vector& p, const Vector& x) {
  const Vector u = around.corner(face, p, x), v = around.corner(face + 1, p, x);
  const Normal n(u[0], u[1], u[2], v[0], v[1], v[2]);
  return n.exists() ? Vector{n.x / n.sides, n.y / n.sides, n.z / n.sides} : Vector{};
}

// Whether a face that had no area and has one now looks against the others.
bool disagrees(const CollapseNeighbourhood& around, const Vector& p, const Vector& d, const Vector& x) {
  Vector sum{};
  for (std::size_t k = 0; k < around.faces(); ++k) {
    const Vector third = k < around.faces_at_p() ? Vector{} : d;
    const Vector n = normal(around, k, p, third), u = around.corner(k, p, third),
                 v = around.corner(k + 1, p, third);
    if (n == Vector{}) continue;
    const float sides = dot(u, u) + dot(v, v);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += sides * n[i];
  }
  for (std::size_t k = 0; k < around.faces(); ++k)
    if (dot(sum, normal(around, k, p, x)) < 0) return true;
  return false;
}

// Whether two neighbours about the kept vertex stand more against each other than any of the faces that
// remain did before.
bool more_against(const CollapseNeighbourhood& around, const Vector& p, const Vector& d, const Vector& x) {
  float after = 1, before = 1;
  for (std::size_t k = 0; k < around.faces(); ++k) {
    after = std::min(after, cosine(normal(around, k, p, x), normal(around, k + 1, p, x)));
    // Faces of p that follow each other have an edge in common, and so have those of q.
    if (k + 1 == around.faces_at_p() || k + 1 == around.faces()) continue;
    const Vector third = k < around.faces_at_p() ? Vector{} : d;
    before = std::min(before, cosine(normal(around, k, p, third), normal(around, k + 1, p, third)));
  }
  return after < before;
}

}  // namespace

bool folds_over(const CollapseNeighbourhood& around, const Vector& p, const Vector& q, const Vector& x,
                float cos_deviation) {
  const Vector d = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
  const auto at_p = static_cast<std::int32_t>(around.faces_at_p()),
             faces = static_cast<std::int32_t>(around.faces());
  const std::int32_t found =
      turn_faces(around.x(), around.y(), around.z(), {p, d, x, at_p, faces, cos_deviation});
  if (found == 0) return false;
  if ((found & kBroken) != 0) return true;
  if ((found & kHadNone) != 0 && disagrees(around, p, d, x)) return true;
  return (found & kOpposed) != 0 && more_against(around, p, d, x);
}

}  // namespace vkmesh::detail
