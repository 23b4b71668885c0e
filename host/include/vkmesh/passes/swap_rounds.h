// Edge swaps in rounds: many at once, none next to another.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/passes/swap_scores.h>

namespace vkmesh {

struct SwapRoundsOptions {
  /// Whose worse value, of the two triangles, a swap makes better: the sine of the least angle, squared, or
  /// the quality. Default the angle.
  SwapCriterion criterion = SwapCriterion::kMinAngle;
  /// Default none but what ends by itself.
  std::uint32_t max_rounds = 0xffffffffu;
  /// One word for each half-edge: edges with a half-edge whose word is not 0 stay. Default none.
  std::span<const std::uint32_t> locked;
};

struct SwapRounds {
  HalfEdgeMesh mesh;  ///< Vertices and faces keep their numbers.
  /// For each corner of `mesh` one of the input at the same vertex, on the same side of locked edges.
  std::vector<std::uint32_t> source_corner;
  std::vector<std::uint32_t> swaps;  ///< In each round; the last is 0 unless max_rounds ended it.
};

/// An edge whose swap gains and is legal (see swap_scores(); and its two opposite vertices are not joined
/// yet) swaps if of all edges in whose quadrilateral is one of its four vertices it gains most, and of those
/// that gain as much has the smallest half-edge. So no two swaps of a round touch the same triangle or make
/// the same edge, and the order in which they are done does not matter. Rounds go on until one swaps nothing.
/// The scores are functions of the three sides of a triangle alone, bit for bit: with each swap the sorted
/// list of them rises, which ends. An edge at a vertex of more than kMaxSwapValence edges stays.
///
/// The reference of record_swap_rounds(), equal to it bit for bit. O(half-edges) a round. Errors: as
/// swap_scores(); kUsage for another number of words; kInterrupted.
[[nodiscard]] VKMESH_API Result<SwapRounds> swap_rounds(const HalfEdgeMesh& mesh,
                                                        std::span<const Vec3> positions,
                                                        const SwapRoundsOptions& options = {},
                                                        const Progress& progress = {});

inline constexpr std::uint32_t kMaxSwapValence = 1024;

}  // namespace vkmesh
