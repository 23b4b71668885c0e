// Uniform Laplacian smoothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/node_neighbours.h>
#include <vkmesh/progress.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

namespace vkmesh {

struct LaplacianSmoothingOptions {
  float lambda = 0.5f;            ///< Share of the way to the neighbours' mean, in [0, 1]. Default 0.5.
  std::uint32_t iterations = 10;  ///< Jacobi steps: each reads only the positions before it. Default 10.
  bool fix_boundary = true;       ///< Boundary vertices stay where they are. Default true.
};

/// v ← v + λ (mean of its neighbours − v), `iterations` times, all vertices at once (lecture, "Mesh
/// smoothing"). Neighbours are summed in NodeNeighbours order; isolated vertices stay. The reference of
/// shaders/laplacian_smoothing.comp, equal to it bit for bit. Coordinates below 2^-100 in magnitude become 0.
/// O(iterations × edges).
/// Errors: kUsage for λ outside [0, 1] or a wrong number of positions; kOutOfMemory; kInterrupted.
[[nodiscard]] Result<std::vector<Vec3>> laplacian_smoothing(const NodeNeighbours& neighbours,
                                                            std::span<const Vec3> positions,
                                                            const LaplacianSmoothingOptions& options = {},
                                                            const Progress& progress = {});

}  // namespace vkmesh
