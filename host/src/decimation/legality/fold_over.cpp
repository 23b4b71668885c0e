#include "decimation/legality/fold_over.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/geometric.hpp>

#include "math/vector3.h"
#include "simd/target_clones.h"

namespace vkmesh::detail {
namespace {

/// A triangle of less area than this share of its squared sides has no reliable normal.
constexpr float kDegenerate = 1e-6f;
constexpr std::int32_t kBlock = CollapseNeighbourhood::kBlock;
/// Neighbours stand against each other when the angle between their normals has a cosine below -1/2; its
/// square.
constexpr float kAgainst2 = 0.25f;

// What `look_at_faces` finds.
constexpr std::int32_t kBroken = 1;   // a face turns too far or loses its area
constexpr std::int32_t kHadNone = 2;  // a face without area gets one
constexpr std::int32_t kOpposed = 4;  // neighbours stand against each other afterwards

/// The normal of the face of corners a and b and a third at 0, twice its area over about the squared sides,
/// so that no square leaves the range of a float: over a power of two, since to divide is slow.
struct Normal {
  Vector3 n;
  float length2;
  float sides;  // the squared sides, in [1, 2) as a rule

  [[gnu::always_inline]] Normal(const Vector3& a, const Vector3& b) {
    constexpr std::uint32_t kExponent = 0x7f800000u, kTwiceBias = 0x7f000000u;
    const float squared = dot(a, a) + dot(b, b) + 1e-36f;
    const float scale =
        std::bit_cast<float>(kTwiceBias - (std::bit_cast<std::uint32_t>(squared) & kExponent));
    n = times(scale, cross(a, b));
    length2 = dot(n, n);
    sides = squared * scale;
  }

  [[nodiscard, gnu::always_inline]] bool exists() const {
    return length2 > kDegenerate * kDegenerate * (sides * sides);
  }
};

/// p, q relative to it, and the new place of both, relative to p.
struct Move {
  Vector3 p, d, x;
  std::int32_t at_p, faces;  // the faces at p come first
  float cos_deviation;
};

// Each face looks at the next one too, which costs less than to hand normals from lane to lane.
VKMESH_CLONES std::int32_t look_at_faces(const float* px, const float* py, const float* pz,
                                         const Move& move) {
  const Vector3 p = move.p, d = move.d, x = move.x;
  const float square_cos = move.cos_deviation * std::fabs(move.cos_deviation);
  std::int32_t found = 0;
  for (std::int32_t left = move.faces, at_p = move.at_p; left > 0; left -= kBlock, at_p -= kBlock) {
    for (std::int32_t k = 0; k < kBlock; ++k) {  // so many and no others, or g++ 12 does it one by one
      const bool at_q = k >= at_p;
      const Vector3 third = {at_q ? d[0] : 0.0f, at_q ? d[1] : 0.0f, at_q ? d[2] : 0.0f};
      const Vector3 a = minus({px[k], py[k], pz[k]}, p), b = minus({px[k + 1], py[k + 1], pz[k + 1]}, p),
                    c = minus({px[k + 2], py[k + 2], pz[k + 2]}, p);
      const Normal before(minus(a, third), minus(b, third)), after(minus(a, x), minus(b, x)),
          next(minus(b, x), minus(c, x));
      const float turned = dot(before.n, after.n), bent = dot(after.n, next.n);
      const bool far = turned * std::fabs(turned) < square_cos * (before.length2 * after.length2);
      const bool opposed = bent * std::fabs(bent) < -kAgainst2 * (after.length2 * next.length2);
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

/// The faces around both ends one by one.
struct Faces {
  const CollapseNeighbourhood& around;
  Vector3 p, d, x;

  [[nodiscard]] Vector3 third(std::size_t k) const { return k < around.faces_at_p() ? Vector3{} : d; }
  /// The normal of a face whose third corner lies at p + x, twice its area over the squared sides; 0 if it
  /// has no area, or is none.
  [[nodiscard]] Vector3 normal(std::size_t k, const Vector3& at) const {
    const Normal normal(around.corner(k, p, at), around.corner(k + 1, p, at));
    if (!normal.exists()) return {};
    return {normal.n[0] / normal.sides, normal.n[1] / normal.sides, normal.n[2] / normal.sides};
  }

  /// Whether a face that had no area and has one now looks against the others.
  [[nodiscard]] bool disagree() const {
    Vector3 sum{};
    for (std::size_t k = 0; k < around.faces(); ++k) {
      const Vector3 n = normal(k, third(k)), u = around.corner(k, p, third(k)),
                    v = around.corner(k + 1, p, third(k));
      if (n != Vector3{}) sum = plus(sum, times(dot(u, u) + dot(v, v), n));
    }
    for (std::size_t k = 0; k < around.faces(); ++k)
      if (dot(sum, normal(k, x)) < 0) return true;
    return false;
  }

  /// Whether two neighbours about the kept vertex stand more against each other than any of the faces that
  /// remain did before.
  [[nodiscard]] bool are_more_against() const {
    float after = 1, before = 1;
    for (std::size_t k = 0; k < around.faces(); ++k) {
      after = std::min(after, cosine(normal(k, x), normal(k + 1, x)));
      // Faces of p that follow each other have an edge in common, and so have those of q.
      if (k + 1 == around.faces_at_p() || k + 1 == around.faces()) continue;
      before = std::min(before, cosine(normal(k, third(k)), normal(k + 1, third(k))));
    }
    return after < before;
  }
};

}  // namespace

bool folds_over(const CollapseNeighbourhood& neighbourhood, const Vector3& p, const Vector3& q,
                const Vector3& x, float cos_deviation) {
  const Vector3 d = minus(q, p);
  const auto at_p = static_cast<std::int32_t>(neighbourhood.faces_at_p()),
             faces = static_cast<std::int32_t>(neighbourhood.faces());
  const std::int32_t found = look_at_faces(neighbourhood.x(), neighbourhood.y(), neighbourhood.z(),
                                           {p, d, x, at_p, faces, cos_deviation});
  if (found == 0) return false;
  if ((found & kBroken) != 0) return true;
  const Faces around{neighbourhood, p, d, x};
  if ((found & kHadNone) != 0 && around.disagree()) return true;
  return (found & kOpposed) != 0 && around.are_more_against();
}

bool folds_over(const LargeArray<VertexRecord>& vertices, std::uint32_t vertex,
                std::span<const std::uint32_t> ring, bool closed,
                std::span<const std::array<std::uint8_t, 3>> triangles) {
  constexpr std::size_t kMaxTriangles = CollapseMesh::kMaxHoleEdges;
  const std::size_t n = ring.size();
  const auto normal_of = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vector3& from = vertices[a].position;
    return cross(minus(vertices[b].position, from), minus(vertices[c].position, from));
  };
  std::array<Vector3, kMaxTriangles> normals;
  std::array<double, kMaxTriangles> squared;
  std::array<std::array<std::uint8_t, kMaxTriangles>, kMaxTriangles>
      below;  // by a new edge the triangle before it
  bool against = false;
  float after = 1;
  for (std::size_t t = closed ? 0 : 1; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    normals[t] = normal_of(ring[a], ring[b], ring[c]);
    squared[t] = static_cast<double>(dot(normals[t], normals[t]));
    below[a][b] = below[b][c] = static_cast<std::uint8_t>(t);
    if (a == 0 && c + 1u == n) continue;
    const std::size_t other = below[a][c];
    const auto along = static_cast<double>(dot(normals[t], normals[other]));
    if (along >= 0 || along * along <= static_cast<double>(kAgainst2) * squared[t] * squared[other]) continue;
    against = true;
    after = std::min(after, cosine(normals[t], normals[other]));
  }
  if (!against) return false;
  const auto face = [&](std::size_t i) { return normal_of(vertex, ring[i % n], ring[(i + 1) % n]); };
  float before = 1;
  for (std::size_t i = 0; i + (closed ? 0 : 2) < n; ++i)
    before = std::min(before, cosine(face(i), face(i + 1)));
  return after < before;
}

bool ear_stays_in_place(const DVec3& v, const DVec3& a, const DVec3& b, const DVec3& c) {
  constexpr double kLeastCosine = 0.8660254037844386;
  const auto normal = [](const DVec3& p, const DVec3& q, const DVec3& r) { return glm::cross(q - p, r - p); };
  const DVec3 ear = normal(a, b, c);
  const auto agrees = [&](const DVec3& before) {
    return glm::dot(ear, before) >= kLeastCosine * glm::length(ear) * glm::length(before);
  };
  return agrees(normal(v, a, b)) && agrees(normal(v, b, c));
}

}  // namespace vkmesh::detail
