#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/swap_rounds.h>

#include "passes/swap_rounds_params.h"
#include "shaders.h"

namespace vkmesh {
namespace {

static_assert(VKMESH_MAX_SWAP_VALENCE == kMaxSwapValence);
static_assert(VKMESH_SWAP_ROUNDS_BY_ANGLE == static_cast<int>(SwapCriterion::kMinAngle));

std::uint32_t blocks_of(std::uint32_t values) {
  return values / VKMESH_SWAP_BLOCK + (values % VKMESH_SWAP_BLOCK != 0 ? 1 : 0);
}

/// Makes room, and copies the connectivity that rounds change.
Result<void> record_start(Recorder& recorder, DeviceMesh& mesh, DeviceSwapRounds& state,
                          std::uint32_t max_rounds) {
  Context& context = recorder.context();
  const std::uint32_t half_edges = mesh.half_edge_count();
  if (state.locked.size() != 0 && state.locked.size() != half_edges)
    return fail(ErrorCode::kUsage, std::to_string(state.locked.size()) + " words of locked edges, not " +
                                       std::to_string(half_edges));
  const auto copy = [&](DeviceArray<std::uint32_t>& to, DeviceMesh::Indices from,
                        const char* name) -> Result<void> {
    VKMESH_CHECK(from);
    VKMESH_CHECK(to.resize(context, (*from)->size(), name));
    return recorder.copy((*from)->buffer(), to.buffer(), (*from)->size() * sizeof(std::uint32_t));
  };
  VKMESH_CHECK(copy(state.corners, mesh.corners(), "corners of swapped edges"));
  VKMESH_CHECK(copy(state.twins, mesh.twins(), "twins of swapped edges"));
  VKMESH_CHECK(copy(state.leading, mesh.leading(), "leading half-edges of swapped edges"));
  VKMESH_CHECK(state.sources.resize(context, half_edges, "source corners"));
  VKMESH_CHECK(state.swaps.resize(context, max_rounds, "swaps in each round"));
  VKMESH_CHECK(state.gains.resize(context, half_edges, "gains of swaps"));
  VKMESH_CHECK(state.best.resize(context, mesh.vertex_count(), "best swaps"));
  VKMESH_CHECK(state.changed.resize(context, mesh.face_count(), "rounds of faces"));
  VKMESH_CHECK(state.selected.resize(context, half_edges, "selected swaps"));
  // Each level takes a block of the one before.
  std::size_t counts = 0;
  for (std::uint32_t n = blocks_of(half_edges); n > 0; n = n == 1 ? 0 : blocks_of(n)) counts += n;
  return state.counts.resize(context, counts, "counts of swaps");
}

/// Adds up the swaps of a round, level by level.
Result<void> record_count(Recorder& recorder, const DeviceSwapRounds& state, std::uint32_t round) {
  using P = kernels::SwapCountParams;
  const DeviceArray<std::uint32_t>* values = &state.selected;
  auto size = static_cast<std::uint32_t>(values->size());
  std::uint32_t from = 0, to = 0;
  for (bool first = true; first || size > 1; first = false) {
    const std::uint32_t blocks = blocks_of(size);
    const bool last = blocks == 1;
    VKMESH_CHECK(Dispatch<P>(recorder, shaders::swap_count, blocks)
                     .read(&P::values, *values)
                     .write(&P::sums, last ? state.swaps : state.counts)
                     .set(&P::from, from)
                     .set(&P::size, size)
                     .set(&P::round, first ? round : 0)
                     .set(&P::to, last ? round - 1 : to)
                     .record());
    if (last) return {};
    values = &state.counts;
    from = to;
    to += blocks;
    size = blocks;
  }
  return {};
}

Result<void> record_round(Recorder& recorder, const DeviceMesh& mesh, const DeviceSwapRounds& state,
                          std::uint32_t round, SwapCriterion criterion) {
  const std::uint32_t half_edges = mesh.half_edge_count();
  const auto locks = static_cast<std::uint32_t>(state.locked.size());
  const DeviceArray<std::uint32_t>& locked =
      locks == 0 ? state.twins : state.locked;  // not read without locks
  using G = kernels::SwapGainsParams;
  VKMESH_CHECK(Dispatch<G>(recorder, shaders::swap_gains, half_edges)
                   .read(&G::positions, mesh.positions())
                   .read(&G::corners, state.corners)
                   .read(&G::twins, state.twins)
                   .read(&G::leading, state.leading)
                   .read(&G::locked, locked)
                   .read(&G::changed, state.changed)
                   .write(&G::changed, state.changed)
                   .read(&G::gains, state.gains)
                   .write(&G::gains, state.gains)
                   .write(&G::sources, state.sources)
                   .set(&G::criterion, static_cast<std::uint32_t>(criterion))
                   .set(&G::round, round)
                   .set(&G::lock_count, locks)
                   .record());
  using B = kernels::SwapBestParams;
  VKMESH_CHECK(Dispatch<B>(recorder, shaders::swap_best, mesh.vertex_count())
                   .read(&B::twins, state.twins)
                   .read(&B::leading, state.leading)
                   .read(&B::gains, state.gains)
                   .write(&B::best, state.best)
                   .record());
  using S = kernels::SwapSelectParams;
  VKMESH_CHECK(Dispatch<S>(recorder, shaders::swap_select, half_edges)
                   .read(&S::corners, state.corners)
                   .read(&S::twins, state.twins)
                   .read(&S::gains, state.gains)
                   .read(&S::best, state.best)
                   .write(&S::selected, state.selected)
                   .set(&S::round, round)
                   .record());
  using F = kernels::SwapFlipParams;
  VKMESH_CHECK(Dispatch<F>(recorder, shaders::swap_flip, half_edges)
                   .read(&F::selected, state.selected)
                   .read(&F::corners, state.corners)
                   .write(&F::corners, state.corners)
                   .read(&F::twins, state.twins)
                   .write(&F::twins, state.twins)
                   .read(&F::leading, state.leading)
                   .write(&F::leading, state.leading)
                   .read(&F::locked, locked)
                   .write(&F::locked, locked)
                   .write(&F::changed, state.changed)
                   .read(&F::sources, state.sources)
                   .write(&F::sources, state.sources)
                   .set(&F::round, round)
                   .set(&F::lock_count, locks)
                   .record());
  return record_count(recorder, state, round);
}

}  // namespace

Result<void> record_swap_rounds(Recorder& recorder, DeviceMesh& mesh, DeviceSwapRounds& state,
                                std::uint32_t rounds, std::uint32_t max_rounds, SwapCriterion criterion) {
  if (rounds > max_rounds - std::min(max_rounds, state.rounds))
    return fail(ErrorCode::kUsage, "record_swap_rounds: " + std::to_string(state.rounds) + " rounds and " +
                                       std::to_string(rounds) + " more are above " +
                                       std::to_string(max_rounds));
  if (mesh.half_edge_count() == 0 || rounds == 0) return {};
  if (state.rounds == 0) VKMESH_CHECK(record_start(recorder, mesh, state, max_rounds));
  for (std::uint32_t i = 0; i < rounds; ++i)
    VKMESH_CHECK(record_round(recorder, mesh, state, ++state.rounds, criterion));
  return {};
}

Result<SwapRounds> run_swap_rounds(Context& context, DeviceMesh& mesh, const SwapRoundsOptions& options,
                                   const Progress& progress) {
  return detail::catching([&]() -> Result<SwapRounds> {
    // A submission costs as much as a round of a small mesh; the last rounds swap nothing.
    constexpr std::uint32_t kRoundsAtOnce = 4;
    const std::uint32_t max_rounds = std::min(options.max_rounds, kMaxDeviceSwapRounds);
    DeviceSwapRounds state;
    SwapRounds result;
    if (!options.locked.empty()) {
      if (options.locked.size() != mesh.half_edge_count())
        return fail(ErrorCode::kUsage, "swap_rounds takes one word for each half-edge, or none");
      VKMESH_CHECK(state.locked.upload(context, options.locked, "locked edges"));
    }
    if (mesh.half_edge_count() == 0) {
      if (max_rounds > 0) result.swaps.push_back(0);
      result.mesh = HalfEdgeMesh::from_twins({}, {}, mesh.vertex_count());
      return result;
    }
    result.source_corner.resize(mesh.half_edge_count());
    std::iota(result.source_corner.begin(), result.source_corner.end(), 0u);
    bool done = max_rounds == 0;
    while (!done) {
      VKMESH_TRY(Recorder recorder, Recorder::create(context));
      VKMESH_CHECK(record_swap_rounds(recorder, mesh, state,
                                      std::min(kRoundsAtOnce, max_rounds - state.rounds), max_rounds,
                                      options.criterion));
      VKMESH_CHECK(recorder.submit_and_wait());
      VKMESH_TRY(result.swaps, state.swaps.download());
      result.swaps.resize(state.rounds);
      const auto none = std::ranges::find(result.swaps, 0u);
      done = none != result.swaps.end() || state.rounds == max_rounds;
      if (none != result.swaps.end()) result.swaps.erase(none + 1, result.swaps.end());
      const double share =
          static_cast<double>(result.swaps.back()) / std::max(1.0, static_cast<double>(result.swaps.front()));
      if (!done && progress && !progress(std::clamp(1 - share, 0.0, 1.0)))
        return fail(ErrorCode::kInterrupted, "cancelled");
    }
    if (state.rounds > 0) {
      VKMESH_TRY(result.source_corner, state.sources.download());
    } else {  // no rounds were asked for
      VKMESH_TRY(Recorder recorder, Recorder::create(context));
      VKMESH_CHECK(record_start(recorder, mesh, state, 1));
      VKMESH_CHECK(recorder.submit_and_wait());
    }
    VKMESH_TRY(std::vector<std::uint32_t> corners, state.corners.download());
    VKMESH_TRY(std::vector<std::uint32_t> twins, state.twins.download());
    result.mesh = HalfEdgeMesh::from_twins(std::move(corners), std::move(twins), mesh.vertex_count());
    return result;
  });
}

}  // namespace vkmesh
