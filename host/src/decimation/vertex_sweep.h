// What a surface that is far from its target loses at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "caches.h"
#include "decimation/collapse_mesh.h"
#include "decimation/driver.h"
#include "decimation/edge_merger.h"
#include "decimation/sweep_batch.h"
#include "decimation/territories.h"

namespace vkmesh::detail {

/// Merges vertices into neighbours in the order of memory, with no queue, up to a cost: what goes first of so
/// many leaves hardly a trace in the end. Each vertex goes to where that costs least, where the surface is
/// smooth, and those that stay do not move; the collapses that follow place them anew, by all the planes.
class VertexSweep {
 public:
  /// Whether a large surface is so far from its target, and no error is promised, that the order of what goes
  /// first hardly matters. A history tells that order.
  [[nodiscard]] static bool is_worth_while(const DecimationState& state) {
    constexpr std::size_t kFew = 8;
    return state.mesh.face_count() >= 2 * state.part_faces && state.criteria == nullptr &&
           !state.keep_events && state.limits.error2 == std::numeric_limits<double>::infinity() &&
           state.faces >= kFew * state.limits.faces && state.vertices >= kFew * state.limits.vertices;
  }
  /// The costliest tenth of the vertices is left to the queue, and what costs as much by then.
  static constexpr double kShare = 0.9;

  VertexSweep(CollapseMesh& mesh, EdgeMerger<false>& merger)
      : mesh_(mesh), vertices_(mesh.vertices), merger_(merger) {}

  /// What this share of the vertices would cost at most, by a sample; 0 where there are none.
  [[nodiscard]] float cost_of_share(double share) {
    constexpr std::size_t kSample = 4096;
    std::vector<float> costs;
    std::vector<std::uint32_t> some;
    for (std::uint32_t k = 0; k < kSample; ++k) {
      const auto v = static_cast<std::uint32_t>(spread_evenly(k, mesh_.apex()));
      if (is_candidate(v)) some.push_back(v);
      if (some.size() < SweepBatch::kSize && k + 1 < kSample) continue;
      batch_->set(mesh_, some);
      for (std::size_t i = 0; i < batch_->count; ++i)
        if (batch_->has_best(i)) costs.push_back(batch_->cost_of(i));
      some.clear();
    }
    if (costs.empty()) return 0;
    const auto nth =
        costs.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(costs.size() - 1));
    std::nth_element(costs.begin(), nth, costs.end());
    return *nth;
  }

  /// Sweeps a part, or all. No vertex goes at more than this cost.
  void run(DecimationState& state, const Territory& part, float most) {
    std::vector<std::uint32_t> candidates;
    candidates.reserve(kAtOnce);
    part.for_each(mesh_.apex(), [&](std::uint32_t v) {
      if (!is_candidate(v)) return;
      prefetch(mesh_.faces() + vertices_[v].leading / 4);
      candidates.push_back(v);
      if (candidates.size() < kAtOnce) return;
      sweep(state, part, candidates, most);
      candidates.clear();
    });
    sweep(state, part, candidates, most);
  }

 private:
  /// Batches are taken from so many candidates that they stay in the second cache, and of distant ones:
  /// neighbours in a batch would come in each other's way.
  static constexpr std::size_t kApart = 16, kAtOnce = kApart * SweepBatch::kSize;

  [[nodiscard]] bool is_candidate(std::uint32_t v) const {
    return vertices_[v].alive() && !vertices_[v].has(CollapseVertex::kLocked);
  }

  void sweep(DecimationState& state, const Territory& part, std::span<const std::uint32_t> candidates,
             float most) {
    std::array<std::uint32_t, SweepBatch::kSize> some;
    for (std::size_t first = 0; first < kApart; ++first) {
      std::size_t count = 0;
      for (std::size_t k = first; k < candidates.size(); k += kApart) {
        some[count] = candidates[k];
        count += vertices_[candidates[k]].alive() ? 1 : 0;
      }
      batch_->set(mesh_, std::span(some).first(count));
      sweep_batch(state, part, most);
    }
  }

  void sweep_batch(DecimationState& state, const Territory& part, float most) {
    const SweepBatch& batch = *batch_;
    std::array<std::uint8_t, SweepBatch::kSize> due;
    std::size_t due_count = 0;
    for (std::size_t i = 0; i < batch.count; ++i) {
      due[due_count] = static_cast<std::uint8_t>(i);
      due_count +=
          static_cast<std::size_t>(batch.has_best(i)) & static_cast<std::size_t>(batch.cost_of(i) <= most);
    }
    for (const std::uint8_t i : std::span(due).first(due_count))
      at_target_[i].walk(mesh_, mesh_.twin(batch.ring[i].edge[batch.best_of(i)]));
    for (const std::uint8_t i : std::span(due).first(due_count)) attempt(state, part, i);
    for (const std::uint32_t v : touched_) vertices_[v].source &= ~CollapseVertex::kTouched;
    touched_.clear();
  }

  void attempt(DecimationState& state, const Territory& part, std::size_t i) {
    const SweepBatch& batch = *batch_;
    const SweepBatch::Ring &at_p = batch.ring[i], &at_q = at_target_[i];
    const std::uint32_t best = batch.best_of(i), h = at_p.edge[best];
    const std::uint32_t p = batch.vertex[i], q = at_p.vertex[best];
    const std::uint32_t size = at_q.size(mesh_.twin(h));
    const CollapseVertex &vp = vertices_[p], &vq = vertices_[q];
    if (size == 0 || ((vp.source | vq.source) & CollapseVertex::kTouched) != 0 || !part.holds(q)) return;
    const auto some = [](const std::array<std::uint32_t, 3 * SweepBatch::kMost>& words, std::size_t first,
                         std::size_t count) { return EdgeRings::Ring(words).subspan(first, count); };
    const EdgeRings rings{some(at_p.vertex, best + 1, batch.size[i] - 1), some(at_q.vertex, 0, size - 1),
                          some(at_p.edge, best + 1, batch.size[i] - 1), some(at_q.edge, 0, size - 1)};
    // The rings are as they were unless a vertex of theirs went.
    if ((merger_.look_around(rings) & kWent) != 0) return;
    const DueEdge edge{
        h,
        batch.cost_of(i),
        2,
        {vq.position[0] - vp.position[0], vq.position[1] - vp.position[1], vq.position[2] - vp.position[2]}};
    if (merger_.exceeds_error(state, edge, p, q)) return;
    const float cos_deviation = std::max(state.limits.cos_deviation, kCosSmooth);
    if (merger_.judge(edge, p, q, rings, cos_deviation) != Legality::kLegal) return;
    merger_.carry_out(state, edge, merger_.plan(state, edge, p, q, rings), 0);
    touched_.push_back(q);
    vertices_[p].source |= kWent;
  }

  /// Faces turn by 30 degrees at most.
  static constexpr float kCosSmooth = 0.8660254f;
  /// No edge is parked during a sweep.
  static constexpr std::uint32_t kWent = CollapseVertex::kHasParked;

  CollapseMesh& mesh_;
  LargeArray<CollapseVertex>& vertices_;
  EdgeMerger<false>& merger_;
  std::unique_ptr<SweepBatch> batch_ = std::make_unique<SweepBatch>();
  std::vector<SweepBatch::Ring> at_target_ = std::vector<SweepBatch::Ring>(SweepBatch::kSize);
  std::vector<std::uint32_t> touched_;  // and kept, by this batch
};

}  // namespace vkmesh::detail
