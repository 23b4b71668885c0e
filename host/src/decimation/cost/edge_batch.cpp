#include "decimation/cost/edge_batch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "math/quadric.h"
#include "simd/target_clones.h"
#include "simd/transpose.h"

namespace vkmesh::detail {
namespace {

// A lane of a batch: both quadrics, and the edge.
struct Lane {
  Quadric p, q;
  Vector3 d;
  std::int32_t end;

  [[nodiscard, gnu::always_inline]] float both(const Vector3& x) const {
    return p.value(x) + q.value(minus(x, d));
  }
};

// 1 or 0; by the flags among a vertex' words.
[[gnu::always_inline]] inline std::int32_t is_locked(float source) {
  return static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(source) / VertexRecord::kLocked & 1u);
}

using enum VertexRecord::Word;

[[gnu::always_inline]] inline Vector3 position_of(const EdgeBatch::Words& words, std::size_t i) {
  return {words[kX][i], words[kY][i], words[kZ][i]};
}
[[gnu::always_inline]] inline Quadric quadric_of(const EdgeBatch::Words& words, std::size_t i) {
  return {{words[kA][i], words[kA + 1][i], words[kA + 2][i], words[kA + 3][i], words[kA + 4][i],
           words[kA + 5][i]},
          words[kC][i],
          {words[kB][i], words[kB + 1][i], words[kB + 2][i]}};
}

[[gnu::always_inline]] inline Lane lane_of(const EdgeBatch& batch, std::size_t i) {
  return {
      quadric_of(batch.p, i), quadric_of(batch.q, i), minus(position_of(batch.q, i), position_of(batch.p, i)),
      is_locked(batch.p[kSource][i]) * EdgeBatch::kAtP + is_locked(batch.q[kSource][i]) * EdgeBatch::kAtQ};
}

[[gnu::always_inline]] inline void set_result(EdgeBatch& batch, std::size_t i, const Vector3& x,
                                              std::int32_t end, float cost) {
  for (std::size_t k = 0; k < 3; ++k) batch.x[k][i] = x[k];
  batch.end[i] = end;
  batch.cost[i] = cost;
}

// Takes records of vertices apart: lanes [0, count) of `to`. Their numbers are every `stride`-th of `ids`;
// the last comes again where there are no more.
void gather_records(const VertexRecord* vertices, const std::uint32_t* ids, std::size_t stride,
                    std::size_t count, EdgeBatch::Words& to) {
  for (std::size_t i = 0; i < count; i += 4) {
    std::array<const void*, 4> records;
    for (std::size_t k = 0; k < 4; ++k) records[k] = &vertices[ids[std::min(i + k, count - 1) * stride]];
    transpose_records<16>(records, [&](std::size_t word) { return &to[word][i]; });
  }
}

}  // namespace

void EdgeBatch::gather(const VertexRecord* vertices, std::span<const Ends> ends) {
  if (ends.empty()) return;
  gather_records(vertices, &ends[0][0], 2, ends.size(), p);
  gather_records(vertices, &ends[0][1], 2, ends.size(), q);
}
void EdgeBatch::gather_q(const VertexRecord* vertices, std::span<const std::uint32_t> ids) {
  gather_records(vertices, ids.data(), 1, ids.size(), q);
}

VKMESH_CLONES void place_optimally(EdgeBatch& batch, std::size_t count) {
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Lane lane = lane_of(batch, i);
      const Vector3 middle = times(0.5f, lane.d);
      // Half the gradient in the middle, `middle` from p and -`middle` from q.
      const Vector3 g = plus(plus(lane.p.b, lane.q.b), times(minus(lane.p.a, lane.q.a), middle));
      const Vector3 s = way_to_least<HostArithmetic>(plus(lane.p.a, lane.q.a), g, lane.d);
      const bool free = lane.end == EdgeBatch::kFree, at_p = lane.end == EdgeBatch::kAtP;
      Vector3 x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = free ? middle[k] + s[k] : at_p ? 0.0f : lane.d[k];
      set_result(batch, i, x, lane.end, lane.both(x));
    }
}

namespace {

// `extra(cost, end, lane)`: the cost of a point at p (0) or q (1), and what comes to it.
template <class Extra>
[[gnu::always_inline]] inline void place_at_cheaper_end(EdgeBatch& batch, std::size_t count,
                                                        const Extra& extra) {
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Lane lane = lane_of(batch, i);
      const float at_p = extra(lane.both({}), 0, i), at_q = extra(lane.both(lane.d), 1, i);
      const bool q = lane.end == EdgeBatch::kFree ? at_q <= at_p : lane.end != EdgeBatch::kAtP;
      const Vector3 x = {q ? lane.d[0] : 0.0f, q ? lane.d[1] : 0.0f, q ? lane.d[2] : 0.0f};
      set_result(batch, i, x,
                 lane.end == EdgeBatch::kLocked ? EdgeBatch::kLocked
                 : q                            ? EdgeBatch::kAtQ
                                                : EdgeBatch::kAtP,
                 q ? at_q : at_p);
    }
}

}  // namespace

VKMESH_CLONES void place_at_end(EdgeBatch& batch, std::size_t count) {
  place_at_cheaper_end(
      batch, count, [](float cost, std::size_t, std::size_t) __attribute__((always_inline)) { return cost; });
}

VKMESH_CLONES void place_at_end(EdgeBatch& batch, const EndCosts& extra, std::size_t count) {
  place_at_cheaper_end(
      batch, count, [&](float cost, std::size_t end, std::size_t i) __attribute__((always_inline)) {
        return cost + extra.at[end][i];
      });
}

VKMESH_CLONES void find_moved_costs(EdgeBatch& batch, const VertexRecord& p, const VertexRecord& q,
                                    float cost, std::size_t count) {
  const Quadric of_p = p.quadric;
  const Vector3 p_lies = p.position, q_lies = q.position;
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Quadric of_r = quadric_of(batch.q, i);
      const Vector3 r_lies = position_of(batch.q, i);
      const float at_q = of_r.value(minus(q_lies, r_lies)) + cost;
      const float at_p = of_r.value(minus(p_lies, r_lies)) + of_p.c,
                  at_r = of_r.c + of_p.value(minus(r_lies, p_lies));
      const std::int32_t locked = is_locked(batch.q[kSource][i]);  // it stays at r then
      const float now = at_p < at_r ? at_p : at_r;
      batch.cost[i] = at_q;
      batch.falls[i] = at_q < now ? 1 - locked : 0;
    }
}

}  // namespace vkmesh::detail
