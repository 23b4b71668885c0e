// A constrained Delaunay triangulation while it is made: segments and points are put into it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/planar/constrained_delaunay.h>

#include "planar/edge_marks.h"
#include "planar/insertion.h"

namespace vkmesh::detail {

/// Two vertices.
using VertexPair = std::array<std::uint32_t, 2>;

/// Where a walk along a straight line ended.
struct EndOfWalk {
  enum What : std::uint8_t { kVertex, kOnEdge, kInTriangle, kFixedEdge, kOutside };
  What what;
  /// The vertex; the edge that holds the point; a half-edge of the triangle that does; the fixed edge before
  /// the point; a half-edge at infinity that the point lies beyond.
  std::uint32_t index;

  [[nodiscard]] PlaceInTriangles place() const { return {index, what == kOnEdge}; }
};

class ConstrainedTriangles {
 public:
  /// Takes a mesh that delaunay() made, with the places of its vertices. Results depend on nothing else.
  ConstrainedTriangles(const HalfEdgeMesh& mesh, std::vector<DVec2> places);

  [[nodiscard]] const std::vector<DVec2>& places() const { return places_; }
  [[nodiscard]] DVec2 place(std::uint32_t v) const { return places_[v]; }
  [[nodiscard]] const PlanarTriangles& triangles() const { return insertion_.triangles(); }
  [[nodiscard]] const EdgeMarks& marks() const { return insertion_.marks(); }
  [[nodiscard]] EdgeMarks& marks() { return insertion_.marks(); }
  [[nodiscard]] const FilteredPredicates& predicates() const { return insertion_.predicates(); }
  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return triangles().origin(h); }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return origin(PlanarTriangles::next(h)); }
  [[nodiscard]] std::uint32_t apex(std::uint32_t h) const { return origin(PlanarTriangles::previous(h)); }
  [[nodiscard]] std::uint32_t twin(std::uint32_t h) const { return triangles().twin(h); }
  [[nodiscard]] int orientation(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return predicates().orientation(places_[a], places_[b], places_[c]);
  }

  [[nodiscard]] PlanarTriangles take_triangles() { return std::move(insertion_.triangles()); }
  [[nodiscard]] std::vector<DVec2> take_places() { return std::move(places_); }
  [[nodiscard]] std::vector<AddedVertex> take_added() { return std::move(added_); }

  /// Makes the segment from a to b edges, and keeps them. Where it meets a fixed edge between the ends of
  /// both they are split, as constrained_delaunay() says; after so many splits: the ends of that edge.
  [[nodiscard]] Result<std::optional<VertexPair>> insert_segment(std::uint32_t a, std::uint32_t b,
                                                                 std::size_t most_splits);
  [[nodiscard]] std::size_t crossings() const { return crossings_; }

  /// Calls f(u, v) for each edge of the segment from a to b, in order.
  template <class F>
  void for_each_part(std::uint32_t a, std::uint32_t b, F&& f) const {
    std::vector<VertexPair> waiting = {{a, b}};
    while (!waiting.empty()) {
      const auto [u, v] = waiting.back();
      waiting.pop_back();
      if (const auto split = splits_.find(key(u, v)); split != splits_.end()) {
        waiting.push_back({split->second, v});
        waiting.push_back({u, split->second});
      } else {
        f(u, v);
      }
    }
  }
  /// The half-edge from u to v, or kInvalid.
  [[nodiscard]] std::uint32_t half_edge(std::uint32_t u, std::uint32_t v) const;

  /// Adds a vertex there. Errors: too many.
  [[nodiscard]] Result<std::uint32_t> add_vertex(DVec2 p, PlaceInTriangles place);

  /// Walks on from `from`, whose triangle with the edge h across the line to p enters. With `stops_at_fixed`
  /// it ends at edges that are fixed, and at vertices on the way that have such.
  [[nodiscard]] EndOfWalk walk_over(std::uint32_t from, std::uint32_t h, DVec2 p, bool stops_at_fixed) const;

 private:
  /// A half-edge that leaves the vertex: the line to a point runs along it or, where `along` is false, into
  /// its triangle. At infinity where it leaves the hull.
  struct Wedge {
    std::uint32_t half_edge;
    bool along;
  };
  /// Where the line from a to b, both vertices, first meets anything: a vertex, or a fixed edge, which it
  /// crosses. Notes what it crosses before.
  struct Meeting {
    bool at_vertex;
    std::uint32_t index;
  };

  static std::uint64_t key(std::uint32_t u, std::uint32_t v) {
    return u < v ? std::uint64_t{u} << 32 | v : std::uint64_t{v} << 32 | u;
  }
  /// Whether c, on the line from a through b, lies on b's side.
  static bool is_ahead(DVec2 a, DVec2 b, DVec2 c);
  [[nodiscard]] Wedge wedge(std::uint32_t a, DVec2 p) const;
  [[nodiscard]] EndOfWalk walk(std::uint32_t a, DVec2 p) const;
  [[nodiscard]] Meeting meet(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] std::uint32_t fixed_edge_at(std::uint32_t v) const;

  /// An edge beside a segment: a half-edge of a triangle that the segment crosses.
  struct Side {
    std::uint32_t origin, beyond;  // where it is inner, the number of the other one
    std::uint32_t replaced_by;
    std::uint8_t kind;
    bool is_inner;  // the segment crosses the triangles on both of its sides
  };
  /// A corner of what is left of a polygon, with the edge that leads there: the number of a side, or a
  /// half-edge.
  struct Corner {
    std::uint32_t vertex, edge;
    bool is_side;
  };

  /// Makes the segment an edge, of which meet() was asked last.
  void make_edge(std::uint32_t a, std::uint32_t b);
  void gather(std::span<const std::uint32_t> half_edges, std::vector<Side>& sides);
  /// Triangulates what lies between the segment and its sides, which go from one of its ends around to the
  /// other, by cutting corners: each can be seen from the segment, in this order. Returns the half-edge from
  /// `end` to the first. O(sides).
  std::uint32_t fill(std::vector<Side>& sides, std::uint32_t end, std::size_t& record);
  void fix(std::uint32_t h);
  void swap_to_delaunay();
  /// Whether an edge may be replaced by one to x and one from there, where x lies `distance` from the edge:
  /// that is some units in the last place, and both are shorter, so that this ends.
  [[nodiscard]] bool may_split(const VertexPair& edge, std::uint32_t x, double distance) const;
  [[nodiscard]] Result<void> split_crossing(std::uint32_t a, std::uint32_t b, std::uint32_t h);
  void add_room();

  std::vector<DVec2> places_;
  std::vector<AddedVertex> added_;
  Insertion insertion_;
  std::unordered_map<std::uint64_t, std::uint32_t> splits_;  // of segments: a vertex between their ends
  std::size_t crossings_ = 0;

  // What the segment that is being inserted needs.
  std::vector<VertexPair> waiting_;
  std::vector<std::uint32_t> crossed_, left_, right_;  // triangles; half-edges of them beside the segment
  std::vector<std::uint32_t> suspects_;                // half-edges that need not be Delaunay
  std::vector<Side> left_sides_, right_sides_;
  std::vector<Corner> stack_;
};

}  // namespace vkmesh::detail
