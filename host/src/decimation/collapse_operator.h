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
#include "mesh/edit/one_ring.h"

namespace vkmesh::detail {

/// Judges and carries out collapses of edges of a mesh, with attributes or without. It knows the surroundings
/// of one edge at a time.
template <bool kAttributes>
class CollapseOperator {
 public:
  explicit CollapseOperator(CollapseMesh& mesh) : mesh_(mesh), vertices_(mesh.vertices) {}

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

  /// Looks around an edge; see CollapseNeighbourhood.
  const CollapseNeighbourhood& look_around(const OneRing& p, const OneRing& q) {
    neighbourhood_.set(vertices_, p, q);
    return neighbourhood_;
  }
  [[nodiscard]] const CollapseNeighbourhood& neighbourhood() const { return neighbourhood_; }

  /// The collapse of the edge around which it has looked last, as judge() takes it.
  struct Change : AlwaysLegal {
    CollapseOperator& collapse_operator;
    const DueEdge& due;
    std::uint32_t p, q;
    float cos_deviation;  // a face may turn by so much

    [[nodiscard]] bool meets_link_condition() const {
      const auto &ring_p = collapse_operator.neighbourhood_.ring_p().vertices,
                 &ring_q = collapse_operator.neighbourhood_.ring_q().vertices;
      if (ring_p.size() > 2 && !collapse_operator.neighbourhood_.may_share_more())
        return ring_p.front() != ring_p.back();
      return detail::meets_link_condition(ring_p, ring_q, collapse_operator.sorted_);
    }
    [[nodiscard]] bool folds_over() const {
      return detail::folds_over(collapse_operator.neighbourhood_, collapse_operator.vertices_[p].position,
                                collapse_operator.vertices_[q].position, due.x, cos_deviation);
    }
  };
  /// squared_distance_of_collapse() of the same edge.
  [[nodiscard]] float squared_distance(const DueEdge& due, std::uint32_t p, std::uint32_t q,
                                       float allowed) const {
    return squared_distance_of_collapse(neighbourhood_, vertices_[p].position, vertices_[q].position, due.x,
                                        allowed);
  }

  /// Which of two vertices goes, the half-edge from it to the other, and its other neighbours.
  struct Plan {
    std::uint32_t half_edge, gone, kept;
    OneRing others;
  };
  /// Decides which end goes: as the placement has chosen, else that of fewer neighbours, which is less work.
  [[nodiscard]] Plan plan(const DecimationState& state, const DueEdge& due, std::uint32_t p,
                          std::uint32_t q) const {
    const OneRing &ring_p = neighbourhood_.ring_p(), &ring_q = neighbourhood_.ring_q();
    const std::size_t at_p = ring_p.size(), at_q = ring_q.size();
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
    return {h, p ^ q ^ kept, kept, keep_p ? ring_q : ring_p};
  }

  /// Adds up the quadrics, and makes one vertex of two. Both are touched then. `bucket` is for the history.
  CollapseMesh::Collapsed carry_out(DecimationState& state, const DueEdge& due, const Plan& plan,
                                    std::uint32_t bucket) {
    const std::uint32_t h = plan.half_edge;
    VertexRecord &kept = vertices_[plan.kept], &gone = vertices_[plan.gone];
    const bool from_p = h == due.half_edge;
    const std::uint32_t p = from_p ? plan.gone : plan.kept, q = from_p ? plan.kept : plan.gone;
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
      if (const float weight = state.attributes->weight(plan.kept); weight > 0)
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
    const CollapseMesh::Collapsed collapsed = mesh_.collapse(h, plan.others.edges);
    state.faces -= collapsed.faces;
    --state.vertices;
    ++state.outcome.collapses;
    if (kept.weight > 0)
      state.outcome.error2 =
          std::max(state.outcome.error2, static_cast<double>(geometric) / static_cast<double>(kept.weight));
    return collapsed;
  }

 private:
  /// The collapse's cost without its attribute term.
  [[nodiscard]] float geometric_cost(const DecimationState& state, const DueEdge& due, std::uint32_t p,
                                     std::uint32_t q) const {
    if constexpr (kAttributes) return state.attributes->geometric_cost(p, q, due.x);
    return due.cost;
  }

  CollapseMesh& mesh_;
  LargeArray<VertexRecord>& vertices_;
  CollapseNeighbourhood neighbourhood_;
  std::vector<std::uint32_t> sorted_;
};

}  // namespace vkmesh::detail
