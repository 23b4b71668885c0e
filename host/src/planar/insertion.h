// The insertion of points into triangles in the plane, by splits and Lawson's swaps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/large_array.h"
#include "math/filtered_predicates.h"
#include "planar/edge_marks.h"
#include "planar/triangle_mesh.h"

namespace vkmesh::detail {

/// A half-edge of the triangle that a point lies in, and whether it lies on that half-edge.
struct PlaceInTriangles {
  std::uint32_t half_edge;
  bool on_edge;
};

/// A Delaunay triangulation that points are added to, constrained where marks fix edges: what delaunay()
/// made. Its hull is closed by triangles with the vertex at infinity, kInvalid: one for each edge of the
/// hull, which it has the other way.
class Insertion {
 public:
  Insertion(std::span<const DVec2> points, PlanarTriangles triangles, EdgeMarks marks)
      : points_(points.data()),
        predicates_(all_in_filter_range(points)),
        triangles_(std::move(triangles)),
        marks_(std::move(marks)) {}

  /// Adds point v, which lies there; there is room for two more triangles. Both parts of a fixed edge are
  /// fixed.
  void insert_at(std::uint32_t v, PlaceInTriangles place) {
    const std::uint32_t h = place.half_edge, t = h >> 2, n = PlanarTriangles::next(h),
                        m = PlanarTriangles::previous(h), first = triangles_.count, second = first + 1;
    marks_.set_leaving(v, 4 * t);
    triangles_.count += 2;
    marks_.copy_region(t, first);
    if (!place.on_edge) {
      const std::array<Side, 3> sides = {side(h), side(n), side(m)};
      marks_.copy_region(t, second);
      surround(v, sides, {t, first, second});
      make_delaunay(t, 3);
    } else {
      const std::uint32_t u = triangles_.twin(h);
      const std::array<Side, 4> sides = {side(n), side(m), side(PlanarTriangles::next(u)),
                                         side(PlanarTriangles::previous(u))};
      const std::uint8_t kind = marks_.kind(h);
      marks_.copy_region(u >> 2, second);
      surround(v, sides, {t, first, u >> 2, second});
      for (const std::uint32_t part : {4 * t, 4 * second + 2, 4 * first + 2, 4 * (u >> 2)})
        marks_.set_kind(part, kind);
      make_delaunay(t, 4);
    }
  }

  [[nodiscard]] PlanarTriangles& triangles() { return triangles_; }
  [[nodiscard]] const PlanarTriangles& triangles() const { return triangles_; }
  [[nodiscard]] EdgeMarks& marks() { return marks_; }
  [[nodiscard]] const EdgeMarks& marks() const { return marks_; }
  [[nodiscard]] const FilteredPredicates& predicates() const { return predicates_; }
  /// Tells where points are now, of which one was added.
  void points_moved(const DVec2* points, DVec2 added) {
    points_ = points;
    if (!in_filter_range(added)) predicates_ = FilteredPredicates(false);
  }

  void swap(std::uint32_t h) {
    marks_.before_swap(triangles_, h);
    triangles_.swap(h);
  }

 private:
  /// An edge that a new point is joined to, and what lies beyond it.
  struct Side {
    std::uint32_t origin, beyond;
    std::uint8_t kind;
  };

  void set_origins(std::uint32_t t, const std::array<std::uint32_t, 3>& corners) {
    std::copy_n(corners.begin(), 3, &triangles_.origins[3 * std::size_t{t}]);
  }
  [[nodiscard]] Side side(std::uint32_t h) const {
    return {triangles_.origin(h), triangles_.twin(h), marks_.kind(h)};
  }

  /// Joins v to sides that go once around it, counter-clockwise, by triangles with v at corner 0.
  template <std::size_t N>
  void surround(std::uint32_t v, const std::array<Side, N>& sides,
                const std::array<std::uint32_t, N>& records) {
    for (std::size_t i = 0; i < N; ++i) {
      const std::size_t j = (i + 1) % N;
      const std::uint32_t h = 4 * records[i];
      set_origins(records[i], {v, sides[i].origin, sides[j].origin});
      triangles_.set_twins(h + 1, sides[i].beyond);
      triangles_.set_twins(h + 2, 4 * records[j]);
      marks_.set_kind(h, 0);
      marks_.set_kind(h + 1, sides[i].kind);
      marks_.set_kind(h + 2, 0);
      marks_.set_leaving(sides[i].origin, h + 1);
    }
  }

  /// Swaps edges across from a new point, corner 0 of the `edges` triangles around it, of which t is one,
  /// until all are Delaunay or fixed.
  void make_delaunay(std::uint32_t t, int edges) {
    while (edges > 0) {
      if (is_to_swap(t)) {
        swap(4 * t + 1);
        ++edges;
      } else {
        t = triangles_.twin(4 * t + 2) >> 2;
        --edges;
      }
    }
  }
  [[nodiscard]] bool is_to_swap(std::uint32_t t) const {
    if (marks_.is_fixed(4 * t + 1)) return false;
    const std::uint32_t* const corner = &triangles_.origins[3 * std::size_t{t}];
    const std::uint32_t v = corner[0], a = corner[1], b = corner[2];
    const std::uint32_t across = triangles_.origin(PlanarTriangles::previous(triangles_.twin(4 * t + 1)));
    constexpr std::uint32_t kAtInfinity = 0x80000000u;
    if (((a | b | across) & kAtInfinity) == 0)
      return predicates_.in_circle_perturbed(points_[v], points_[a], points_[b], points_[across]) > 0;
    // The circle of an edge of the hull is the open half-plane beyond it.
    if (across == kInvalid) return false;
    return predicates_.orientation(points_[v], points_[a == kInvalid ? across : a],
                                   points_[b == kInvalid ? across : b]) > 0;
  }

  const DVec2* points_;
  FilteredPredicates predicates_;
  PlanarTriangles triangles_;
  EdgeMarks marks_;
};

constexpr std::size_t kMostVertices = (std::size_t{1} << 29) - 2;

}  // namespace vkmesh::detail
