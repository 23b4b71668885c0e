// Decimation in its plainest form: exact, slow, and what the fast one is measured by.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <vkmesh/decimation/decimate.h>

namespace vkmesh::detail {

struct ReferenceResult {
  std::vector<DVec3> positions;                     // by vertex of the input
  std::vector<std::array<std::uint32_t, 3>> faces;  // those that are left, by vertices of the input
  std::vector<std::uint32_t> vertex_map;  // for each vertex the one that stands for it, perhaps itself
  double error = 0;                       // the largest of a step, as BasicDecimated::error
  std::size_t steps = 0;
};

/// Decimates as `decimate` does, in double precision and strictly by cost. Heeds the operation, targets,
/// bounds.error (absolute), bounds.normal_deviation, boundary, boundary_weight and locked.vertices, and no
/// other option; collapses do not wait for tangential drift. The surface must be an oriented manifold whose
/// faces have area. O(n log n).
[[nodiscard]] ReferenceResult decimate_by_reference(const TriangleSurface& surface,
                                                    const DecimateOptions& options);

}  // namespace vkmesh::detail
