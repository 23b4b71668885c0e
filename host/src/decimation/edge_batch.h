// Quadric errors of many edges at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "decimation/collapse_mesh.h"
#include "decimation/four_rows.h"

namespace vkmesh::detail {

/// Edges (p, q), one a lane.
struct EdgeBatch {
  static constexpr std::size_t kSize = 128;
  /// Kernels work on whole blocks of lanes: what lies in lanes that were not set does not matter.
  static constexpr std::size_t kBlock = 16;
  using Lanes = std::array<float, kSize>;
  /// The sixteen words of a CollapseVertex.
  using Words = std::array<Lanes, 16>;

  alignas(64) Words p, q;
  /// Where the point must stay: 1 at p, 2 at q, 0 anywhere, 3: both ends are locked.
  alignas(64) std::array<std::int32_t, kSize> end;
  alignas(64) std::array<Lanes, 3> x;  // result: where the point goes, relative to p
  alignas(64) Lanes cost;              // result: the sum of both quadrics there

  /// Sets the lanes [0, count): ends(lane) returns the pair of vertices. Four records are turned at a time
  /// from rows to columns.
  template <class Ends>
  void gather(std::size_t count, Ends&& ends) {
    for_each_four(count, [&](std::size_t lane, const std::array<std::size_t, 4>& of) {
      std::array<const CollapseVertex*, 4> ps, qs;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto [a, b] = ends(of[i]);
        ps[i] = a;
        qs[i] = b;
      }
      turn(ps, p, lane);
      turn(qs, q, lane);
    });
  }
  /// The same for q alone: q_of(lane) returns a vertex.
  template <class End>
  void gather_q(std::size_t count, End&& q_of) {
    for_each_four(count, [&](std::size_t lane, const std::array<std::size_t, 4>& of) {
      turn({q_of(of[0]), q_of(of[1]), q_of(of[2]), q_of(of[3])}, q, lane);
    });
  }

 private:
  // four(lane, {lane, …}) for lanes below `count`, of which the last may be named several times.
  template <class Four>
  static void for_each_four(std::size_t count, Four&& four) {
    std::size_t lane = 0;
    for (; lane + 4 <= count; lane += 4) four(lane, {lane, lane + 1, lane + 2, lane + 3});
    if (lane < count)
      four(lane, {lane, std::min(lane + 1, count - 1), std::min(lane + 2, count - 1), count - 1});
  }

  [[gnu::always_inline]] static void turn(const std::array<const CollapseVertex*, 4>& from, Words& to,
                                          std::size_t lane) {
    for (std::size_t g = 0; g < 16; g += 4) {
      std::array<const void*, 4> rows;
      for (std::size_t i = 0; i < 4; ++i) rows[i] = reinterpret_cast<const char*>(from[i]) + 4 * g;
      turn_four(rows, {&to[g][lane], &to[g + 1][lane], &to[g + 2][lane], &to[g + 3][lane]});
    }
  }
};

/// What a point at p, or at q, costs beside the quadrics.
struct EndCosts {
  alignas(64) std::array<EdgeBatch::Lanes, 2> at;
};

// Each fills end, x and cost of the lanes below `count`. The bytes are the same on every machine: no
// operation of one lane depends on another.

/// The point of least error; where that is not determined, the nearest such point to the middle. A locked
/// end is the only choice.
void place_optimally(EdgeBatch& batch, std::size_t count);
/// The middle of the edge.
void place_in_middle(EdgeBatch& batch, std::size_t count);
/// The end of less error; q when they are equal.
void place_at_end(EdgeBatch& batch, std::size_t count);
void place_at_end(EdgeBatch& batch, const EndCosts& extra, std::size_t count);

/// p is about to move to q at this cost, and with it the other ends of its edges are those in batch.q. Sets
/// `cost` to what such an edge will cost with its point at q, and `end` to 1 where that is less than it costs
/// now, at either end; else to 0. With the point at its other end it costs no less than it does.
void find_moved_costs(EdgeBatch& batch, const CollapseVertex& p, const CollapseVertex& q, float cost,
                      std::size_t count);

}  // namespace vkmesh::detail
