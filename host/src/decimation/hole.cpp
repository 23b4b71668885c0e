#include "decimation/hole.h"

#include <algorithm>
#include <cmath>

namespace vkmesh::detail {
namespace {

using Vector = Hole::Vector;

/// A triangle of less area than this share of its squared sides has no reliable normal; as in FaceTurns.
constexpr float kDegenerate = 1e-6f;
/// What a new edge counts, for each unit of v's area and of its squared length: it decides where the ground
/// is as good as flat.
constexpr float kOfLength = 1e-7f;
/// Least cosine between a new face and the normal along which all is seen: steeper ones have no reliable
/// height.
constexpr float kSteepest = 0.05f;
/// Heights that are less than this share of the distance to the farthest neighbour may be rounding, and are
/// 0.
constexpr float kRounding = 1.0f / (1 << 21);
constexpr float kAgainst = -0.5f;
constexpr float kNone = std::numeric_limits<float>::infinity();

float dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
float distance2(const Vector& a, const Vector& b) {
  const Vector d = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return dot(d, d);
}
float cosine(const Vector& a, const Vector& b) {
  const float lengths = std::sqrt(dot(a, a)) * std::sqrt(dot(b, b));
  return lengths > 0 ? dot(a, b) / lengths : 1.0f;
}

}  // namespace

float QuadricAt::at(const Vector& x) const {
  const float ax = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
  const float ay = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
  const float az = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
  return std::max(c + x[0] * (ax + 2 * b[0]) + x[1] * (ay + 2 * b[1]) + x[2] * (az + 2 * b[2]), 0.0f);
}

/// Twice the area vector of the face between neighbour i and the one after it.
Vector Hole::face(std::size_t i) const {
  if (i + 1 < size_) return cross_[i][i + 1];
  const Vector& x = cross_[0][i];
  return {-x[0], -x[1], -x[2]};
}

bool Hole::set(std::span<const Vector> ring, bool closed) {
  size_ = ring.size();
  closed_ = closed;
  std::copy(ring.begin(), ring.end(), ring_.begin());
  std::fill_n(forbidden_.begin(), size_, 0u);
  const std::size_t faces = closed ? size_ : size_ - 1;
  for (std::size_t i = 0; i < size_; ++i)
    for (std::size_t j = i + 1; j < size_; ++j) cross_[i][j] = cross(ring_[i], ring_[j]);
  Vector sum{};
  for (std::size_t i = 0; i < faces; ++i)
    for (std::size_t k = 0; k < 3; ++k) sum[k] += face(i)[k];
  const float length = std::sqrt(dot(sum, sum));
  if (!(length > 0)) return false;
  for (std::size_t k = 0; k < 3; ++k) up_direction_[k] = sum[k] / length;

  for (std::size_t i = 0; i < size_; ++i) {
    height_[i] = dot(up_direction_, ring_[i]);
    for (std::size_t j = i + 1; j < size_; ++j) up_[i][j] = dot(up_direction_, cross_[i][j]);
  }
  float farthest2 = 0;
  for (std::size_t i = 0; i < size_; ++i) farthest2 = std::max(farthest2, dot(ring_[i], ring_[i]));
  rounding_ = kRounding * std::sqrt(farthest2);
  area_ = 0;
  std::fill_n(spoke_.begin(), size_, 0.0f);
  bool beyond = false;  // more than half a turn from the first
  for (std::size_t i = 0; i < faces; ++i) {
    const std::size_t j = i + 1 < size_ ? i + 1 : 0;
    const Vector n = face(i);
    const float twice = std::sqrt(dot(n, n)), sides = dot(ring_[i], ring_[i]) + dot(ring_[j], ring_[j]);
    if (up(i, j) < -kDegenerate * sides) return false;
    if (i > 0) {
      if (beyond && up_[0][i] > 0) return false;  // around more than once
      beyond = beyond || up_[0][i] < 0;
    }
    area_ += 0.5f * twice;
    spoke_[i] += 0.25f * twice;
    spoke_[j] += 0.25f * twice;
  }
  return !(beyond && !closed && up_[0][size_ - 1] > 0);
}

Vector Hole::normal(std::size_t i, std::size_t l, std::size_t j) const {
  const Vector &a = cross_[i][l], &b = cross_[l][j], &c = cross_[i][j];
  return {a[0] + b[0] - c[0], a[1] + b[1] - c[1], a[2] + b[2] - c[2]};
}

bool Hole::is_legal(std::size_t i, std::size_t l, std::size_t j, float cos_deviation) const {
  const Vector n = normal(i, l, j);
  const float length = std::sqrt(dot(n, n)), up = up_[i][l] + up_[l][j] - up_[i][j];
  const float sides = distance2(ring_[i], ring_[l]) + distance2(ring_[l], ring_[j]);
  const bool has_area = length > kDegenerate * sides;
  if (has_area && up < kSteepest * length) return false;
  bool had_none = false;
  const auto turns = [&](std::size_t edge, std::size_t next) {
    const Vector before = face(edge);
    const float size = std::sqrt(dot(before, before));
    if (size > kDegenerate * (dot(ring_[edge], ring_[edge]) + dot(ring_[next], ring_[next])))
      return has_area && dot(n, before) < cos_deviation * (length * size);
    had_none = true;
    return false;
  };
  if (l == i + 1 && turns(i, l)) return false;
  if (j == l + 1 && turns(l, j)) return false;
  if (closed_ && i == 0 && j + 1 == size_ && turns(j, i)) return false;
  return has_area || had_none;
}

float Hole::error_at_v(std::size_t i, std::size_t l, std::size_t j) const {
  const float up = up_[i][l] + up_[l][j] - up_[i][j];
  const float z = (up_[l][j] * height_[i] - up_[i][j] * height_[l] + up_[i][l] * height_[j]) / up;
  if (std::fabs(z) <= rounding_) return along0_;
  return std::max(along0_ + z * (2 * along1_ + z * along2_), 0.0f);
}

float Hole::edge_error(std::size_t i, std::size_t j) const {
  const bool inner = up_[i][j] > 0;  // v lies on its left: the neighbours between i and j on its right
  const std::size_t a = inner ? i : j, b = inner ? j : i;
  const float across = inner ? up_[i][j] : -up_[i][j];
  float error = 0;
  const auto cross = [&](std::size_t s) {
    const float as = up(a, s), whole = as + up(s, b);
    if (!(whole > across)) return;
    const float u = as / whole, t = across / whole;
    const float dz = t * height_[s] - (height_[a] + u * (height_[b] - height_[a]));
    error += std::fabs(dz) <= rounding_ ? 0.0f : spoke_[s] * (dz * dz);
  };
  if (!(across > 0)) return 0;
  if (inner) {
    for (std::size_t s = i + 1; s < j; ++s) cross(s);
  } else {
    for (std::size_t s = j + 1; s < size_; ++s) cross(s);
    for (std::size_t s = 0; s < i; ++s) cross(s);
  }
  return error;
}

bool Hole::fill(const QuadricAt& quadric, float cos_deviation) {
  const std::size_t n = size_;
  const auto& a = quadric.a;
  const Vector& u = up_direction_;
  along0_ = quadric.c;
  along1_ = dot(quadric.b, u);
  along2_ = u[0] * (a[0] * u[0] + 2 * (a[1] * u[1] + a[2] * u[2])) + u[1] * (a[3] * u[1] + 2 * a[4] * u[2]) +
            a[5] * u[2] * u[2];
  for (std::size_t i = 0; i + 1 < n; ++i) best_[i][i + 1] = 0;
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      float least = kNone;
      std::size_t apex = 0;
      if ((forbidden_[i] >> j & 1u) == 0)
        for (std::size_t l = i + 1; l < j; ++l) {
          float sum = best_[i][l] + best_[l][j];
          if (!(sum < least) || !is_legal(i, l, j, cos_deviation)) continue;
          if (contains_v(i, l, j)) sum += error_at_v(i, l, j);
          if (!(sum < least)) continue;
          least = sum;
          apex = l;
        }
      if (is_new(i, j) && least < kNone)
        least += edge_error(i, j) + kOfLength * area_ * distance2(ring_[i], ring_[j]);
      best_[i][j] = least;
      apex_[i][j] = static_cast<std::uint8_t>(apex);
    }
  if (!(best_[0][n - 1] < kNone)) return false;
  take_triangles();
  find_heirs(quadric);
  return true;
}

/// The triangles of the best triangulation, and the errors of its edges.
void Hole::take_triangles() {
  count_ = 0;
  error_ = 0;
  std::array<std::array<std::uint8_t, 2>, kMost> parts;
  std::size_t left = 0;
  parts[left++] = {0, static_cast<std::uint8_t>(size_ - 1)};
  while (left > 0) {
    const auto [i, j] = parts[--left];
    if (is_new(i, j)) error_ += edge_error(i, j);
    if (j == i + 1) continue;
    const std::uint8_t l = apex_[i][j];
    triangles_[count_++] = {i, l, j};
    parts[left++] = {i, l};
    parts[left++] = {l, j};
  }
}

/// Of v, and the error there.
void Hole::find_heirs(const QuadricAt& quadric) {
  const std::size_t n = size_;
  const auto take = [&](std::size_t neighbour, float share) {
    if (share > 0) heirs_[heir_count_++] = {static_cast<std::uint8_t>(neighbour), share};
  };
  heir_count_ = 0;
  if (!closed_ && up_[0][n - 1] >= 0) {  // the nearest point of the new boundary edge
    const Vector &p = ring_[0], &q = ring_[n - 1], d = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const float length2 = dot(d, d);
    const float t = length2 > 0 ? std::clamp(-dot(p, d) / length2, 0.0f, 1.0f) : 0.0f;
    take(0, 1 - t);
    take(n - 1, t);
    error_ += quadric.at({p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]});
    return;
  }
  for (const auto [i, l, j] : triangles()) {
    if (!contains_v(i, l, j)) continue;
    const float up = up_[i][l] + up_[l][j] - up_[i][j];
    take(i, up_[l][j] / up);
    take(l, -up_[i][j] / up);
    take(j, up_[i][l] / up);
    error_ += error_at_v(i, l, j);
    return;
  }
  // v lies on a neighbour.
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < n; ++i)
    if (dot(ring_[i], ring_[i]) < dot(ring_[nearest], ring_[nearest])) nearest = i;
  take(nearest, 1);
  error_ += quadric.at(ring_[nearest]);
}

bool Hole::folds_over() const {
  float before = 1, after = 1;
  for (std::size_t i = 0; i + 1 < (closed_ ? size_ + 1 : size_ - 1); ++i)
    before = std::min(before, cosine(face(i % size_), face((i + 1) % size_)));
  const auto of = [&](const Triangle& t) { return normal(t[0], t[1], t[2]); };
  const auto in = [](const Triangle& t, std::uint8_t i) { return t[0] == i || t[1] == i || t[2] == i; };
  for (std::size_t s = 0; s < count_; ++s)
    for (std::size_t t = 0; t < s; ++t) {
      const auto& [i, l, j] = triangles_[s];
      const Triangle& other = triangles_[t];
      const int common = (in(other, i) ? 1 : 0) + (in(other, l) ? 1 : 0) + (in(other, j) ? 1 : 0);
      if (common == 2) after = std::min(after, cosine(of(triangles_[s]), of(other)));
    }
  return after < kAgainst && after < before;
}

}  // namespace vkmesh::detail
