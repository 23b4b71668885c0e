// What is judged and done when an edge collapses, whoever chooses it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/decimation/decimate.h>

#include "decimation/collapse_neighbourhood.h"
#include "decimation/cost/attribute_quadrics.h"
#include "decimation/cost/edge_batch.h"
#include "decimation/cost/tangential_drift.h"
#include "decimation/decimation_state.h"
#include "decimation/legality/fold_over.h"
#include "decimation/legality/judge.h"
#include "decimation/vertex_record.h"
#include "mesh/edit/link_condition.h"

namespace vkmesh::detail {

/// The neighbours of p but q and those of q but p, counter-clockwise, and the half-edges from p and q to
/// them. What follows the neighbours up to a multiple of CollapseNeighbourhood::kBlock is there, too.
struct EdgeRings {
  using Ring = std::span<const std::uint32_t>;
  Ring p, q, from_p, from_q;
};

/// Edges of a mesh, with attributes or without. It knows the surroundings of one edge at a time.
template <bool kAttributes>
class EdgeMerger {
 public:
  explicit EdgeMerger(CollapseMesh& mesh) : mesh_(mesh), vertices_(mesh.vertices) {}

  /// Where the kept vertex comes to lie.
  [[nodiscard]] static std::array<float, 3> place_of(const VertexRecord& p, const VertexRecord& q,
                                                     std::int32_t end, const std::array<float, 3>& x) {
    if (end != EdgeBatch::kFree) return end == EdgeBatch::kAtP ? p.position : q.position;
    return {p.position[0] + x[0], p.position[1] + x[1], p.position[2] + x[2]};
  }

  [[nodiscard]] bool exceeds_error(const DecimationState& state, const DueEdge& due, std::uint32_t p,
                                   std::uint32_t q) const {
    const double weight = static_cast<double>(vertices_[p].weight) + static_cast<double>(vertices_[q].weight);
    return static_cast<double>(geometric_cost(state, due, p, q)) > state.limits.error2 * weight;
  }

  /// Makes these the surroundings. Returns the flags of all their vertices.
  std::uint32_t look_around(const EdgeRings& rings) {
    summary_ = neighbourhood_.set(vertices_, rings.p, rings.q);
    return summary_.flags;
  }
  [[nodiscard]] std::uint32_t flags_around() const { return summary_.flags; }

  /// The collapse of the edge around which it was looked, as judge() takes it.
  struct Change : AlwaysLegal {
    EdgeMerger& merger;
    const DueEdge& due;
    std::uint32_t p, q;
    EdgeRings& rings;
    float cos_deviation;  // a face may turn by so much

    [[nodiscard]] bool meets_link_condition() const {
      // Rings of a usual size were compared when it was looked around.
      const bool are_compared = std::max(rings.p.size(), rings.q.size()) <= 8 + 2 && rings.p.size() > 2;
      if (are_compared && !merger.summary_.may_share) return rings.p.front() != rings.p.back();
      return detail::meets_link_condition(rings.p, rings.q, merger.sorted_);
    }
    [[nodiscard]] bool folds_over() const {
      return detail::folds_over(merger.neighbourhood_, merger.vertices_[p].position,
                                merger.vertices_[q].position, due.x, cos_deviation);
    }
  };
  /// See squared_distance_of_collapse; of the same edge.
  [[nodiscard]] float squared_distance(const DueEdge& due, std::uint32_t p, std::uint32_t q,
                                       float allowed) const {
    return squared_distance_of_collapse(neighbourhood_, vertices_[p].position, vertices_[q].position, due.x,
                                        allowed);
  }

  /// Which of two vertices goes, the half-edge from it to the other, its other neighbours and the half-edges
  /// to them.
  struct Merge {
    std::uint32_t half_edge, gone, kept;
    EdgeRings::Ring ring, others;
  };
  /// What was chosen; else that of fewer neighbours goes, which is less work.
  [[nodiscard]] Merge plan(const DecimationState& state, const DueEdge& due, std::uint32_t p, std::uint32_t q,
                           const EdgeRings& rings) const {
    const std::size_t at_p = rings.p.size(), at_q = rings.q.size();
    const bool is_first =
        (vertices_[p].source & VertexRecord::kSourceMask) < (vertices_[q].source & VertexRecord::kSourceMask);
    bool keep_p = (at_p > at_q) | ((at_p == at_q) & is_first);
    if (due.end != EdgeBatch::kFree) keep_p = due.end == EdgeBatch::kAtP;
    if constexpr (kAttributes) {
      const Wedges& wedges = state.attributes->wedges();
      if (due.end == EdgeBatch::kFree && wedges.on_seam(p) != wedges.on_seam(q)) keep_p = wedges.on_seam(p);
    }
    // Branchless: which end stays is unpredictable.
    const std::uint32_t if_p = 0u - static_cast<std::uint32_t>(keep_p), kept = q ^ ((p ^ q) & if_p);
    const std::uint32_t h = due.half_edge ^ ((due.half_edge ^ mesh_.twin(due.half_edge)) & if_p);
    return {h, p ^ q ^ kept, kept, keep_p ? rings.q : rings.p, keep_p ? rings.from_q : rings.from_p};
  }

  /// Merges the quadrics, and the vertices. Both are touched then. `bucket` is for the history.
  CollapseMesh::Collapsed carry_out(DecimationState& state, const DueEdge& due, const Merge& merge,
                                    std::uint32_t bucket) {
    const std::uint32_t h = merge.half_edge;
    VertexRecord &kept = vertices_[merge.kept], &gone = vertices_[merge.gone];
    const bool from_p = h == due.half_edge;
    const std::uint32_t p = from_p ? merge.gone : merge.kept, q = from_p ? merge.kept : merge.gone;
    const std::array<float, 3> place = place_of(vertices_[p], vertices_[q], due.end, due.x);
    const float geometric = geometric_cost(state, due, p, q);
    std::array<float, 3> dk, dg;
    for (std::size_t k = 0; k < 3; ++k) {
      dk[k] = place[k] - kept.position[k];
      dg[k] = place[k] - gone.position[k];
    }
    const bool moves = place != kept.position;
    if (moves) {
      kept.quadric.shift(dk);
      kept.position = place;
      kept.source |= VertexRecord::kMoved;
    }
    gone.quadric.shift(dg);
    kept.quadric.add(gone.quadric);
    kept.weight += gone.weight;
    if constexpr (kAttributes) {
      state.attributes->collapse(h, dg, dk);
      const double rest = static_cast<double>(due.cost) - static_cast<double>(geometric);
      if (const float weight = state.attributes->weight(merge.kept); weight > 0)
        state.outcome.attribute_error2 =
            std::max(state.outcome.attribute_error2, rest / static_cast<double>(weight));
    }
    kept.source |= VertexRecord::kTouched | (gone.source & VertexRecord::kHasParked);
    gone.source |= VertexRecord::kTouched;
    if (state.keep_events)
      state.outcome.events.push_back({kept.source & VertexRecord::kSourceMask,
                                      gone.source & VertexRecord::kSourceMask,
                                      place,
                                      kept.has(VertexRecord::kMoved),
                                      {mesh_.face(h).source, mesh_.face(mesh_.twin(h)).source},
                                      bucket});
    const CollapseMesh::Collapsed collapsed = mesh_.collapse(h, merge.others);
    state.faces -= collapsed.faces;
    --state.vertices;
    ++state.outcome.collapses;
    if (kept.weight > 0)
      state.outcome.error2 =
          std::max(state.outcome.error2, static_cast<double>(geometric) / static_cast<double>(kept.weight));
    return collapsed;
  }

 private:
  /// Of a collapse: its whole cost, but for what attributes have of it.
  [[nodiscard]] float geometric_cost(const DecimationState& state, const DueEdge& due, std::uint32_t p,
                                     std::uint32_t q) const {
    if constexpr (kAttributes) return state.attributes->geometric_cost(p, q, due.x);
    return due.cost;
  }

  CollapseMesh& mesh_;
  LargeArray<VertexRecord>& vertices_;
  CollapseNeighbourhood neighbourhood_;
  CollapseNeighbourhood::Summary summary_{};
  std::vector<std::uint32_t> sorted_;
};

}  // namespace vkmesh::detail
