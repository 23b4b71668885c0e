// How far one triangle surface lies from another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <vkmesh/progress.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

namespace vkmesh {

/// Triangles as points and three corners each; IndexedFaceSet::corners and HalfEdgeMesh::origins() fit.
/// Borrowed.
struct TriangleSurface {
  std::span<const Vec3> points;
  std::span<const std::uint32_t> corners;  ///< Each < points.size(); a multiple of three.
};

struct SurfaceDistanceOptions {
  std::size_t samples = 200000;  ///< Points taken on each surface, at least 1. Default 200,000.
  std::uint32_t seed =
      1;  ///< Of their positions; the same seed gives the same samples everywhere. Default 1.
};

/// Distances of samples to a surface, in units of the points.
struct DistanceSummary {
  double mean = 0;
  double root_mean_square = 0;
  double maximum = 0;  ///< A lower bound of the one-sided Hausdorff distance.
};

struct SurfaceDistance {
  DistanceSummary a_to_b;  ///< From samples on A to the nearest point of B.
  DistanceSummary b_to_a;
  /// Length of the diagonal of A's bounding box, over the corners in use: divide by it for relative
  /// distances.
  double diagonal = 0;

  /// Both directions with equal say: the mean of the means, the root of the mean of the squares, the larger
  /// maximum.
  [[nodiscard]] DistanceSummary two_sided() const;
};

/// P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on simplified surfaces" (1998): samples
/// spread over A by area, one in each of `samples` strips of equal area, each to its nearest point on B,
/// found in a tree of boxes; and the other way. In double precision. O((faces + samples) log faces). Errors:
/// kUnsuitable for a surface without area; kUsage for no samples, a corner out of range or a count of corners
/// that is no multiple of three; kInterrupted; kOutOfMemory.
[[nodiscard]] Result<SurfaceDistance> surface_distance(const TriangleSurface& a, const TriangleSurface& b,
                                                       const SurfaceDistanceOptions& options = {},
                                                       const Progress& progress = {});

}  // namespace vkmesh
