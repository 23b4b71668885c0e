#include "decimation/face_turns.h"

#include <algorithm>
#include <cmath>

#include "passes/clones.h"

namespace vkmesh::detail {
namespace {

/// A triangle of less area than this share of its squared sides has no reliable normal.
constexpr float kDegenerate = 1e-6f;
/// Cosine of the angle at which neighbours stand against each other.
constexpr float kAgainst = -0.5f;

// What `turn` finds.
constexpr unsigned kBroken = 1;   // a face turns too far or loses its area
constexpr unsigned kHadNone = 2;  // a face without area gets one
constexpr unsigned kOpposed = 4;  // neighbours stand against each other afterwards

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

// Of the faces [0, faces] and on to the end of the block.
VKMESH_CLONES std::int32_t turn_faces(const float* px, const float* py, const float* pz, float* __restrict ax,
                                      float* __restrict ay, float* __restrict az, float* __restrict length2,
                                      const Move& move, std::int32_t padded) {
  constexpr auto kLeast = kDegenerate * kDegenerate;
  const float p0 = move.p[0], p1 = move.p[1], p2 = move.p[2];
  const float d0 = move.d[0], d1 = move.d[1], d2 = move.d[2];
  const float x0 = move.x[0], x1 = move.x[1], x2 = move.x[2];
  const std::int32_t at_p = move.at_p, faces = move.faces;
  const float square_cos = move.cos_deviation * std::fabs(move.cos_deviation);
  std::int32_t found = 0;
  for (std::int32_t k = 0; k < padded; ++k) {
    const bool at_q = (k >= at_p) & (k < faces);
    const float ox = at_q ? d0 : 0.0f, oy = at_q ? d1 : 0.0f, oz = at_q ? d2 : 0.0f;
    const float sx = px[k] - p0, sy = py[k] - p1, sz = pz[k] - p2;
    const float tx = px[k + 1] - p0, ty = py[k + 1] - p1, tz = pz[k + 1] - p2;
    const float ux = sx - ox, uy = sy - oy, uz = sz - oz;
    const float vx = tx - ox, vy = ty - oy, vz = tz - oz;
    const float nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const float fx = sx - x0, fy = sy - x1, fz = sz - x2;
    const float gx = tx - x0, gy = ty - x1, gz = tz - x2;
    const float mx = fy * gz - fz * gy, my = fz * gx - fx * gz, mz = fx * gy - fy * gx;
    // Over the squared sides, so that no square below leaves the range of a float.
    const float before = 1.0f / ((ux * ux + uy * uy + uz * uz) + (vx * vx + vy * vy + vz * vz) + 1e-36f);
    const float after = 1.0f / ((fx * fx + fy * fy + fz * fz) + (gx * gx + gy * gy + gz * gz) + 1e-36f);
    const float b0 = nx * before, b1 = ny * before, b2 = nz * before;
    const float a0 = mx * after, a1 = my * after, a2 = mz * after;
    const float n2 = b0 * b0 + b1 * b1 + b2 * b2, m2 = a0 * a0 + a1 * a1 + a2 * a2;
    const float product = b0 * a0 + b1 * a1 + b2 * a2;
    const bool had = n2 > kLeast, has = m2 > kLeast;
    const bool far = product * std::fabs(product) < square_cos * (n2 * m2);
    const std::int32_t broken = (had & (!has | far)) ? 1 : 0, none = (has & !had) ? 2 : 0;
    found |= broken | none;
    ax[k] = has ? a0 : 0.0f;
    ay[k] = has ? a1 : 0.0f;
    az[k] = has ? a2 : 0.0f;
    length2[k] = has ? m2 : 0.0f;
  }
  return found;
}

VKMESH_CLONES std::int32_t opposed(const float* ax, const float* ay, const float* az, const float* length2,
                                   std::int32_t padded) {
  std::int32_t found = 0;
  for (std::int32_t k = 0; k < padded; ++k) {
    const float product = ax[k] * ax[k + 1] + ay[k] * ay[k + 1] + az[k] * az[k + 1];
    const float bound = kAgainst * std::fabs(kAgainst) * (length2[k] * length2[k + 1]);
    found |= product * std::fabs(product) < bound ? 4 : 0;
  }
  return found;
}

}  // namespace

std::uint32_t FaceTurns::set(const LargeArray<CollapseVertex>& vertices,
                             std::span<const std::uint32_t> around_p,
                             std::span<const std::uint32_t> around_q) {
  at_p_ = around_p.size() - 1;
  faces_ = at_p_ + around_q.size() - 1;
  // A corner more than faces, the first face again, and one beyond the last block.
  const std::size_t padded = faces_ / kBlock * kBlock + kBlock;
  if (x_.size() < padded + 1)
    for (Lanes* lanes : {&x_, &y_, &z_, &ax_, &ay_, &az_, &length2_}) lanes->resize(padded + 2 * kBlock);
  std::uint32_t flags = 0;
  std::size_t k = 0;
  const auto add = [&](std::uint32_t v) {
    const CollapseVertex& vertex = vertices[v];
    x_[k] = vertex.position[0];
    y_[k] = vertex.position[1];
    z_[k] = vertex.position[2];
    flags |= vertex.source;
    ++k;
  };
  for (const std::uint32_t v : around_p) add(v);
  for (const std::uint32_t v : around_q.subspan(1)) add(v);
  add(around_p[around_p.size() > 1 ? 1 : 0]);
  for (Lanes* lanes : {&x_, &y_, &z_}) {
    float* const l = lanes->data();
    std::fill(l + k, l + padded + 1, l[k - 1]);
  }
  return flags;
}

bool FaceTurns::folds_over(const Vector& p, const Vector& q, const Vector& x, float cos_deviation) {
  const Vector d = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
  const unsigned found = turn(p, d, x, cos_deviation);
  if (found == 0) return false;
  if ((found & kBroken) != 0) return true;
  if ((found & kHadNone) != 0 && disagrees(p, d)) return true;
  return (found & kOpposed) != 0 && more_against(p, d);
}

unsigned FaceTurns::turn(const Vector& p, const Vector& d, const Vector& x, float cos_deviation) {
  const auto at_p = static_cast<std::int32_t>(at_p_), faces = static_cast<std::int32_t>(faces_);
  constexpr auto kLanes = static_cast<std::int32_t>(kBlock);
  const std::int32_t padded = faces / kLanes * kLanes + kLanes;
  const auto end = static_cast<std::size_t>(padded);
  std::int32_t found = turn_faces(x_.data(), y_.data(), z_.data(), ax_.data(), ay_.data(), az_.data(),
                                  length2_.data(), {p, d, x, at_p, faces, cos_deviation}, padded);
  ax_[end] = ay_[end] = az_[end] = length2_[end] = 0;
  found |= opposed(ax_.data(), ay_.data(), az_.data(), length2_.data(), padded);
  return static_cast<unsigned>(found);
}

/// Twice the area vector that a face has while p and q are where they are.
FaceTurns::Vector FaceTurns::area_before(std::size_t face, const Vector& p, const Vector& d) const {
  Vector u = corner(face, p), v = corner(face + 1, p);
  if (face >= at_p_)
    for (std::size_t i = 0; i < 3; ++i) {
      u[i] -= d[i];
      v[i] -= d[i];
    }
  const Vector n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return std::isnan(n[0] + n[1] + n[2]) ? Vector{} : n;  // at the apex there is no face
}

/// Whether a face that had no area and has one now looks against the others.
bool FaceTurns::disagrees(const Vector& p, const Vector& d) const {
  Vector sum{};
  for (std::size_t k = 0; k < faces_; ++k) {
    const Vector n = area_before(k, p, d);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += n[i];
  }
  for (std::size_t k = 0; k < faces_; ++k)
    if (dot(sum, {ax_[k], ay_[k], az_[k]}) < 0) return true;
  return false;
}

/// Whether two neighbours about the kept vertex stand more against each other than any of the faces that
/// remain did before.
bool FaceTurns::more_against(const Vector& p, const Vector& d) const {
  float after = 1, before = 1;
  for (std::size_t k = 0; k < faces_; ++k) {
    after = std::min(after, cosine({ax_[k], ay_[k], az_[k]}, {ax_[k + 1], ay_[k + 1], az_[k + 1]}));
    // Faces of p that follow each other have an edge in common, and so have those of q.
    if (k + 1 != at_p_ && k + 1 != faces_)
      before = std::min(before, cosine(area_before(k, p, d), area_before(k + 1, p, d)));
  }
  return after < before;
}

}  // namespace vkmesh::detail
