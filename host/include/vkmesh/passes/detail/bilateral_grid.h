// Where bilateral smoothing finds the faces near a vertex, on the host and for a device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/passes/bilateral_smoothing.h>
#include <vkmesh/spatial/point_grid.h>

namespace vkmesh::detail {

/// The centroids of the faces, and the vertices that faces meet, in the cells of one grid. Cells are a little
/// wider than σ_f, so that what lies within 2 σ_f is at most two cells away, rounding and all.
struct BilateralGrid {
  PointGrid faces, vertices;
  std::vector<std::uint32_t> used;  ///< The vertices that faces meet, ascending; `vertices` are places in it.
  std::vector<Vec3> used_positions;
  std::vector<Vec3> centroids;  ///< One for each face.
};

/// Takes prepared positions (see prepare_positions()). The mesh must have faces. O(n log n). Errors: as
/// bilateral_smoothing().
[[nodiscard]] VKMESH_API Result<BilateralGrid> bilateral_grid(const HalfEdgeMesh& mesh,
                                                              std::span<const Vec3> positions,
                                                              const BilateralSmoothingOptions& options);

/// Errors: kUsage, as bilateral_smoothing().
[[nodiscard]] VKMESH_API Result<void> require_bilateral_options(const BilateralSmoothingOptions& options);

}  // namespace vkmesh::detail
