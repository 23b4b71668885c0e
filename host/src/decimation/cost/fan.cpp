#include "decimation/cost/fan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace vkmesh::detail {
namespace {

using Vector = std::array<double, 3>;

/// A triangle of less area than this share of its squared sides has no reliable normal; as in folds_over.
constexpr double kDegenerate = 1e-6;
/// As in retriangulate().
constexpr double kSliver = 1e-4, kThinner = 10;

Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The triangle from 0 to a and b.
struct Face {
  Vector normal;  // twice the area vector
  double shape;   // its length over the squared sides

  Face(const Vector& a, const Vector& b) : normal(cross(a, b)) {
    const double sides = dot(a, a) + dot(b, b);
    shape = sides > 0 ? std::sqrt(dot(normal, normal)) / sides : 0.0;
  }
};

/// The hole of a lane, its corners relative to v.
struct Hole {
  std::array<Vector, RetriangulationBatch::kMaxNeighbours> ring;
  std::size_t n;
  bool closed;
  double cos_deviation;
  Vector up{};  // sum of the area vectors of v's faces

  /// The face of v between a neighbour and the next may become that of `heir`: it turns no farther than that,
  /// and keeps its area; one that had none looks up.
  [[nodiscard]] bool may_turn(std::size_t i, std::size_t heir) const {
    const Vector &a = ring[i], &b = ring[(i + 1) % n];
    const Face before(a, b), after(minus(a, ring[heir]), minus(b, ring[heir]));
    if (!(before.shape > kDegenerate)) return !(after.shape > kDegenerate) || dot(after.normal, up) > 0;
    if (!(after.shape > kDegenerate)) return false;
    if (!(after.shape > kSliver) && after.shape * kThinner < before.shape) return false;
    const Vector &from = before.normal, &to = after.normal;
    return dot(from, to) >= cos_deviation * std::sqrt(dot(from, from) * dot(to, to));
  }
};

bool is_barred(const RetriangulationBatch& batch, std::size_t a, std::size_t b, std::size_t lane) {
  return batch.barred[RetriangulationBatch::pair(std::min(a, b), std::max(a, b))][lane] > 0;
}

/// Whether the fan of that neighbour may be made.
bool is_legal(const RetriangulationBatch& batch, const Hole& hole, std::size_t heir, std::size_t lane) {
  for (std::size_t i = 0; i < hole.n; ++i) {
    if (i == heir) continue;
    const std::size_t next = (i + 1) % hole.n;
    const bool is_face = next != heir && (hole.closed || next > 0);
    if (is_face && !hole.may_turn(i, heir)) return false;
    const std::size_t away = std::max(i, heir) - std::min(i, heir);
    const bool is_side = away == 1 || (hole.closed && away + 1 == hole.n);
    if (!is_side && is_barred(batch, i, heir, lane)) return false;
  }
  return true;
}

double quadric_at(const RetriangulationBatch& batch, const Vector& x, std::size_t lane) {
  const auto a = [&](std::size_t k) { return static_cast<double>(batch.a[k][lane]); };
  const auto b = [&](std::size_t k) { return static_cast<double>(batch.b[k][lane]); };
  const double q = x[0] * (a(0) * x[0] + 2 * (a(1) * x[1] + a(2) * x[2] + b(0))) +
                   x[1] * (a(3) * x[1] + 2 * (a(4) * x[2] + b(1))) + x[2] * (a(5) * x[2] + 2 * b(2)) +
                   static_cast<double>(batch.c[lane]);
  return std::max(q, 0.0);
}

/// What attributes add where that neighbour takes over all.
float of_attributes(const RetriangulationAttributes* attributes, std::size_t heir, std::size_t lane) {
  if (attributes == nullptr) return 0;
  const auto& [one, other] = attributes->receiver[heir];
  return one[lane] + (attributes->split[lane] != 0 ? other[lane] : 0.0f);
}

}  // namespace

void fill_with_fan(RetriangulationBatch& batch, std::size_t neighbours, std::size_t lane, float cos_deviation,
                   RetriangulationAttributes* attributes) {
  if (neighbours < 3) return;
  Hole hole{{}, neighbours, batch.closed[lane] > 0, static_cast<double>(cos_deviation), {}};
  for (std::size_t i = 0; i < neighbours; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      hole.ring[i][k] = static_cast<double>(batch.ring[i][k][lane]) - static_cast<double>(batch.v[k][lane]);
  for (std::size_t i = 0; i + (hole.closed ? 0 : 1) < neighbours; ++i) {
    const Vector face = cross(hole.ring[i], hole.ring[(i + 1) % neighbours]);
    for (std::size_t k = 0; k < 3; ++k) hole.up[k] += face[k];
  }
  const bool split = attributes != nullptr && attributes->split[lane] != 0;
  const std::size_t last = split ? static_cast<std::size_t>(attributes->last[lane]) : neighbours - 1;
  float least = RetriangulationBatch::kNone;
  for (std::size_t heir = 0; heir < neighbours; ++heir) {
    if ((split || !hole.closed) && heir != 0 && heir != last) continue;
    const auto error = static_cast<float>(quadric_at(batch, hole.ring[heir], lane));
    const float more = of_attributes(attributes, heir, lane);
    if (!(error + more < least) || !is_legal(batch, hole, heir, lane)) continue;
    least = error + more;
    batch.error[lane] = error;
    batch.heir[lane] = static_cast<std::int32_t>(heir);
    if (attributes != nullptr) attributes->error[lane] = more;
  }
  if (batch.heir[lane] < 0) return;
  const auto heir = static_cast<std::size_t>(batch.heir[lane]);
  const auto set = [&](std::size_t a, std::size_t c, std::size_t third) {
    batch.third[RetriangulationBatch::pair(a, c)][lane] = static_cast<std::int32_t>(third);
  };
  if (heir > 0 && heir + 1 < neighbours) set(0, neighbours - 1, heir);
  for (std::size_t a = 0; a + 1 < heir; ++a) set(a, heir, a + 1);
  for (std::size_t c = neighbours - 1; c > heir + 1; --c) set(heir, c, c - 1);
}

}  // namespace vkmesh::detail
