#include "remesh/deviation_bound.h"

#include <algorithm>
#include <limits>

#include "math/triangle_distance.h"

namespace vkmesh::detail {
namespace {

/// Valleys are nearer to what passes over them than that is to their walls: the middles of edges are samples
/// where faces meet at more than 10 degrees.
constexpr double kCosBent = 0.984807753012208;

}  // namespace

DeviationBound::DeviationBound(const OriginalSurface& surface, double most)
    : surface_(surface),
      most2_(kAtSamples * most * (kAtSamples * most)),
      first_(surface.mesh().face_count(), kNone) {
  const HalfEdgeMesh& mesh = surface.mesh();
  const auto add = [&](const DVec3& p, std::uint32_t face) {
    points_.push_back(p);
    next_.push_back(first_[face]);
    first_[face] = static_cast<std::uint32_t>(points_.size() - 1);
  };
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    if (const std::uint32_t h = mesh.leadings()[v]; h != kInvalid) add(surface.position(v), h / 3);
  mesh.for_each_edge([&](HalfEdgeId h) {
    const HalfEdgeId t = mesh.twin(h);
    if (!t.valid()) return;
    const DVec3 n = surface.normal(h.index / 3), m = surface.normal(t.index / 3);
    const double both = glm::dot(n, m);
    if (both > 0 && both * both >= kCosBent * kCosBent * glm::dot(n, n) * glm::dot(m, m)) return;
    add(0.5 * (surface.position(mesh.origin(h).index) + surface.position(mesh.target(h).index)), h.index / 3);
  });
}

bool DeviationBound::allows(std::span<const std::uint32_t> gone, std::span<const Face> made) {
  gone_.assign(gone.begin(), gone.end());
  samples_.clear();
  faces_of_samples_.clear();
  for (const std::uint32_t f : gone)
    for (std::uint32_t s = f < first_.size() ? first_[f] : kNone; s != kNone; s = next_[s])
      samples_.push_back(s);
  // The last face of a corner that goes must not take a sample with it.
  if (made.empty()) return samples_.empty();
  bool allowed = true;
  for (const std::uint32_t s : samples_) {
    const DVec3& p = points_[s];
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t nearest = made.front().number;
    for (const Face& face : made) {
      const double distance2 = squared_distance(p, face.corners);
      if (!(distance2 < least)) continue;
      least = distance2;
      nearest = face.number;
    }
    allowed = allowed && least <= most2_;
    faces_of_samples_.push_back(nearest);
  }
  if (!allowed) return false;
  return std::ranges::all_of(made, [&](const Face& face) {
    const DVec3 &a = face.corners[0], &b = face.corners[1];
    return is_near(0.5 * (a + b), face.near) && is_near(0.25 * a + 0.75 * b, face.near) &&
           is_near(0.75 * a + 0.25 * b, face.near);
  });
}

void DeviationBound::replace() {
  for (const std::uint32_t f : gone_)
    if (f < first_.size()) first_[f] = kNone;
  for (std::size_t i = 0; i < faces_of_samples_.size(); ++i) {
    const std::uint32_t f = faces_of_samples_[i];
    if (f >= first_.size()) first_.resize(std::max<std::size_t>(f + 1, first_.size() * 2), kNone);
    next_[samples_[i]] = first_[f];
    first_[f] = samples_[i];
  }
}

}  // namespace vkmesh::detail
