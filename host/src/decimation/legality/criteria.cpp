#include "decimation/legality/criteria.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <glm/geometric.hpp>

namespace vkmesh::detail {
namespace {

DVec3 area_vector(const Triangle& t) {
  return glm::cross(t[1] - t[0], t[2] - t[0]);
}

/// 0 of a triangle without area.
DVec3 unit_normal(const Triangle& t) {
  const DVec3 n = area_vector(t);
  const double length = std::sqrt(glm::dot(n, n));
  return length > 0 ? n / length : DVec3(0.0);
}

double longest_side2(const Triangle& t) {
  const DVec3 a = t[1] - t[0], b = t[2] - t[1], c = t[0] - t[2];
  return std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
}

template <class F>
double largest(std::span<const LocalChange::Face> faces, F&& of) {
  double most = 0;
  for (const LocalChange::Face& face : faces) most = std::max(most, of(face.corner));
  return most;
}

// What is stored is no less than what was found.
float rounded_up(double x) {
  const auto below = static_cast<float>(x);
  return static_cast<double>(below) >= x ? below
                                         : std::nextafter(below, std::numeric_limits<float>::infinity());
}

}  // namespace

double aspect_ratio(const Triangle& t) {
  const DVec3 n = area_vector(t);
  const double twice = std::sqrt(glm::dot(n, n));
  return twice > 0 ? 0.5 * std::numbers::sqrt3 * longest_side2(t) / twice
                   : std::numeric_limits<double>::infinity();
}

Criteria::Criteria(const DecimateWeights& weights, const DecimateBounds& bounds, const Frame& frame,
                   const CollapseMesh& mesh)
    : weights_(weights),
      limits_(bounds),
      watches_distance_(bounds.report_distance || bounds.distance),
      bounds_(watches_distance_ || bounds.original_normal_deviation || bounds.edge_length ||
              bounds.aspect_ratio || bounds.valence) {
  const auto local = [&](const Length& length) { return length.in_units(frame.diagonal) * frame.scale; };
  if (bounds.distance) distance_ = local(*bounds.distance);
  if (bounds.edge_length) edge_length2_ = local(*bounds.edge_length) * local(*bounds.edge_length);
  if (watches_distance_) distances_.assign(mesh.face_count(), 0.0f);
  if (bounds.original_normal_deviation) {
    chord_ = 2 * std::sin(0.5 * *bounds.original_normal_deviation);
    normals_.resize(mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      if (!mesh.face(4 * f).alive()) continue;  // pruned
      const DVec3 n = unit_normal(face_of(mesh, f).corner);
      if (n != DVec3(0.0))
        normals_[f] = {{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)}, 1e-6f};
    }
  }
}

float Criteria::cost(float quadric, float area, const LocalChange& change) const {
  const auto square = [](double x) { return x * x; };
  double factor = square(weights_.density);
  if (weights_.aspect_ratio > 0) {
    const double worst = largest(change.after, aspect_ratio);
    factor += square(weights_.aspect_ratio) * (worst > 0 ? 1 - 1 / worst : 0.0);
  }
  if (weights_.normals > 0) {
    double least = 1;  // cosine
    for (const LocalChange::Face& face : change.after) {
      const DVec3 n = unit_normal(face.corner);
      double nearest = -1;
      for (const LocalChange::Face& old : change.before)
        nearest = std::max(nearest, glm::dot(n, unit_normal(old.corner)));
      least = std::min(least, nearest);
    }
    factor += square(weights_.normals) * (1 - least);
  }
  const double sum = square(weights_.quadric) * static_cast<double>(quadric) +
                     static_cast<double>(area) * change.length2 * factor;
  return static_cast<float>(sum);
}

bool Criteria::allow(const LocalChange& change) {
  if (limits_.valence && change.edges_after > std::max(*limits_.valence, change.edges_before)) return false;
  if (limits_.edge_length) {
    const double longest = largest(change.after, longest_side2);
    if (longest > edge_length2_ && longest > largest(change.before, longest_side2)) return false;
  }
  if (limits_.aspect_ratio) {
    const double worst = largest(change.after, aspect_ratio);
    if (worst > *limits_.aspect_ratio && worst > largest(change.before, aspect_ratio)) return false;
  }
  return (normals_.empty() || looks_alike(change)) && (distances_.empty() || stays_near(change));
}

/// Whether inner vertices alone show that the distance would be too large: most that are too far are so
/// there.
bool Criteria::is_far(const LocalChange& change) const {
  const auto far = [&](const DVec3& p, std::span<const LocalChange::Face> faces, bool with_theirs) {
    return std::all_of(faces.begin(), faces.end(), [&](const LocalChange::Face& face) {
      const double theirs = with_theirs ? static_cast<double>(distances_[face.record]) : 0;
      const double left = distance_ - theirs;
      return left < 0 || squared_distance(p, face.corner) > left * left;
    });
  };
  return std::any_of(change.inner_after.begin(), change.inner_after.end(),
                     [&](const DVec3& p) { return far(p, change.before, true); }) ||
         std::any_of(change.inner_before.begin(), change.inner_before.end(),
                     [&](const DVec3& p) { return far(p, change.after, false); });
}

/// A point of the original that is within d of a point of the surface before, which is within e of one after,
/// is within d + e of that; and so the other way round.
bool Criteria::stays_near(const LocalChange& change) {
  if (is_far(change)) return false;
  DVec3 up(0.0);
  for (const LocalChange::Face& face : change.before) up += area_vector(face.corner);
  distances_after_.assign(change.after.size(), 0.0f);
  const auto add = [&](std::size_t before, std::size_t after, double apart) {
    const double sum = static_cast<double>(distances_[change.before[before].record]) + apart;
    distances_after_[after] = std::max(distances_after_[after], rounded_up(sum));
    return sum <= distance_;
  };
  return overlay_.cut(change.before, change.after, up, add) &&
         overlay_.cut(change.after, change.before, up,
                      [&](std::size_t j, std::size_t i, double apart) { return add(i, j, apart); });
}

/// Each face before is handed to the one after that its middle is nearest to; one that gets none has the
/// normals of the one before that its own middle is nearest to.
bool Criteria::looks_alike(const LocalChange& change) {
  const auto nearest = [](const LocalChange::Face& face, std::span<const LocalChange::Face> faces) {
    const DVec3 middle = (face.corner[0] + face.corner[1] + face.corner[2]) / 3.0;
    std::pair<double, std::size_t> best{std::numeric_limits<double>::infinity(), 0};
    for (std::size_t k = 0; k < faces.size(); ++k)
      best = std::min(best, {squared_distance(middle, faces[k].corner), k});
    return best.second;
  };
  normals_after_.assign(change.after.size(), Ball{});
  if (change.after.empty()) return true;
  for (const LocalChange::Face& face : change.before) {
    Ball& ball = normals_after_[nearest(face, change.after)];
    ball = around(ball, normals_[face.record]);
  }
  for (std::size_t j = 0; j < change.after.size(); ++j) {
    Ball& ball = normals_after_[j];
    if (ball.radius < 0) ball = normals_[change.before[nearest(change.after[j], change.before)].record];
    const DVec3 n = unit_normal(change.after[j].corner);
    if (ball.radius < 0 || n == DVec3(0.0)) continue;
    const DVec3 away = n - point_of(ball.centre);
    if (std::sqrt(glm::dot(away, away)) + static_cast<double>(ball.radius) > chord_) return false;
  }
  return true;
}

void Criteria::keep(const LocalChange& change) {
  for (std::size_t j = 0; j < change.after.size(); ++j) {
    if (!distances_.empty()) distances_[change.after[j].record] = distances_after_[j];
    if (!normals_.empty()) normals_[change.after[j].record] = normals_after_[j];
  }
}

double Criteria::distance(const CollapseMesh& mesh) const {
  float most = 0;
  for (std::uint32_t f = 0; f < distances_.size(); ++f)
    if (mesh.face(4 * f).alive()) most = std::max(most, distances_[f]);
  return static_cast<double>(most);
}

/// The smallest ball around both.
Criteria::Ball Criteria::around(const Ball& a, const Ball& b) {
  if (a.radius < 0) return b;
  if (b.radius < 0) return a;
  const DVec3 from = point_of(a.centre), way = point_of(b.centre) - from;
  const double apart = std::sqrt(glm::dot(way, way)), ra = static_cast<double>(a.radius),
               rb = static_cast<double>(b.radius);
  if (apart + rb <= ra) return a;
  if (apart + ra <= rb) return b;
  const double radius = 0.5 * (apart + ra + rb);
  const DVec3 centre = from + ((radius - ra) / apart) * way;
  // A little larger: the centre is rounded.
  return {{static_cast<float>(centre.x), static_cast<float>(centre.y), static_cast<float>(centre.z)},
          rounded_up(radius + 2e-7)};
}

}  // namespace vkmesh::detail
