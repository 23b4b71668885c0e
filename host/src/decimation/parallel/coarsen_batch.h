// Vertices, what is around them, and into which neighbour each goes at the least cost.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/prefetch.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Vertices that follow each other in memory.
struct VertexRange {
  std::uint32_t begin, end;

  [[nodiscard]] bool holds(std::uint32_t v) const { return v - begin < end - begin; }
};

struct CoarsenBatch {
  static constexpr std::size_t kSize = 16;
  /// Vertices of more neighbours are left alone.
  static constexpr std::uint32_t kMaxNeighbours = 8;

  /// The neighbours of a vertex, counter-clockwise, and the half-edges from it to them. The first comes again
  /// after the last, and so on: as many are meant as kMaxNeighbours has room for from any of them on.
  struct Ring {
    std::array<std::uint32_t, 3 * kMaxNeighbours> vertex{}, edge{};

    /// From the neighbour after the one to which `start` leads on, which comes last: kMaxNeighbours of them.
    /// However many there are, nothing is to be foretold.
    void walk(const CollapseMesh& mesh, std::uint32_t start) {
      const CollapseMesh::Face* const faces = mesh.faces();
      const VertexRecord* const vertices = mesh.vertices.data();
      std::uint32_t at = start;
#if defined(__GNUC__)
#pragma GCC unroll 8
#endif
      for (std::uint32_t k = 0; k < kMaxNeighbours; ++k) {
        const CollapseMesh::Face& face = faces[at >> 2];
        const std::uint32_t corner = CollapseMesh::kPreviousCorner[at & 3u];
        vertex[k] = face.origin[corner];
        at = edge[k] = face.twin[corner];
        prefetch(&vertices[vertex[k]]);
      }
    }
    /// How many neighbours there are if they begin after the one to which `start` leads; 0 if more than
    /// kMaxNeighbours.
    [[nodiscard]] std::uint32_t size(std::uint32_t start) const {
      std::uint32_t found = 0;
      for (std::uint32_t k = 0; k < kMaxNeighbours; ++k) found |= (edge[k] == start ? 1u : 0u) << k;
      return found == 0 ? 0 : static_cast<std::uint32_t>(std::countr_zero(found)) + 1;
    }
    /// Whether all of the kMaxNeighbours walked to are of the range.
    [[nodiscard]] bool is_inside(const VertexRange& range) const {
      bool inside = true;
      for (std::uint32_t k = 0; k < kMaxNeighbours; ++k) inside &= range.holds(vertex[k]);
      return inside;
    }
  };

  /// Takes up to kSize vertices that are not isolated, looks around each, and finds its neighbours' costs.
  void set(const CollapseMesh& mesh, std::span<const std::uint32_t> chosen, const VertexRange& range);

  /// Of vertex i: whether it has a neighbour to go to, which one that is in its ring, and the sum of both
  /// quadrics there, to one part in 2^20. It has none at the boundary, and none at the end of the range.
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
  std::array<std::uint32_t, kSize> size;       // of the ring
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
