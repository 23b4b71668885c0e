// How far apart two surfaces lie that cover the same place.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "decimation/legality/local_change.h"

namespace vkmesh::detail {

/// Cuts triangles into pieces and tells for each how far from one triangle of the other surface it reaches.
///
/// The distance to a convex set is a convex function, so over a convex piece it is largest at a corner of it:
/// whatever the cuts, what is told is a bound. Cuts along the other surface's edges, seen along `up`, make it
/// a good one: over each piece two planes lie on each other.
class Overlay {
 public:
  /// Calls use(i, j, d) for each piece of from[i]: none of its points is farther than d from to[j]. The
  /// pieces cover from[i]. False as soon as `use` says so. O(|from| · |to|) where few edges cross.
  template <class Use>
  bool cut(std::span<const LocalChange::Face> from, std::span<const LocalChange::Face> to, const DVec3& up,
           Use&& use) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      begin(from[i].corner);
      for (std::size_t j = 0; j < to.size() && !left_.empty(); ++j)
        if (const double d = take(to[j].corner, up); d >= 0 && !use(i, j, d)) return false;
      for (const Polygon& polygon : left_) {
        const auto [j, d] = nearest(polygon, to);
        if (!use(i, j, d)) return false;
      }
    }
    return true;
  }

 private:
  struct Polygon {
    static constexpr std::size_t kMaxCorners = 24;
    std::array<DVec3, kMaxCorners> corner;
    std::size_t size = 0;
    void add(const DVec3& p) { corner[size++] = p; }
  };

  void begin(const Triangle& triangle);
  /// Takes what lies over the triangle out of what is left; how far it reaches, -1 if there is nothing.
  double take(const Triangle& triangle, const DVec3& up);
  /// For what lies over none of them: at the boundary, and where a surface folds.
  static std::pair<std::size_t, double> nearest(const Polygon& polygon,
                                                std::span<const LocalChange::Face> to);
  static double reach2(const Polygon& polygon, const Triangle& triangle);
  void split(const Polygon& polygon, const Triangle& by, const DVec3& up, Polygon& inside);

  std::vector<Polygon> left_, rest_;
};

}  // namespace vkmesh::detail
