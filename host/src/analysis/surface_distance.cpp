#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/bounds.h>

#include "math/triangle_distance.h"
#include "spatial/triangle_tree.h"

namespace vkmesh {
namespace {

using glm::cross;
using glm::dot;

constexpr std::size_t kSamplesBetweenReports = 8192;

using detail::Triangle, detail::squared_distance;

Triangle triangle(const TriangleSurface& surface, std::size_t f) {
  return {DVec3(surface.points[surface.corners[3 * f]]), DVec3(surface.points[surface.corners[3 * f + 1]]),
          DVec3(surface.points[surface.corners[3 * f + 2]])};
}

double area(const Triangle& t) {
  const DVec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  return 0.5 * std::sqrt(dot(normal, normal));
}

DVec3 normal_of(const Triangle& t) {
  return cross(t[1] - t[0], t[2] - t[0]);
}

/// Bounds the one-sided Hausdorff distance from one surface to the triangles of a tree.
class HausdorffBounds {
 public:
  HausdorffBounds(const TriangleSurface& from, const detail::TriangleTree& tree, double low, double tolerance)
      : from_(from), tree_(tree), low2_(low * low), factor2_((1 + tolerance) * (1 + tolerance)) {}

  /// Errors: kInterrupted, told by `progress` (which hears `done` again and again).
  Result<void> run(DistanceSummary& summary, const Progress& progress, double done) {
    std::vector<Point> points(from_.points.size());
    std::vector<bool> used(points.size(), false);
    for (const std::uint32_t c : from_.corners) used[c] = true;
    std::uint32_t hint = 0;
    for (std::size_t p = 0; p < points.size(); ++p)
      if (used[p]) {
        points[p] = measured(DVec3(from_.points[p]), hint);
        hint = points[p].nearest;
      }
    for (std::size_t c = 0; c < from_.corners.size(); c += 3)
      add(points[from_.corners[c]], points[from_.corners[c + 1]], points[from_.corners[c + 2]]);
    // The piece with the largest bound first. What is left when it is near enough is near enough as well.
    std::size_t splits = 0;
    while (!pieces_.empty() && pieces_.front().high2 > low2_ * factor2_ && splits < kMostSplits) {
      if (progress && splits++ % kSamplesBetweenReports == 0 && !progress(done))
        return fail(ErrorCode::kInterrupted, "the comparison was cancelled");
      std::pop_heap(pieces_.begin(), pieces_.end());
      const Piece piece = pieces_.back();
      pieces_.pop_back();
      const Point ab = measured((piece.a.place + piece.b.place) / 2.0, piece.a.nearest);
      const Point bc = measured((piece.b.place + piece.c.place) / 2.0, piece.b.nearest);
      const Point ca = measured((piece.c.place + piece.a.place) / 2.0, piece.c.nearest);
      add(piece.a, ab, ca);
      add(piece.b, bc, ab);
      add(piece.c, ca, bc);
      add(ab, bc, ca);
    }
    const double high2 = pieces_.empty() ? passed2_ : std::max(passed2_, pieces_.front().high2);
    summary.hausdorff_low = std::sqrt(low2_);
    summary.hausdorff_high = std::sqrt(std::max(low2_, high2));
    return {};
  }

 private:
  /// Where surfaces coincide but for rounding, no share of the distance is reached.
  static constexpr std::size_t kMostSplits = 4'000'000;

  struct Point {
    DVec3 place{0.0};
    std::uint32_t nearest = 0;
  };
  struct Piece {
    Point a, b, c;
    double high2;
    friend bool operator<(const Piece& x, const Piece& y) { return x.high2 < y.high2; }
  };

  Point measured(const DVec3& place, std::uint32_t hint) {
    low2_ = std::max(low2_, tree_.nearest(place, hint));
    return {place, hint};
  }

  void add(const Point& a, const Point& b, const Point& c) {
    double high2 = std::numeric_limits<double>::infinity();
    for (const std::uint32_t near : {a.nearest, b.nearest, c.nearest}) {
      const Triangle& t = tree_.at(near);
      high2 = std::min(high2, std::max({squared_distance(a.place, t), squared_distance(b.place, t),
                                        squared_distance(c.place, t)}));
    }
    if (high2 <= low2_ * factor2_) {
      passed2_ = std::max(passed2_, high2);
      return;
    }
    pieces_.push_back({a, b, c, high2});
    std::push_heap(pieces_.begin(), pieces_.end());
  }

  const TriangleSurface& from_;
  const detail::TriangleTree& tree_;
  double low2_;  ///< Some point is this far away.
  double factor2_;
  double passed2_ = 0;  ///< No point of the pieces let go is further away.
  std::vector<Piece> pieces_;
};

/// Reports in [begin, begin + 0.5].
Result<DistanceSummary> one_sided(const TriangleSurface& from, const TriangleSurface& to,
                                  const SurfaceDistanceOptions& options, const Progress& progress,
                                  double begin) {
  const detail::TriangleTree tree(to.points, to.corners);
  const std::size_t faces = from.corners.size() / 3;
  double total = 0;
  for (std::size_t f = 0; f < faces; ++f) total += area(triangle(from, f));

  std::mt19937 random(options.seed);
  // Not a standard distribution: its values differ between libraries.
  const auto uniform = [&] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
  const auto samples = static_cast<double>(options.samples);
  DistanceSummary summary;
  double sum = 0, sum2 = 0, maximum2 = 0;
  std::uint32_t hint = 0;
  std::size_t f = 0, angles = 0;
  double angle_sum = 0;
  Triangle t = triangle(from, 0);
  double passed = area(t);  // of the faces up to f
  for (std::size_t i = 0; i < options.samples; ++i) {
    if (progress && i % kSamplesBetweenReports == 0 &&
        !progress(begin + 0.5 * static_cast<double>(i) / samples))
      return fail(ErrorCode::kInterrupted, "the comparison was cancelled");
    const double place = total * ((static_cast<double>(i) + uniform()) / samples);
    while (passed <= place && f + 1 < faces) {
      t = triangle(from, ++f);
      passed += area(t);
    }
    double u = uniform(), v = uniform();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const double d2 = tree.nearest(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]), hint);
    const DVec3 here = normal_of(t), there = normal_of(tree.at(hint));
    if (dot(here, here) > 0 && dot(there, there) > 0) {
      const DVec3 across = cross(here, there);
      const double angle = std::atan2(std::sqrt(dot(across, across)), dot(here, there));
      angle_sum += angle;
      summary.maximum_normal_angle = std::max(summary.maximum_normal_angle, angle);
      ++angles;
    }
    sum += std::sqrt(d2);
    sum2 += d2;
    maximum2 = std::max(maximum2, d2);
  }
  summary.mean = sum / samples;
  summary.root_mean_square = std::sqrt(sum2 / samples);
  summary.maximum = std::sqrt(maximum2);
  if (angles > 0) summary.mean_normal_angle = angle_sum / static_cast<double>(angles);
  if (options.hausdorff_tolerance > 0)
    VKMESH_CHECK(HausdorffBounds(from, tree, summary.maximum, options.hausdorff_tolerance)
                     .run(summary, progress, begin + 0.5));
  return summary;
}

Result<void> check(const TriangleSurface& surface) {
  if (surface.corners.size() % 3 != 0)
    return fail(ErrorCode::kUsage, "a surface needs three corners for each triangle");
  double total = 0;
  for (const std::uint32_t corner : surface.corners)
    if (corner >= surface.points.size())
      return fail(ErrorCode::kUsage, "a corner of the surface is out of range");
  for (std::size_t f = 0; f < surface.corners.size() / 3; ++f) total += area(triangle(surface, f));
  if (!(total > 0)) return fail(ErrorCode::kUnsuitable, "a surface without area has no samples to compare");
  return {};
}

double diagonal_of(const TriangleSurface& surface) {
  Bounds bounds;
  for (const std::uint32_t corner : surface.corners) bounds.add(surface.points[corner]);
  return bounds.diagonal();
}

}  // namespace

DistanceSummary SurfaceDistance::two_sided() const {
  DistanceSummary both;
  both.mean = (a_to_b.mean + b_to_a.mean) / 2;
  both.root_mean_square = std::sqrt((a_to_b.root_mean_square * a_to_b.root_mean_square +
                                     b_to_a.root_mean_square * b_to_a.root_mean_square) /
                                    2);
  both.maximum = std::max(a_to_b.maximum, b_to_a.maximum);
  both.hausdorff_low = std::max(a_to_b.hausdorff_low, b_to_a.hausdorff_low);
  both.hausdorff_high = std::max(a_to_b.hausdorff_high, b_to_a.hausdorff_high);
  both.mean_normal_angle = (a_to_b.mean_normal_angle + b_to_a.mean_normal_angle) / 2;
  both.maximum_normal_angle = std::max(a_to_b.maximum_normal_angle, b_to_a.maximum_normal_angle);
  return both;
}

Result<SurfaceDistance> surface_distance(const TriangleSurface& a, const TriangleSurface& b,
                                         const SurfaceDistanceOptions& options, const Progress& progress) {
  if (options.samples == 0) return fail(ErrorCode::kUsage, "the comparison needs at least one sample");
  if (!(options.hausdorff_tolerance >= 0))
    return fail(ErrorCode::kUsage, "the tolerance of the Hausdorff distance must not be negative");
  return detail::catching([&]() -> Result<SurfaceDistance> {
    VKMESH_CHECK(check(a));
    VKMESH_CHECK(check(b));
    SurfaceDistance distance;
    VKMESH_TRY(distance.a_to_b, one_sided(a, b, options, progress, 0.0));
    VKMESH_TRY(distance.b_to_a, one_sided(b, a, options, progress, 0.5));
    distance.diagonal = diagonal_of(a);
    return distance;
  });
}

}  // namespace vkmesh
