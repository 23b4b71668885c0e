// What is around vertices that may be removed.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/prefetch.h"
#include "decimation/cost/retriangulation.h"
#include "decimation/legality/wedges.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// What leaves a vertex counter-clockwise, and where to. A boundary vertex has the apex at the end of the
/// last.
struct VertexStar {
  static constexpr std::size_t kMaxNeighbours = RetriangulationBatch::kMaxNeighbours;

  std::uint32_t vertex, edges;  // edges: how many
  bool closed;
  std::array<std::uint32_t, kMaxNeighbours + 1> edge, target;
  SeamSides sides;  // with attributes

  [[nodiscard]] std::size_t neighbours() const { return closed ? edges : edges - 1; }
  [[nodiscard]] std::span<const std::uint32_t> all_edges() const { return std::span(edge).first(edges); }
};

/// The stars of up to kStars vertices.
template <std::size_t kStars>
class VertexStars {
 public:
  /// `wedges`: none without attributes.
  VertexStars(const CollapseMesh& mesh, const Wedges* wedges)
      : mesh_(mesh), vertices_(mesh.vertices), wedges_(wedges) {}

  /// Walks around these vertices, one step of each in turn: one waits for all. Puts their stars in
  /// order of their numbers of neighbours; has_too_many(v) is called for those of more than kMaxNeighbours.
  template <class TooMany>
  void walk(std::span<const std::uint32_t> ids, TooMany&& has_too_many) {
    std::array<std::uint32_t, kStars> at, start, who;
    for (const std::uint32_t v : ids) prefetch(&vertices_[v]);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      at[i] = start[i] = vertices_[ids[i]].leading;
      who[i] = static_cast<std::uint32_t>(i);
      prefetch(&mesh_.face(at[i]));
      walked_[i].vertex = ids[i];
      walked_[i].closed = true;
    }
    std::size_t left = ids.size();
    for (std::uint32_t step = 0; step <= kMaxNeighbours && left > 0; ++step) {
      const std::size_t now = left;
      left = 0;
      for (std::size_t i = 0; i < now; ++i) {
        const std::uint32_t h = at[i], out = mesh_.around_vertex(h), v = mesh_.target(h);
        VertexStar& star = walked_[who[i]];
        prefetch(&vertices_[v]);
        prefetch(&mesh_.face(out));
        star.edge[step] = h;
        star.target[step] = v;
        star.edges = step + 1;
        star.closed &= v != mesh_.apex();
        at[left] = out;
        start[left] = start[i];
        who[left] = who[i];
        left += out != start[i] ? 1 : 0;
      }
    }
    for (std::size_t i = 0; i < left; ++i) walked_[who[i]].edges = kTooMany;
    std::array<std::uint32_t, kMaxNeighbours + 2> first{};
    for (std::size_t i = 0; i < ids.size(); ++i) {
      VertexStar& star = walked_[i];
      if (star.edges == kTooMany || star.neighbours() > kMaxNeighbours) {
        star.edges = kTooMany;
        has_too_many(star.vertex);
        continue;
      }
      if (!star.closed) put_apex_last(star);
      if (wedges_ != nullptr) find_sides(star);
      ++first[star.neighbours() + 1];
    }
    for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
    first_ = first;
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (walked_[i].edges != kTooMany)
        order_[first[walked_[i].neighbours()]++] = static_cast<std::uint32_t>(i);
  }

  /// Of a star among the vertices that were walked around.
  [[nodiscard]] std::size_t index_of(const VertexStar& star) const {
    return static_cast<std::size_t>(&star - walked_.data());
  }

  [[nodiscard]] const VertexStar& operator[](std::size_t index) const { return walked_[index]; }
  /// Indices in order of the numbers of neighbours, but for those of too many. Those of n neighbours begin at
  /// first(n), up to first(n + 1).
  [[nodiscard]] std::span<const std::uint32_t> in_order() const {
    return std::span(order_).first(first_[kMaxNeighbours + 1]);
  }
  [[nodiscard]] std::size_t first(std::size_t neighbours) const { return first_[neighbours]; }

 private:
  static constexpr std::size_t kMaxNeighbours = VertexStar::kMaxNeighbours;
  static constexpr std::uint32_t kTooMany = ~0u;

  void put_apex_last(VertexStar& star) const {
    const auto end = star.target.begin() + star.edges;
    begin_at(star, std::find(star.target.begin(), end, mesh_.apex()) - star.target.begin() + 1);
  }
  static void begin_at(VertexStar& star, std::ptrdiff_t i) {
    std::rotate(star.target.begin(), star.target.begin() + i, star.target.begin() + star.edges);
    std::rotate(star.edge.begin(), star.edge.begin() + i, star.edge.begin() + star.edges);
  }

  /// By the seam through the vertex, if any; the first edge is then of it.
  void find_sides(VertexStar& star) const {
    const auto is_seam = [&](std::uint32_t h) { return wedges_->is_seam(mesh_, h); };
    if (wedges_->on_seam(star.vertex))
      begin_at(star,
               std::find_if(star.edge.begin(), star.edge.begin() + star.edges, is_seam) - star.edge.begin());
    star.sides = wedges_->sides(mesh_, star.all_edges(), star.neighbours());
  }

  const CollapseMesh& mesh_;
  const LargeArray<VertexRecord>& vertices_;
  const Wedges* wedges_;
  std::array<VertexStar, kStars> walked_;
  std::array<std::uint32_t, kStars> order_;
  std::array<std::uint32_t, kMaxNeighbours + 2> first_{};  // of each number of neighbours, in order_
};

}  // namespace vkmesh::detail
