// Cutting polygons into triangles.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/handles.h>

namespace vkmesh::detail {

/// Ear clipping, see triangulate(). Cuts one polygon after another; keeps its arrays between them.
class EarClipper {
 public:
  /// Calls emit(i, j, k) with places within `corners`, corners.size() - 2 times.
  template <class Emit>
  void clip(std::span<const Vec3> points, std::span<const std::uint32_t> corners, Emit&& emit) {
    project(points, corners);
    const auto n = static_cast<std::uint32_t>(corners.size());
    next_.resize(n);
    previous_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = i + 1 == n ? 0 : i + 1;
      previous_[i] = i == 0 ? n - 1 : i - 1;
    }
    blocks_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) blocks_[i] = area(i) <= 0;
    proper_.resize(n);
    judge_all(0);

    std::uint32_t at = 1, left = n;
    for (; left > 3; --left) {
      const std::uint32_t ear = find_ear(at, left);
      if (ear == kInvalid) break;
      const std::uint32_t before = previous_[ear], after = next_[ear];
      emit(before, ear, after);
      next_[before] = after;
      previous_[after] = before;
      at = after;
      // Only the neighbours of an ear change: every other diagonal stays as it was.
      blocks_[before] = area(before) <= 0;
      blocks_[after] = area(after) <= 0;
      proper_[before] = is_ear(before, Ear::kProper);
      proper_[after] = is_ear(after, Ear::kProper);
    }
    const std::uint32_t hub = previous_[at];
    for (; left > 2; --left, at = next_[at]) emit(hub, at, next_[at]);
  }

 private:
  struct Point2 {
    double x, y;
    friend bool operator==(const Point2&, const Point2&) = default;
  };

  /// Twice the signed area of a triangle: positive when a, b, c run counter-clockwise.
  static double area2(const Point2& a, const Point2& b, const Point2& c) {
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  }

  /// Drops the axis along which Newell's normal is longest: an affine image of the projection on the
  /// polygon's plane, so ears are the same, and exact where the polygon lies in a coordinate plane.
  void project(std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
    DVec3 normal(0.0);
    const DVec3 origin(points[corners[0]]);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const DVec3 a = DVec3(points[corners[i]]) - origin;
      const DVec3 b = DVec3(points[corners[i + 1 == corners.size() ? 0 : i + 1]]) - origin;
      normal.x += (a.y - b.y) * (a.z + b.z);
      normal.y += (a.z - b.z) * (a.x + b.x);
      normal.z += (a.x - b.x) * (a.y + b.y);
    }
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    const int drop = x > y && x > z ? 0 : (y > z ? 1 : 2);
    int first = (drop + 1) % 3, second = (drop + 2) % 3;
    if (normal[drop] < 0) std::swap(first, second);
    flat_.clear();
    for (const std::uint32_t c : corners) {
      const DVec3 p = DVec3(points[c]) - origin;
      flat_.push_back({p[first], p[second]});
    }
  }

  double area(std::uint32_t i) const { return area2(flat_[previous_[i]], flat_[i], flat_[next_[i]]); }

  /// What a corner must be to be cut, the best first. A simple polygon always has a proper ear, and what is
  /// cut then has area; the others serve polygons that touch or cross themselves.
  enum class Ear { kProper, kFlat, kTouched };

  /// The first ear at or after `start`, or kInvalid.
  std::uint32_t find_ear(std::uint32_t start, std::uint32_t left) {
    std::uint32_t i = start;
    for (std::uint32_t tried = 0; tried < left; ++tried, i = next_[i])
      if (proper_[i]) return i;
    judge_all(start);
    for (const Ear kind : {Ear::kProper, Ear::kFlat, Ear::kTouched})
      for (std::uint32_t tried = 0; tried < left; ++tried, i = next_[i])
        if (kind == Ear::kProper ? proper_[i] != 0 : is_ear(i, kind)) return i;
    return kInvalid;
  }

  void judge_all(std::uint32_t start) {
    std::uint32_t i = start;
    do {
      proper_[i] = is_ear(i, Ear::kProper);
      i = next_[i];
    } while (i != start);
  }

  bool is_ear(std::uint32_t i, Ear kind) const {
    if (kind == Ear::kFlat) return area(i) == 0;
    if (blocks_[i]) return false;
    const std::uint32_t before = previous_[i], after = next_[i];
    const Point2 a = flat_[before], b = flat_[i], c = flat_[after];
    for (std::uint32_t j = next_[after]; j != before; j = next_[j]) {
      if (!blocks_[j]) continue;
      const Point2 p = flat_[j];
      const double ab = area2(a, b, p), bc = area2(b, c, p), ca = area2(c, a, p);
      if (kind == Ear::kTouched ? (ab > 0 && bc > 0 && ca > 0)
                                : (ab >= 0 && bc >= 0 && ca >= 0 && !(p == a) && !(p == b) && !(p == c)))
        return false;
    }
    return true;
  }

  std::vector<Point2> flat_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<char> blocks_;  ///< Corners that are not convex: only they can lie inside an ear.
  std::vector<char> proper_;  ///< Corners that are proper ears.
};

}  // namespace vkmesh::detail
