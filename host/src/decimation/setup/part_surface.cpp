#include "decimation/setup/part_surface.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include <vkmesh/mesh/handles.h>

#include "base/disjoint_sets.h"
#include "mesh/edge_records.h"
#include "mesh/triangle_half_edges.h"

namespace vkmesh::detail {
namespace {

class Parting {
 public:
  Parting(std::size_t points, std::span<const std::uint32_t> corners, std::span<const std::uint32_t> wedges)
      : points_(points), corners_(corners), wedges_(wedges), mate_(corners.size(), kInvalid) {
    result_.corners.assign(corners.begin(), corners.end());
    result_.parted.assign(points, 0);
  }

  /// Joins the faces of every edge, and parts points whose faces have no edge in common.
  void join_faces() {
    DisjointSets umbrellas(corners_.size());
    for_each_edge_group([&](std::uint32_t a, std::uint32_t b, std::span<const std::uint64_t> uses) {
      const auto first = static_cast<std::uint32_t>(uses[0]);
      for (const std::uint64_t use : uses) {
        const auto h = static_cast<std::uint32_t>(use);
        umbrellas.unite(end_at(first, a), end_at(h, a));
        umbrellas.unite(end_at(first, b), end_at(h, b));
      }
      if (uses.size() > 1 && !join_at(a, uses)) result_.parted[a] = result_.parted[b] = 1;
    });
    std::vector<std::uint32_t> umbrella_of(points_, kInvalid);
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      std::uint32_t& umbrella = umbrella_of[corners_[c]];
      if (umbrella == kInvalid) umbrella = umbrellas.find(c);
      if (umbrella != umbrellas.find(c)) result_.parted[corners_[c]] = 1;
    }
  }

  /// Gives each fan of joined faces a vertex of its own.
  PartedSurface name_vertices() {
    for (bool again = true; again;) {
      again = false;
      name_fans();
      // Where fans meet at both ends of an edge it still has more than two faces: all of these part.
      for_each_edge_group([&](std::uint32_t, std::uint32_t, std::span<const std::uint64_t> uses) {
        if (uses.size() <= 2) return;
        for (const std::uint64_t use : uses) {
          const auto h = static_cast<std::uint32_t>(use);
          if (mate_[h] == kInvalid) continue;
          mate_[mate_[h]] = kInvalid;
          mate_[h] = kInvalid;
          result_.parted[corners_[h]] = result_.parted[corners_[next_in_triangle(h)]] = 1;
          again = true;
        }
      });
    }
    return std::move(result_);
  }

 private:
  /// Edges by the vertices as they are named now.
  template <class Visit>
  void for_each_edge_group(Visit&& visit) {
    const std::size_t vertices = std::max(points_, result_.point_of.size());
    EdgeRecords records = distribute_edges(vertices, result_.corners, {}, corners_.size() / 3);
    records.for_each_group(0, vertices, visit);
  }

  [[nodiscard]] std::uint32_t end_at(std::uint32_t h, std::uint32_t point) const {
    return corners_[h] == point ? h : next_in_triangle(h);
  }
  /// Whether faces at an edge have their third corners at one point: each is the other's reverse.
  [[nodiscard]] bool alike(std::uint32_t h, std::uint32_t g) const {
    return corners_[previous_in_triangle(h)] == corners_[previous_in_triangle(g)];
  }
  bool join(std::uint32_t h, std::uint32_t g) {
    if (alike(h, g)) return false;
    mate_[h] = g;
    mate_[g] = h;
    return true;
  }

  /// `a` is an end of the edge. False where faces stay unjoined that are not the two sides of a card.
  bool join_at(std::uint32_t a, std::span<const std::uint64_t> uses) {
    at_edge_.clear();
    for (const std::uint64_t use : uses) {
      const auto h = static_cast<std::uint32_t>(use);
      const std::uint32_t from = wedges_[h], to = wedges_[next_in_triangle(h)];
      at_edge_.push_back(corners_[h] == a ? Side{from, to, true, h} : Side{to, from, false, h});
    }
    up_.clear();
    down_.clear();
    const auto add = [&](const Side& side) { (side.up ? up_ : down_).push_back(side.half_edge); };
    if (uses.size() == 2) {
      std::for_each(at_edge_.begin(), at_edge_.end(), add);
      if (up_.size() == 1) join(up_[0], down_[0]);
      return up_.size() == 1;
    }
    const auto wedges_of = [](const Side& side) { return std::pair(side.wedge_a, side.wedge_b); };
    std::sort(at_edge_.begin(), at_edge_.end(), [&](const Side& x, const Side& y) {
      return std::tuple(x.wedge_a, x.wedge_b, x.half_edge) < std::tuple(y.wedge_a, y.wedge_b, y.half_edge);
    });
    for (std::size_t i = 0, end = 0; i < at_edge_.size(); i = end) {
      while (end < at_edge_.size() && wedges_of(at_edge_[end]) == wedges_of(at_edge_[i])) ++end;
      const bool joined = end - i == 2 && at_edge_[i].up != at_edge_[i + 1].up &&
                          join(at_edge_[i].half_edge, at_edge_[i + 1].half_edge);
      if (!joined)
        std::for_each(at_edge_.begin() + static_cast<std::ptrdiff_t>(i),
                      at_edge_.begin() + static_cast<std::ptrdiff_t>(end), add);
    }
    if (up_.size() == 1 && down_.size() == 1) return join(up_[0], down_[0]);
    if (up_.size() != 2 || down_.size() != 2) return up_.empty() && down_.empty();
    const bool straight = !alike(up_[0], down_[0]) && !alike(up_[1], down_[1]);
    const bool crossed = !alike(up_[0], down_[1]) && !alike(up_[1], down_[0]);
    if (straight == crossed) return false;
    join(up_[0], down_[straight ? 0 : 1]);
    join(up_[1], down_[straight ? 1 : 0]);
    return true;
  }

  /// The first fan of a point keeps it, others get copies.
  void name_fans() {
    DisjointSets fans(corners_.size());
    for (std::uint32_t h = 0; h < mate_.size(); ++h)
      if (const std::uint32_t g = mate_[h]; g != kInvalid && h < g) {
        fans.unite(h, next_in_triangle(g));
        fans.unite(next_in_triangle(h), g);
      }
    result_.point_of.resize(points_);
    std::iota(result_.point_of.begin(), result_.point_of.end(), 0u);
    std::vector<std::uint8_t> taken(points_, 0);
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      const std::uint32_t fan = fans.find(c);
      if (fan != c) {
        result_.corners[c] = result_.corners[fan];
      } else if (!std::exchange(taken[corners_[c]], std::uint8_t{1})) {
        result_.corners[c] = corners_[c];
      } else {
        result_.corners[c] = static_cast<std::uint32_t>(result_.point_of.size());
        result_.point_of.push_back(corners_[c]);
      }
    }
  }

  /// A face at an edge.
  struct Side {
    std::uint32_t wedge_a, wedge_b;  ///< Its wedges at the ends of the edge.
    bool up;                         ///< It runs from a to b.
    std::uint32_t half_edge;
  };

  std::size_t points_;
  std::span<const std::uint32_t> corners_, wedges_;
  std::vector<std::uint32_t> mate_;  ///< The half-edge across each one's edge, or kInvalid.
  PartedSurface result_;
  std::vector<Side> at_edge_;
  std::vector<std::uint32_t> up_, down_;
};

}  // namespace

PartedSurface part_surface(std::size_t points, std::span<const std::uint32_t> corners,
                           std::span<const std::uint32_t> wedges) {
  Parting parting(points, corners, wedges);
  parting.join_faces();
  return parting.name_vertices();
}

}  // namespace vkmesh::detail
