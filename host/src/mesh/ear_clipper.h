// Cutting polygons into triangles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/math/bounds.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/handles.h>

#include "spatial/kd_tree.h"

namespace vkmesh::detail {

/// Ear clipping, see triangulate(). Cuts one polygon after another; keeps its arrays between them.
class EarClipper {
 public:
  /// Calls emit(i, j, k) with places within `corners`, corners.size() - 2 times. Which triangles they are
  /// does not depend on the corner that comes first. Diagonals between points for which taken(a, b) holds are
  /// avoided, at the cost of triangles that are turned where there is no other way.
  template <class Emit, class Taken>
  void clip(std::span<const Vec3> points, std::span<const std::uint32_t> corners, Emit&& emit,
            Taken&& taken) {
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
    uses_tree_ = n > kSmall;
    if (uses_tree_) build_tree();
    judge_all(0);

    const auto is_taken = [&](std::uint32_t ear) {
      return taken(corners[previous_[ear]], corners[next_[ear]]);
    };
    std::uint32_t at = next_[lowest_corner(corners)], left = n;
    for (; left > 3; --left) {
      const std::uint32_t ear = find_ear(at, left, is_taken);
      if (ear == kInvalid) break;
      const std::uint32_t before = previous_[ear], after = next_[ear];
      emit(before, ear, after);
      unblock(ear);
      next_[before] = after;
      previous_[after] = before;
      at = after;
      // Only the neighbours of an ear change: every other diagonal stays as it was.
      for (const std::uint32_t i : {before, after})
        if (area(i) > 0)
          unblock(i);
        else
          block(i);
      proper_[before] = is_ear(before, Ear::kProper);
      proper_[after] = is_ear(after, Ear::kProper);
    }
    const std::uint32_t hub = previous_[at];
    for (; left > 2; --left, at = next_[at]) emit(hub, at, next_[at]);
  }
  template <class Emit>
  void clip(std::span<const Vec3> points, std::span<const std::uint32_t> corners, Emit&& emit) {
    clip(points, corners, emit, [](std::uint32_t, std::uint32_t) { return false; });
  }

 private:
  static constexpr std::uint32_t kSmall = 48;  ///< Corners up to which a look at each is the fastest.

  /// The corner with the lowest point or, of several, with the lowest one behind it.
  static std::uint32_t lowest_corner(std::span<const std::uint32_t> corners) {
    const auto after = [&](std::size_t i) { return corners[i + 1 == corners.size() ? 0 : i + 1]; };
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < corners.size(); ++i)
      if (std::pair(corners[i], after(i)) < std::pair(corners[lowest], after(lowest))) lowest = i;
    return static_cast<std::uint32_t>(lowest);
  }

  void unblock(std::uint32_t i) {
    if (blocks_[i] && uses_tree_) count_blocking(i, -1);
    blocks_[i] = 0;
  }
  void block(std::uint32_t i) {
    if (!blocks_[i] && uses_tree_) count_blocking(i, 1);
    blocks_[i] = 1;
  }

  void build_tree() {
    tree_.build(flat_);
    leaf_.resize(flat_.size());
    for (std::size_t node = tree_.first_leaf(); node < tree_.node_bound(); ++node)
      for (const std::uint32_t i : tree_.points_in(node)) leaf_[i] = node;
    blocking_.assign(tree_.node_bound(), 0);
    for (std::uint32_t i = 0; i < flat_.size(); ++i)
      if (blocks_[i]) count_blocking(i, 1);
  }
  void count_blocking(std::uint32_t i, int by) {
    for (std::size_t node = leaf_[i]; node > 0; node /= 2) blocking_[node] += by;
  }

  /// Whether the whole box is right of the line from p to q. Rounding may only make it say no: what it passes
  /// over, the exact same sum for each point would pass over, too, or the margin of its terms decides.
  static bool lies_beyond(const DBounds& box, const DVec3& p, const DVec3& q) {
    const double dx = q.x - p.x, dy = q.y - p.y;
    const double x = dy > 0 ? box.low.x : box.high.x, y = dx > 0 ? box.high.y : box.low.y;
    const double left = dx * (y - p.y), right = dy * (x - p.x);
    return left - right < -1e-12 * (std::abs(left) + std::abs(right));
  }

  /// Twice the signed area of a triangle: positive when a, b, c run counter-clockwise.
  static double area2(const DVec3& a, const DVec3& b, const DVec3& c) {
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
      flat_.emplace_back(p[first], p[second], 0);
    }
  }

  double area(std::uint32_t i) const { return area2(flat_[previous_[i]], flat_[i], flat_[next_[i]]); }

  /// What a corner must be to be cut, the best first. A simple polygon always has a proper ear, and what is
  /// cut then has area; the others serve polygons that touch or cross themselves.
  enum class Ear { kProper, kFlat, kTouched, kAny };

  /// The first ear at or after `start`, or kInvalid: one whose diagonal is not taken, whatever its kind,
  /// before those whose is.
  template <class Taken>
  std::uint32_t find_ear(std::uint32_t start, std::uint32_t left, Taken&& taken) {
    std::uint32_t i = start;
    bool any_taken = false;
    for (std::uint32_t tried = 0; tried < left; ++tried, i = next_[i]) {
      if (!proper_[i]) continue;
      if (!taken(i)) return i;
      any_taken = true;
    }
    if (!any_taken) judge_all(start);
    for (const Ear kind : {Ear::kProper, Ear::kFlat, Ear::kTouched, Ear::kAny}) {
      if (kind == Ear::kAny && !any_taken) break;
      for (std::uint32_t tried = 0; tried < left; ++tried, i = next_[i])
        if (is_of(i, kind)) {
          if (!taken(i)) return i;
          any_taken = true;
        }
    }
    for (const Ear kind : {Ear::kProper, Ear::kFlat, Ear::kTouched})
      for (std::uint32_t tried = 0; tried < left; ++tried, i = next_[i])
        if (is_of(i, kind)) return i;
    return kInvalid;
  }

  bool is_of(std::uint32_t i, Ear kind) const {
    return kind == Ear::kAny || (kind == Ear::kProper ? proper_[i] != 0 : is_ear(i, kind));
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
    const DVec3 a = flat_[before], b = flat_[i], c = flat_[after];
    const auto is_inside = [&](std::uint32_t j) {
      const DVec3 p = flat_[j];
      const double ab = area2(a, b, p), bc = area2(b, c, p), ca = area2(c, a, p);
      return kind == Ear::kTouched ? (ab > 0 && bc > 0 && ca > 0)
                                   : (ab >= 0 && bc >= 0 && ca >= 0 && !(p == a) && !(p == b) && !(p == c));
    };
    if (uses_tree_)
      return !tree_.any(
          [&](std::size_t node, const DBounds& box) {
            return blocking_[node] == 0 || lies_beyond(box, a, b) || lies_beyond(box, b, c) ||
                   lies_beyond(box, c, a);
          },
          [&](std::uint32_t j) { return blocks_[j] && j != before && j != after && is_inside(j); });
    for (std::uint32_t j = next_[after]; j != before; j = next_[j])
      if (blocks_[j] && is_inside(j)) return false;
    return true;
  }

  std::vector<DVec3> flat_;  ///< Projected, with z = 0.
  std::vector<std::uint32_t> next_, previous_;
  std::vector<char> blocks_;  ///< Corners that are not convex: only they can lie inside an ear.
  std::vector<char> proper_;  ///< Corners that are proper ears.
  // In large polygons: the corners, the leaf of each, and how many below each node block.
  KdTree<DVec3> tree_;
  std::vector<std::size_t> leaf_;
  std::vector<int> blocking_;
  bool uses_tree_ = false;
};

}  // namespace vkmesh::detail
