#include "decimation/face_turns.h"

#include <algorithm>
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

struct Move {
  std::array<float, 3> p, d, x;  // q and the new place relative to p
  std::int32_t at_p, faces;
  float cos_deviation;
};

// Of the corners a and b and a third at 0, over the squared sides, so that no square leaves the range of a
// float.
struct Normal {
  float x, y, z, length2;

  [[gnu::always_inline]] Normal(float ax, float ay, float az, float bx, float by, float bz) {
    const float sides = 1.0f / ((ax * ax + ay * ay + az * az) + (bx * bx + by * by + bz * bz) + 1e-36f);
    x = (ay * bz - az * by) * sides;
    y = (az * bx - ax * bz) * sides;
    z = (ax * by - ay * bx) * sides;
    length2 = x * x + y * y + z * z;
  }
  [[nodiscard, gnu::always_inline]] bool exists() const { return length2 > kDegenerate * kDegenerate; }
  [[nodiscard, gnu::always_inline]] float product(const Normal& n) const {
    return x * n.x + y * n.y + z * n.z;
  }
};

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

/// The normal of a face whose third corner lies at p + x, twice its area vector over the squared sides; 0 if
/// it has no area, or is none.
FaceTurns::Vector FaceTurns::normal(std::size_t face, const Vector& p, const Vector& x) const {
  const Vector u = corner(face, p, x), v = corner(face + 1, p, x);
  const Normal n(u[0], u[1], u[2], v[0], v[1], v[2]);
  return n.exists() ? Vector{n.x, n.y, n.z} : Vector{};
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
