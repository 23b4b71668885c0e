// Quadric errors of many edges at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "decimation/vertex_record.h"
#include "simd/lanes.h"

namespace vkmesh::detail {

/// Edges (p, q), one a lane.
struct EdgeBatch {
  static constexpr std::size_t kSize = 128;
  /// Kernels work on whole blocks of lanes: what lies in lanes that were not set does not matter.
  static constexpr std::size_t kBlock = 16;
  using Lanes = FloatLanes<kSize>;
  /// The sixteen words of a VertexRecord.
  using Words = std::array<Lanes, 16>;

  alignas(64) Words p, q;
  /// Where the point of an edge must go. kLocked: both ends must stay, so that the edge can't collapse.
  enum End : std::int32_t { kFree, kAtP, kAtQ, kLocked = kAtP | kAtQ };
  alignas(64) std::array<std::int32_t, kSize> end;
  alignas(64) std::array<Lanes, 3> x;                 // result: where the point goes, relative to p
  alignas(64) Lanes cost;                             // result: the sum of both quadrics there
  alignas(64) std::array<std::int32_t, kSize> falls;  // result of find_moved_costs

  /// The numbers of the vertices p and q.
  using Ends = std::array<std::uint32_t, 2>;
  /// Sets a lane for each of these edges.
  void gather(const VertexRecord* vertices, std::span<const Ends> ends);
  /// The same for q alone.
  void gather_q(const VertexRecord* vertices, std::span<const std::uint32_t> ids);
};

/// An edge that is due, what it costs, and where its point goes; see EdgeBatch.
struct DueEdge {
  std::uint32_t half_edge;
  float cost;
  std::int32_t end;
  std::array<float, 3> x;
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
/// The end of less error; q when they are equal.
void place_at_end(EdgeBatch& batch, std::size_t count);
void place_at_end(EdgeBatch& batch, const EndCosts& extra, std::size_t count);

/// p is about to move to q at this cost, and with it the other ends of its edges are those in batch.q. Sets
/// `cost` to what such an edge will cost with its point at q, and `falls` to 1 where that is less than it
/// costs now, at either end; else to 0. With the point at its other end it costs no less than it does.
void find_moved_costs(EdgeBatch& batch, const VertexRecord& p, const VertexRecord& q, float cost,
                      std::size_t count);

}  // namespace vkmesh::detail
