// Vertices in a batch, their rings, and the neighbour into which each goes at the least cost.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/prefetch.h"
#include "decimation/vertex_record.h"
#include "mesh/edit/one_ring.h"

namespace vkmesh::detail {

/// A range of vertices by number.
struct VertexRange {
  std::uint32_t begin, end;

  [[nodiscard]] bool holds(std::uint32_t v) const { return v - begin < end - begin; }
  template <std::size_t kCount>
  [[nodiscard]] bool holds_first(std::span<const std::uint32_t> vertices) const {
    bool all = true;
    for (std::size_t k = 0; k < kCount; ++k) all &= holds(vertices[k]);
    return all;
  }
};

struct CoarsenBatch {
  static constexpr std::size_t kSize = 16;
  /// Vertices of more neighbours are left alone.
  static constexpr std::uint32_t kMaxNeighbours = 8;

  /// All neighbours of a vertex. The first comes again after the last, and so on: kMaxNeighbours are meant
  /// from any of them on. `size` is 0 when there are more.
  using Ring = FixedRing<3 * kMaxNeighbours>;
  /// Gathers kMaxNeighbours neighbours, from that after the one to which `last` leads on, however many there
  /// are: the trip count is constant, so that no branch is mispredicted.
  static void gather(Ring& ring, const CollapseMesh& mesh, std::uint32_t last) {
    const VertexRecord* const vertices = mesh.vertices.data();
    std::uint32_t found = 0;
    RingStep step{0, last};
#if defined(__GNUC__)
#pragma GCC unroll 8
#endif
    for (std::uint32_t k = 0; k < kMaxNeighbours; ++k) {
      step = RingStep::from(mesh.faces(), step.edge);
      ring.vertex[k] = step.vertex;
      ring.edge[k] = step.edge;
      found |= (step.edge == last ? 1u : 0u) << k;
      prefetch(&vertices[step.vertex]);
    }
    ring.size = found == 0 ? 0 : static_cast<std::uint32_t>(std::countr_zero(found)) + 1;
  }
  /// Takes up to kSize vertices that are not isolated, looks around each, and finds its neighbours' costs.
  void set(const CollapseMesh& mesh, std::span<const std::uint32_t> chosen, const VertexRange& range);

  /// Whether vertex i has a neighbour to go to, which one that is in its ring, and the sum of both quadrics
  /// there, to one part in 2^20. It has none at the boundary, and none at the end of the range.
  [[nodiscard]] bool has_best(std::size_t i) const {
    return best[i] < kNone;
  }
  [[nodiscard]] std::uint32_t best_of(std::size_t i) const {
    return best[i] % kMaxNeighbours;
  }
  [[nodiscard]] float cost_of(std::size_t i) const {
    return std::bit_cast<float>(best[i] / kMaxNeighbours * kMaxNeighbours);
  }

  std::size_t count = 0;
  std::array<std::uint32_t, kSize> vertex;
  std::array<Ring, kSize> ring;
  std::array<std::uint32_t, kSize> is_inside;  // the ring, of the range

  /// Bits of an infinite cost.
  static constexpr std::uint32_t kNone = 0x7f800000;
  /// The bits of the least cost, but for the last three, which tell the neighbour.
  std::array<std::uint32_t, kSize> best;

  /// One lane for each of kMaxNeighbours neighbours.
  using Lanes = std::array<float, kMaxNeighbours>;
  struct Around {
    std::array<Lanes, 4> words;  // x, y, z, and what follows
    Lanes c;
  };
  alignas(64) std::array<Around, kSize> around;
};

}  // namespace vkmesh::detail
