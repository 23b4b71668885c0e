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
/// Bounds of the Hausdorff distance below this share of the diagonal count as near enough.
constexpr double kZero = 1e-10;

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

/// The bounds of the corners in use.
Bounds bounds_of(const TriangleSurface& surface) {
  Bounds bounds;
  for (const std::uint32_t corner : surface.corners) bounds.add(surface.points[corner]);
  return bounds;
}

/// What a distance between points of a surface is off by at most: they are rounded to doubles, and so is it.
double rounding_of(const Bounds& bounds) {
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    largest = std::max({largest, std::fabs(static_cast<double>(bounds.low[k])),
                        std::fabs(static_cast<double>(bounds.high[k]))});
  return 0x1p-49 * largest;
}

/// Bounds the one-sided Hausdorff distance from one surface to the triangles of a tree.
class HausdorffBounds {
 public:
  /// Some sample of `from` is `low` away. `enough` is a distance that need not be told from 0, `rounding`
  /// what a computed one may be off by.
  HausdorffBounds(const TriangleSurface& from, const detail::TriangleTree& tree, double low, double tolerance,
                  double enough, double rounding)
      : from_(from),
        tree_(tree),
        low2_(low * low),
        factor2_((1 + tolerance) * (1 + tolerance)),
        enough2_(enough * enough),
        rounding_(rounding) {}

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
    for (std::size_t splits = 0;
         !pieces_.empty() && !is_near_enough(pieces_.front().high2) && splits < kMostSplits; ++splits) {
      if (progress && splits % kSamplesBetweenReports == 0 && !progress(done))
        return fail(ErrorCode::kInterrupted, "the comparison was cancelled");
      std::pop_heap(pieces_.begin(), pieces_.end());
      const Piece piece = pieces_.back();
      pieces_.pop_back();
      if (!cut_along_edge(piece)) quarter(piece);
    }
    const double high2 = pieces_.empty() ? passed2_ : std::max(passed2_, pieces_.front().high2);
    summary.hausdorff_low = std::max(0.0, std::sqrt(low2_) - rounding_);
    summary.hausdorff_high = std::sqrt(std::max(low2_, high2)) + rounding_;
    return {};
  }

 private:
  static constexpr std::size_t kMostSplits = 4'000'000;
  /// A piece that is cut along edges has a longest side so many times as long as its bound may be, or
  /// quartering it would be done sooner; and it is not so many times as long as the edge. Squared.
  static constexpr double kLong2 = 256, kLonger2 = 4;

  struct Point {
    DVec3 place{0.0};
    std::uint32_t nearest = 0;
  };
  struct Piece {
    std::array<Point, 3> corner;
    double high2;
    friend bool operator<(const Piece& x, const Piece& y) { return x.high2 < y.high2; }
  };

  [[nodiscard]] double near_enough2() const { return std::max(low2_ * factor2_, enough2_); }
  [[nodiscard]] bool is_near_enough(double high2) const { return high2 <= near_enough2(); }

  Point measured(const DVec3& place, std::uint32_t hint) {
    low2_ = std::max(low2_, tree_.nearest(place, hint));
    return {place, hint};
  }

  /// How far a piece reaches from a triangle; squared.
  [[nodiscard]] double reach2(const Piece& piece, std::uint32_t triangle) const {
    const Triangle& t = tree_.at(triangle);
    return std::max({squared_distance(piece.corner[0].place, t), squared_distance(piece.corner[1].place, t),
                     squared_distance(piece.corner[2].place, t)});
  }

  void add(const Point& a, const Point& b, const Point& c) {
    Piece piece{{a, b, c}, std::numeric_limits<double>::infinity()};
    for (const Point& corner : piece.corner)
      piece.high2 = std::min(piece.high2, reach2(piece, corner.nearest));
    if (is_near_enough(piece.high2)) {
      passed2_ = std::max(passed2_, piece.high2);
      return;
    }
    pieces_.push_back(piece);
    std::push_heap(pieces_.begin(), pieces_.end());
  }

  void quarter(const Piece& piece) {
    const auto& [a, b, c] = piece.corner;
    const Point ab = measured((a.place + b.place) / 2.0, a.nearest);
    const Point bc = measured((b.place + c.place) / 2.0, b.nearest);
    const Point ca = measured((c.place + a.place) / 2.0, c.nearest);
    add(a, ab, ca);
    add(b, bc, ab);
    add(c, ca, bc);
    add(ab, bc, ca);
  }

  /// Where two planes lie on each other, or nearly so, no piece across an edge of the other surface is ever
  /// small enough for one triangle there. Cuts it along the edge that goes deepest through it; false where it
  /// is to be quartered.
  bool cut_along_edge(const Piece& piece) {
    const auto& corners = piece.corner;
    double longest2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const DVec3 side = corners[(k + 1) % 3].place - corners[k].place;
      longest2 = std::max(longest2, dot(side, side));
    }
    if (longest2 <= kLong2 * near_enough2()) return false;
    // Corners may lie on edges, and be as near to triangles beyond.
    const Point middle =
        measured((corners[0].place + corners[1].place + corners[2].place) / 3.0, corners[0].nearest);
    if (const double high2 = reach2(piece, middle.nearest); is_near_enough(high2)) {
      passed2_ = std::max(passed2_, high2);
      return true;
    }
    std::array<double, 3> sides{};
    double deepest = 4 * rounding_;
    std::uint32_t under = 0;
    for (const std::uint32_t near :
         {middle.nearest, corners[0].nearest, corners[1].nearest, corners[2].nearest}) {
      const Triangle& t = tree_.at(near);
      const DVec3 normal = normal_of(t);
      for (std::size_t e = 0; e < 3; ++e) {
        const DVec3 along = t[(e + 1) % 3] - t[e], inward = cross(normal, along);
        const double length2 = dot(inward, inward);
        if (!(length2 > 0) || longest2 > kLonger2 * dot(along, along)) continue;
        std::array<double, 3> s{};
        for (std::size_t k = 0; k < 3; ++k) s[k] = dot(inward, corners[k].place - t[e]) / std::sqrt(length2);
        const double depth = std::min(std::max({s[0], s[1], s[2]}), -std::min({s[0], s[1], s[2]}));
        if (depth <= deepest) continue;
        deepest = depth;
        sides = s;
        under = near;
      }
    }
    if (deepest <= 4 * rounding_) return false;
    for (double& s : sides)
      if (std::fabs(s) <= 4 * rounding_) s = 0;
    // a alone is on its side.
    std::size_t alone = 0;
    while (sides[alone] == 0 || sides[alone] * sides[(alone + 1) % 3] > 0 ||
           sides[alone] * sides[(alone + 2) % 3] > 0)
      ++alone;
    const Point &a = corners[alone], &b = corners[(alone + 1) % 3], &c = corners[(alone + 2) % 3];
    const auto crossing = [&](const Point& q, double side) {
      if (side == 0) return q;
      return measured(a.place + (sides[alone] / (sides[alone] - side)) * (q.place - a.place), under);
    };
    const double side_b = sides[(alone + 1) % 3], side_c = sides[(alone + 2) % 3];
    const Point ab = crossing(b, side_b), ac = crossing(c, side_c);
    add(a, ab, ac);
    if (side_b != 0) add(ab, b, c);
    if (side_c != 0) add(ab, c, ac);
    return true;
  }

  const TriangleSurface& from_;
  const detail::TriangleTree& tree_;
  double low2_;  ///< Some point is this far away.
  double factor2_, enough2_, rounding_;
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
  Bounds both = bounds_of(from);
  const double diagonal = both.diagonal();
  both += bounds_of(to);
  const double rounding = rounding_of(both);
  summary.hausdorff_low = std::max(0.0, summary.maximum - rounding);
  if (options.hausdorff_tolerance > 0)
    VKMESH_CHECK(
        HausdorffBounds(from, tree, summary.maximum, options.hausdorff_tolerance, kZero * diagonal, rounding)
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
    distance.diagonal = bounds_of(a).diagonal();
    return distance;
  });
}

}  // namespace vkmesh
