// Whether an edge may swap, and if not, why.
#pragma once

#include <cstdint>
#include <span>

#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/optimize/swap_edges.h>

#include "optimize/swap_mesh.h"

namespace vkmesh::detail {

/// Bounds of a swap; infinite where there are none.
struct SwapBounds {
  double dihedral_change, deviation;
};

/// Tags the edges that stay whatever happens, for the reasons that options give. O(n). Errors: kUsage for
/// options of other sizes than the mesh.
[[nodiscard]] Result<void> tag_kept_edges(SwapMesh& mesh, std::span<const DVec3> points,
                                          const SwapEdgesOptions& options);

/// The first condition that the swap of a half-edge of the mesh does not meet. O(valence).
[[nodiscard]] SwapReason judge_swap(const SwapMesh& mesh, std::span<const DVec3> points,
                                    const SwapBounds& bounds, std::uint32_t h);

}  // namespace vkmesh::detail
