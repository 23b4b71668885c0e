#include "decimation/cost/edge_batch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "simd/target_clones.h"
#include "simd/transpose.h"

namespace vkmesh::detail {
namespace {

// A lane of a batch: both quadrics, and the edge.
struct Lane {
  std::array<float, 6> pa, qa;
  std::array<float, 3> pb, qb, d;
  float pc, qc;
  std::int32_t end;
};

// 1 or 0; by the flags among a vertex' words.
[[gnu::always_inline]] inline std::int32_t is_locked(float source) {
  return static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(source) / VertexRecord::kLocked & 1u);
}

[[gnu::always_inline]] inline Lane lane_of(const EdgeBatch& batch, std::size_t i) {
  const auto& p = batch.p;
  const auto& q = batch.q;
  using enum VertexRecord::Word;
  return {{p[kA][i], p[kA + 1][i], p[kA + 2][i], p[kA + 3][i], p[kA + 4][i], p[kA + 5][i]},
          {q[kA][i], q[kA + 1][i], q[kA + 2][i], q[kA + 3][i], q[kA + 4][i], q[kA + 5][i]},
          {p[kB][i], p[kB + 1][i], p[kB + 2][i]},
          {q[kB][i], q[kB + 1][i], q[kB + 2][i]},
          {q[kX][i] - p[kX][i], q[kY][i] - p[kY][i], q[kZ][i] - p[kZ][i]},
          p[kC][i],
          q[kC][i],
          is_locked(p[kSource][i]) * EdgeBatch::kAtP + is_locked(q[kSource][i]) * EdgeBatch::kAtQ};
}

[[gnu::always_inline]] inline float both(const Lane& lane, float x, float y, float z) {
  return quadric_value(lane.pa, lane.pb, lane.pc, x, y, z) +
         quadric_value(lane.qa, lane.qb, lane.qc, x - lane.d[0], y - lane.d[1], z - lane.d[2]);
}

/// Some of `count` records of vertices, those from number i on; their numbers are every `stride`-th of `ids`.
/// The last comes again where there are no more.
template <std::size_t kSome>
[[gnu::always_inline]] inline std::array<const char*, kSome> records_of(const VertexRecord* vertices,
                                                                        const std::uint32_t* ids,
                                                                        std::size_t stride, std::size_t i,
                                                                        std::size_t count) {
  std::array<const char*, kSome> records;
  const auto record = [&](std::size_t k) {
    return reinterpret_cast<const char*>(&vertices[ids[k * stride]]);
  };
  if (i + kSome <= count)
    for (std::size_t k = 0; k < kSome; ++k) records[k] = record(i + k);
  else
    for (std::size_t k = 0; k < kSome; ++k) records[k] = record(std::min(i + k, count - 1));
  return records;
}

// Turns records from rows to columns: lanes [0, count) of `to`.
#if defined(VKMESH_HAS_CLONES)
// The same, eight at a time; the compiler does not find that by itself.
__attribute__((target("avx2"))) void gather_records(const VertexRecord* vertices, const std::uint32_t* ids,
                                                    std::size_t stride, std::size_t count,
                                                    EdgeBatch::Words& to) {
  for (std::size_t i = 0; i < count; i += 8) {
    const auto r = records_of<8>(vertices, ids, stride, i, count);
#pragma GCC unroll 4
    for (std::size_t g = 0; g < 16; g += 4) {
      const std::size_t at = sizeof(float) * g;
      turn_eight({r[0] + at, r[1] + at, r[2] + at, r[3] + at, r[4] + at, r[5] + at, r[6] + at, r[7] + at},
                 {&to[g][i], &to[g + 1][i], &to[g + 2][i], &to[g + 3][i]});
    }
  }
}

__attribute__((target("default")))
#endif
void gather_records(const VertexRecord* vertices, const std::uint32_t* ids, std::size_t stride,
                    std::size_t count, EdgeBatch::Words& to) {
  for (std::size_t i = 0; i < count; i += 4) {
    const auto r = records_of<4>(vertices, ids, stride, i, count);
    for (std::size_t g = 0; g < 16; g += 4) {
      const std::size_t at = sizeof(float) * g;
      turn_four({r[0] + at, r[1] + at, r[2] + at, r[3] + at},
                {&to[g][i], &to[g + 1][i], &to[g + 2][i], &to[g + 3][i]});
    }
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
  // Directions in which the quadric is flatter than this share of its steepest are left to the middle.
  constexpr float kFlat = 1.0f / (1 << 20);
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Lane lane = lane_of(batch, i);
      const auto &pa = lane.pa, &qa = lane.qa;
      const auto &pb = lane.pb, &qb = lane.qb;
      const float dx = lane.d[0], dy = lane.d[1], dz = lane.d[2];
      const float mx = 0.5f * dx, my = 0.5f * dy, mz = 0.5f * dz;
      const float xx = pa[0] + qa[0], xy = pa[1] + qa[1], xz = pa[2] + qa[2];
      const float yy = pa[3] + qa[3], yz = pa[4] + qa[4], zz = pa[5] + qa[5];
      // Half the gradient in the middle, m from p and -m from q.
      const float gx = (pb[0] + qb[0]) + ((pa[0] - qa[0]) * mx + (pa[1] - qa[1]) * my + (pa[2] - qa[2]) * mz);
      const float gy = (pb[1] + qb[1]) + ((pa[1] - qa[1]) * mx + (pa[3] - qa[3]) * my + (pa[4] - qa[4]) * mz);
      const float gz = (pb[2] + qb[2]) + ((pa[2] - qa[2]) * mx + (pa[4] - qa[4]) * my + (pa[5] - qa[5]) * mz);
      // L D Lᵀ of A + εI, whose pivots are at least ε but for rounding.
      const float e = (xx + yy + zz) * kFlat + 1e-36f, least = 0.5f * e;
      const float d0 = xx + e, r0 = 1.0f / d0;
      const float l1 = xy * r0, l2 = xz * r0;
      const float p1 = (yy + e) - l1 * xy, d1 = p1 > least ? p1 : least, r1 = 1.0f / d1;
      const float u = yz - l2 * xy, l3 = u * r1;
      const float p2 = (zz + e) - l2 * xz - l3 * u, d2 = p2 > least ? p2 : least, r2 = 1.0f / d2;
      const auto solve = [&](float hx, float hy, float hz, float& tx, float& ty, float& tz) {
        const float w0 = -hx, w1 = -hy - l1 * w0, w2 = -hz - l2 * w0 - l3 * w1;
        tz = w2 * r2;
        ty = w1 * r1 - l3 * tz;
        tx = w0 * r0 - l1 * ty - l2 * tz;
      };
      float sx, sy, sz, tx, ty, tz;
      solve(gx, gy, gz, sx, sy, sz);
      // Once more for the rest, which takes back what ε has shortened of steep directions.
      solve(gx + (xx * sx + xy * sy + xz * sz), gy + (xy * sx + yy * sy + yz * sz),
            gz + (xz * sx + yz * sy + zz * sz), tx, ty, tz);
      sx += tx;
      sy += ty;
      sz += tz;
      // Farther from the middle than twice the edge no planes of its faces can lead in earnest.
      const bool near = sx * sx + sy * sy + sz * sz <= 4 * (dx * dx + dy * dy + dz * dz);
      sx = near ? sx : 0.0f;
      sy = near ? sy : 0.0f;
      sz = near ? sz : 0.0f;
      const bool free = lane.end == EdgeBatch::kFree, at_p = lane.end == EdgeBatch::kAtP;
      const float x = free ? mx + sx : at_p ? 0.0f : dx;
      const float y = free ? my + sy : at_p ? 0.0f : dy;
      const float z = free ? mz + sz : at_p ? 0.0f : dz;
      batch.x[0][i] = x;
      batch.x[1][i] = y;
      batch.x[2][i] = z;
      batch.end[i] = lane.end;
      batch.cost[i] = both(lane, x, y, z);
    }
}

VKMESH_CLONES void place_in_middle(EdgeBatch& batch, std::size_t count) {
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Lane lane = lane_of(batch, i);
      const float share = lane.end == EdgeBatch::kFree ? 0.5f : lane.end == EdgeBatch::kAtP ? 0.0f : 1.0f;
      const float x = share * lane.d[0], y = share * lane.d[1], z = share * lane.d[2];
      batch.x[0][i] = x;
      batch.x[1][i] = y;
      batch.x[2][i] = z;
      batch.end[i] = lane.end;
      batch.cost[i] = both(lane, x, y, z);
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
      const float dx = lane.d[0], dy = lane.d[1], dz = lane.d[2];
      const float at_p = extra(both(lane, 0.0f, 0.0f, 0.0f), 0, i);
      const float at_q = extra(both(lane, dx, dy, dz), 1, i);
      const bool q = lane.end == EdgeBatch::kFree ? at_q <= at_p : lane.end != EdgeBatch::kAtP;
      batch.x[0][i] = q ? dx : 0.0f;
      batch.x[1][i] = q ? dy : 0.0f;
      batch.x[2][i] = q ? dz : 0.0f;
      batch.end[i] = lane.end == EdgeBatch::kLocked ? EdgeBatch::kLocked
                     : q                            ? EdgeBatch::kAtQ
                                                    : EdgeBatch::kAtP;
      batch.cost[i] = q ? at_q : at_p;
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
  using enum VertexRecord::Word;
  const auto pa = p.a;
  const auto pb = p.b;
  const float pc = p.c;
  const auto [px, py, pz] = p.position;
  const auto [qx, qy, qz] = q.position;
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const auto& r = batch.q;
      const std::array<float, 6> ra = {r[kA][i],     r[kA + 1][i], r[kA + 2][i],
                                       r[kA + 3][i], r[kA + 4][i], r[kA + 5][i]};
      const std::array<float, 3> rb = {r[kB][i], r[kB + 1][i], r[kB + 2][i]};
      const float rc = r[kC][i], x = r[kX][i], y = r[kY][i], z = r[kZ][i];
      const float at_q = quadric_value(ra, rb, rc, qx - x, qy - y, qz - z) + cost;
      const float at_p = quadric_value(ra, rb, rc, px - x, py - y, pz - z) + pc,
                  at_r = rc + quadric_value(pa, pb, pc, x - px, y - py, z - pz);
      const std::int32_t locked = is_locked(r[kSource][i]);  // it stays at r then
      const float now = at_p < at_r ? at_p : at_r;
      batch.cost[i] = at_q;
      batch.falls[i] = at_q < now ? 1 - locked : 0;
    }
}

}  // namespace vkmesh::detail
