#include "decimation/parallel/coarsen.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "base/parallel.h"
#include "base/prefetch.h"

namespace vkmesh::detail {
namespace {

/// Faces turn by 30 degrees at most.
constexpr float kCosSmooth = 0.8660254f;
/// Batches are taken from so many candidates that they stay in the second cache, and of distant ones:
/// neighbours in a batch would come in each other's way.
constexpr std::size_t kApart = 16, kAtOnce = kApart * CoarsenBatch::kSize;

/// How many times as much there is as may be left, of faces or vertices.
double times_the_target(const DecimationState& state) {
  const auto times = [](std::size_t now, std::size_t target) {
    return static_cast<double>(now) / static_cast<double>(std::max<std::size_t>(target, 1));
  };
  return std::min(times(state.faces, state.limits.faces), times(state.vertices, state.limits.vertices));
}

}  // namespace

RangeCoarsening::RangeCoarsening(DecimationState& state, const VertexRange& range, float max_cost)
    : state_(state),
      mesh_(state.mesh),
      vertices_(state.mesh.vertices),
      range_(range),
      max_cost_(max_cost),
      operator_(state.mesh) {}

bool RangeCoarsening::is_candidate(std::uint32_t v) const {
  return vertices_[v].alive() && !vertices_[v].has(VertexRecord::kLocked);
}

void RangeCoarsening::run_all() {
  std::vector<std::uint32_t> candidates;
  candidates.reserve(kAtOnce);
  for (std::uint32_t v = range_.begin; v < range_.end && !state_.reached(); ++v) {
    prefetch_stream(&vertices_[v]);
    if (!is_candidate(v)) continue;
    prefetch(mesh_.faces() + vertices_[v].leading / 4);
    candidates.push_back(v);
    if (candidates.size() < kAtOnce) continue;
    state_.ask();
    coarsen(candidates);
    candidates.clear();
  }
  coarsen(candidates);
}

void RangeCoarsening::run(std::span<const std::uint32_t> candidates) {
  const auto chosen = [&](std::size_t from) {
    from = std::min(from, candidates.size());
    return candidates.subspan(from, std::min(kAtOnce, candidates.size() - from));
  };
  for (std::size_t i = 0; i < candidates.size() && !state_.reached(); i += kAtOnce) {
    state_.ask();
    for (const std::uint32_t v : chosen(i + 2 * kAtOnce)) prefetch(&vertices_[v]);
    for (const std::uint32_t v : chosen(i + kAtOnce))
      prefetch(mesh_.faces() + (vertices_[v].alive() ? vertices_[v].leading / 4 : 0));
    coarsen(chosen(i));
  }
}

void RangeCoarsening::coarsen(std::span<const std::uint32_t> candidates) {
  std::array<std::uint32_t, CoarsenBatch::kSize> chosen;
  for (std::size_t first = 0; first < kApart; ++first) {
    std::size_t count = 0;
    for (std::size_t k = first; k < candidates.size(); k += kApart) {
      chosen[count] = candidates[k];
      count += vertices_[candidates[k]].alive() ? 1 : 0;
    }
    batch_->set(mesh_, std::span(chosen).first(count), range_);
    coarsen_batch();
  }
}

void RangeCoarsening::coarsen_batch() {
  const CoarsenBatch& batch = *batch_;
  std::array<std::uint8_t, CoarsenBatch::kSize> due;
  std::size_t due_count = 0;
  for (std::size_t i = 0; i < batch.count; ++i) {
    due[due_count] = static_cast<std::uint8_t>(i);
    due_count +=
        static_cast<std::size_t>(batch.has_best(i)) & static_cast<std::size_t>(batch.cost_of(i) <= max_cost_);
    if (batch.is_inside[i] == 0) [[unlikely]]
      deferred_.push_back(batch.vertex[i]);
  }
  for (const std::uint8_t i : std::span(due).first(due_count))
    CoarsenBatch::gather(at_target_[i], mesh_, mesh_.twin(batch.ring[i].edge[batch.best_of(i)]));
  for (const std::uint8_t i : std::span(due).first(due_count)) attempt(i);
  for (const std::uint32_t v : touched_) vertices_[v].source &= ~VertexRecord::kTouched;
  touched_.clear();
}

void RangeCoarsening::attempt(std::size_t i) {
  const CoarsenBatch& batch = *batch_;
  const CoarsenBatch::Ring &at_p = batch.ring[i], &at_q = at_target_[i];
  const std::uint32_t best = batch.best_of(i), h = at_p.edge[best];
  const std::uint32_t p = batch.vertex[i], q = at_p.vertex[best];
  const VertexRecord &vp = vertices_[p], &vq = vertices_[q];
  if (at_q.size == 0 || ((vp.source | vq.source) & VertexRecord::kTouched) != 0 || state_.reached()) return;
  if (!range_.holds_first<CoarsenBatch::kMaxNeighbours>(at_q.vertex)) {
    deferred_.push_back(p);
    return;
  }
  // The rings are as they were unless a vertex of theirs went.
  const CollapseNeighbourhood& around =
      operator_.look_around(at_p.part(best + 1, at_p.size - 1), at_q.part(0, at_q.size - 1));
  if ((around.flags() & VertexRecord::kAbsorbed) != 0) return;
  const DueEdge edge{
      h,
      batch.cost_of(i),
      EdgeBatch::kAtQ,
      {vq.position[0] - vp.position[0], vq.position[1] - vp.position[1], vq.position[2] - vp.position[2]}};
  const float cos_deviation = std::max(state_.limits.cos_deviation, kCosSmooth);
  if (judge(CollapseOperator<false>::Change{{}, operator_, edge, p, q, cos_deviation}) != Reason::kNone)
    return;
  operator_.carry_out(state_, edge, operator_.plan(state_, edge, p, q), 0);
  touched_.push_back(q);
  vertices_[p].source |= VertexRecord::kAbsorbed;
}

float cost_of_share(const CollapseMesh& mesh, double share) {
  constexpr std::size_t kSample = 4096;
  const auto batch = std::make_unique<CoarsenBatch>();
  std::vector<float> costs;
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t k = 0; k < kSample; ++k) {
    const auto v = static_cast<std::uint32_t>(spread_evenly(k, mesh.apex()));
    if (mesh.vertices[v].alive() && !mesh.vertices[v].has(VertexRecord::kLocked)) chosen.push_back(v);
    if (chosen.size() < CoarsenBatch::kSize && k + 1 < kSample) continue;
    batch->set(mesh, chosen, {0, mesh.apex()});
    for (std::size_t i = 0; i < batch->count; ++i)
      if (batch->has_best(i)) costs.push_back(batch->cost_of(i));
    chosen.clear();
  }
  if (costs.empty()) return 0;
  const auto nth = costs.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(costs.size() - 1));
  std::nth_element(costs.begin(), nth, costs.end());
  return *nth;
}

void coarsen_if_far_from_target(DecimationState& state) {
  constexpr double kFar = 8, kFarther = 16;
  const CollapseMesh& mesh = state.mesh;
  const double times = times_the_target(state);
  if (mesh.face_count() < 2 * state.sizes.partition_faces || times < kFar || state.criteria != nullptr ||
      state.attributes != nullptr || state.keep_events ||
      state.limits.error2 < std::numeric_limits<double>::infinity())
    return;
  // The costliest tenth of the vertices is left to the queue, and what costs as much by then. The farther the
  // target, the more all costs in the end, and the less it matters.
  constexpr double kShare = 0.9;
  const float max_cost =
      cost_of_share(mesh, kShare) * static_cast<float>(std::clamp(times / kFarther, 1.0, 64.0));

  // First as they follow each other, and then what is at their ends, from one's middle to the next's.
  const std::size_t n = mesh.apex(),
                    count = std::max<std::size_t>(mesh.face_count() / state.sizes.range_faces, 1);
  const auto at_half = [&](std::size_t k) { return static_cast<std::uint32_t>(n * k / (2 * count)); };
  std::vector<std::vector<std::uint32_t>> deferred(count);
  const auto side_by_side = [&](std::size_t ranges, auto&& range_of, auto&& coarsen) {
    const double faces = static_cast<double>(state.faces - state.limits.faces),
                 vertices = static_cast<double>(state.vertices - state.limits.vertices);
    std::vector<std::unique_ptr<PartitionState>> partitions(ranges);
    for (auto& partition : partitions) partition = std::make_unique<PartitionState>(state);
    parallel_ranges(ranges, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const VertexRange range = range_of(i);
        const double share = static_cast<double>(range.end - range.begin) / static_cast<double>(n);
        partitions[i]->start(static_cast<std::size_t>(share * faces),
                             static_cast<std::size_t>(share * vertices));
        coarsen(i, RangeCoarsening(partitions[i]->state, range, max_cost));
      }
    });
    for (const auto& partition : partitions) partition->report_to(state);
  };
  side_by_side(
      count,
      [&](std::size_t i) {
        return VertexRange{at_half(2 * i), at_half(2 * i + 2)};
      },
      [&](std::size_t i, RangeCoarsening&& coarsening) {
        coarsening.run_all();
        deferred[i].assign(coarsening.deferred().begin(), coarsening.deferred().end());
      });
  if (state.reached()) return;
  side_by_side(
      count - 1,
      [&](std::size_t i) {
        return VertexRange{at_half(2 * i + 1), at_half(2 * i + 3)};
      },
      [&](std::size_t i, RangeCoarsening&& coarsening) {
        std::vector<std::uint32_t> candidates;
        for (const auto& chosen : {deferred[i], deferred[i + 1]})
          for (const std::uint32_t v : chosen)
            if (v >= at_half(2 * i + 1) && v < at_half(2 * i + 3)) candidates.push_back(v);
        coarsening.run(candidates);
      });
}

}  // namespace vkmesh::detail
