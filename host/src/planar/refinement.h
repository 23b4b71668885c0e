// Delaunay refinement of a constrained triangulation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <queue>
#include <set>
#include <utility>
#include <vector>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/planar/constrained_delaunay.h>

#include "planar/constrained_triangles.h"

namespace vkmesh::detail {

/// Adds vertices until no triangle inside has a smaller angle or a larger area than asked for, as far as that
/// can be. The borders of the domain are fixed edges. Triangles outside are neither looked at nor swapped.
class Refinement {
 public:
  Refinement(ConstrainedTriangles& triangles, const DelaunayRefinement& options);

  [[nodiscard]] Result<void> run(const Progress& progress);
  /// Triangles that are not as asked for, and why.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, UnrefinedReason>> left() const;

 private:
  /// Beyond 1 a triangle is not as asked for.
  struct Badness {
    double by_angle, by_area;
  };
  /// A triangle that is not as asked for: how far off it was when its corners were these. The worst is taken
  /// first.
  struct Bad {
    double worst;
    std::uint32_t triangle;
    std::array<std::uint32_t, 3> corners;
    friend bool operator<(const Bad& a, const Bad& b) {
      return a.worst != b.worst ? a.worst < b.worst : a.triangle > b.triangle;
    }
  };
  [[nodiscard]] std::array<std::uint32_t, 3> corners(std::uint32_t triangle) const;
  [[nodiscard]] Badness badness(std::uint32_t triangle) const;
  [[nodiscard]] bool is_at_input_angle(std::uint32_t triangle) const;
  [[nodiscard]] bool are_across(std::uint32_t p, std::uint32_t q, double share) const;
  [[nodiscard]] DVec2 center(std::uint32_t triangle) const;
  [[nodiscard]] bool is_inside(std::uint32_t h) const { return !all_.marks().is_outside(h >> 2); }
  [[nodiscard]] bool is_encroached(std::uint32_t h) const;
  [[nodiscard]] bool is_encroached_by(std::uint32_t h, DVec2 p) const;
  [[nodiscard]] VertexPair ends(std::uint32_t h) const { return {all_.origin(h), all_.target(h)}; }
  [[nodiscard]] bool is_budget_left() const;

  [[nodiscard]] VertexPair constraint_of(std::uint32_t h) const;
  [[nodiscard]] bool is_acute(std::uint32_t h) const;
  void find_acute_ends();
  [[nodiscard]] DVec2 split_place(std::uint32_t h) const;
  [[nodiscard]] Result<bool> split(const VertexPair& edge);
  [[nodiscard]] Result<void> improve(const Bad& bad);
  [[nodiscard]] Result<void> add(DVec2 p, PlaceInTriangles place, VertexPair on);
  void look_at(std::uint32_t triangle);

  ConstrainedTriangles& all_;
  double sine_squared_, max_area_, min_edge_squared_, off_center_;
  std::size_t max_points_, points_ = 0;
  std::uint32_t first_;         // vertex that refinement added
  std::vector<VertexPair> on_;  // for each of these the ends of the constraint it lies on, or kInvalid
  std::set<VertexPair>
      acute_;  // ends of constraints, with the other one, where the angle to another is acute
  std::priority_queue<Bad> bad_;
  std::deque<VertexPair> encroached_;
  std::vector<std::uint32_t> seen_;  // for each triangle the search that saw it
  std::uint32_t search_ = 0;
  std::vector<std::uint32_t> cavity_;
  std::vector<VertexPair> in_the_way_;
};

}  // namespace vkmesh::detail
