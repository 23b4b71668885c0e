// Stars of vertices that may be removed.
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
#include "mesh/edit/one_ring.h"

namespace vkmesh::detail {

/// A vertex and all that leaves it, counter-clockwise. A boundary vertex has the apex as the last neighbour.
struct VertexStar {
  static constexpr std::uint32_t kMaxNeighbours = RetriangulationBatch::kMaxNeighbours;

  std::uint32_t vertex;
  bool closed;
  FixedRing<kMaxNeighbours + 2> ring;  // room for the apex, and for one too many
  SeamSides sides;                     // with attributes

  [[nodiscard]] std::size_t neighbours() const { return ring.size - (closed ? 0 : 1); }
  [[nodiscard]] std::span<const std::uint32_t> edges() const { return std::span(ring.edge).first(ring.size); }
};

/// The stars of up to kStars vertices.
template <std::size_t kStars>
class VertexStars {
 public:
  /// `wedges`: none without attributes.
  VertexStars(const CollapseMesh& mesh, const Wedges* wedges)
      : mesh_(mesh), vertices_(mesh.vertices), wedges_(wedges) {}

  /// Gathers the stars of these vertices, in order of their numbers of neighbours; has_too_many(v) is called
  /// for those of more than kMaxNeighbours.
  template <class TooMany>
  void walk(std::span<const std::uint32_t> ids, TooMany&& has_too_many) {
    for (const std::uint32_t v : ids) prefetch(&vertices_[v]);
    walks_.start(kMaxNeighbours + 1);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const std::uint32_t h = vertices_[ids[i]].leading;
      prefetch(&mesh_.face(h));
      walked_[i].vertex = ids[i];
      walked_[i].closed = true;
      walks_.add(h, h, walked_[i]);
    }
    walks_.walk(
        mesh_,
        [this](VertexStar& star, std::uint32_t number, const RingStep& step, bool is_last) {
          prefetch(&vertices_[step.vertex]);
          const std::uint32_t i = is_last ? 0 : number + 1;  // the leading half-edge comes first
          star.ring.edge[i] = step.edge;
          star.ring.vertex[i] = step.vertex;
          star.ring.size = number + 1;
          star.closed &= step.vertex != mesh_.apex();
          return true;
        },
        [](VertexStar& star) { star.ring.size = star.ring.kTooLong; });
    std::array<std::uint32_t, kMaxNeighbours + 2> first{};
    for (std::size_t i = 0; i < ids.size(); ++i) {
      VertexStar& star = walked_[i];
      if (!star.ring.is_whole() || star.neighbours() > kMaxNeighbours) {
        star.ring.size = star.ring.kTooLong;
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
      if (walked_[i].ring.is_whole())
        order_[first[walked_[i].neighbours()]++] = static_cast<std::uint32_t>(i);
  }

  /// The index of a star among those that were gathered.
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

  void put_apex_last(VertexStar& star) const {
    const auto end = star.ring.vertex.begin() + star.ring.size;
    begin_at(star, std::find(star.ring.vertex.begin(), end, mesh_.apex()) - star.ring.vertex.begin() + 1);
  }
  static void begin_at(VertexStar& star, std::ptrdiff_t i) {
    std::rotate(star.ring.vertex.begin(), star.ring.vertex.begin() + i,
                star.ring.vertex.begin() + star.ring.size);
    std::rotate(star.ring.edge.begin(), star.ring.edge.begin() + i, star.ring.edge.begin() + star.ring.size);
  }

  /// Finds the sides of the seam through the vertex, if any; the first edge is then on it.
  void find_sides(VertexStar& star) const {
    const auto is_seam = [&](std::uint32_t h) { return wedges_->is_seam(mesh_, h); };
    if (wedges_->on_seam(star.vertex))
      begin_at(star, std::find_if(star.ring.edge.begin(), star.ring.edge.begin() + star.ring.size, is_seam) -
                         star.ring.edge.begin());
    star.sides = wedges_->sides(mesh_, star.edges(), star.neighbours());
  }

  const CollapseMesh& mesh_;
  const LargeArray<VertexRecord>& vertices_;
  const Wedges* wedges_;
  RingWalks<VertexStar> walks_;
  std::array<VertexStar, kStars> walked_;
  std::array<std::uint32_t, kStars> order_;
  std::array<std::uint32_t, kMaxNeighbours + 2> first_{};  // of each number of neighbours, in order_
};

}  // namespace vkmesh::detail
