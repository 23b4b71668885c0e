// How far one triangle surface lies from another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/triangle_surface.h>

namespace vkmesh {

struct SurfaceDistanceOptions {
  std::size_t samples = 200000;  ///< Points taken on each surface, at least 1. Default 200,000.
  std::uint32_t seed =
      1;  ///< Seeds their positions; the same seed gives the same samples everywhere. Default 1.
  /// How far apart the bounds of the Hausdorff distance may be, as a share of it. With 0 (default) it is
  /// bounded by the samples alone.
  double hausdorff_tolerance = 0;
};

/// Distances of samples to a surface, in units of the points.
struct DistanceSummary {
  double mean = 0;
  double root_mean_square = 0;
  double maximum = 0;  ///< The largest of the samples: a lower bound of the one-sided Hausdorff distance.
  /// Between these the one-sided Hausdorff distance lies, rounding counted in. Unless `hausdorff_tolerance`
  /// asks for better ones: the largest of the samples, and infinity.
  double hausdorff_low = 0, hausdorff_high = std::numeric_limits<double>::infinity();
  /// Angle between the normals of a sample's triangle and of the nearest one, radians, in [0, π]. Triangles
  /// without area have no part in it.
  double mean_normal_angle = 0, maximum_normal_angle = 0;
};

struct VKMESH_API SurfaceDistance {
  DistanceSummary a_to_b;  ///< From samples on A to the nearest point of B.
  DistanceSummary b_to_a;
  /// Length of the diagonal of A's bounding box, over the corners in use: divide by it for relative
  /// distances.
  double diagonal = 0;

  /// Both directions with equal say: the mean of the means, the root of the mean of the squares, the larger
  /// maximum and bounds.
  [[nodiscard]] DistanceSummary two_sided() const;
};

/// P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on simplified surfaces" (1998): samples
/// spread over A by area, one in each of `samples` strips of equal area, each to its nearest point on B,
/// found in a tree of boxes; and the other way. In double precision. O((faces + samples) log faces).
///
/// The bounds of the Hausdorff distance come from triangles that are split until they are near enough (E.
/// Tang, M. Lee, Y. J. Kim, "Interactive Hausdorff distance computation for general polygonal models", 2009):
/// the distance to one triangle is convex, so that over a piece it is largest at a corner; the least of this
/// over a few triangles near the piece is an upper bound, and the distance of any of its points a lower one.
/// Pieces are quartered until they are as small as the triangles near them, and then cut along the edges of
/// these: over one triangle the distance to its plane is told exactly, so that surfaces that coincide have a
/// bound of 0 but for rounding. An upper bound below 1e-10 of the diagonal is near enough whatever the
/// tolerance; after four million splits the bounds are farther apart than was asked. Errors:
/// kUnsuitable for a surface without area; kUsage for no samples, a tolerance that is negative, a corner out
/// of range or a count of corners that is no multiple of three; kInterrupted; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<SurfaceDistance> surface_distance(const TriangleSurface& a,
                                                                  const TriangleSurface& b,
                                                                  const SurfaceDistanceOptions& options = {},
                                                                  const Progress& progress = {});

}  // namespace vkmesh
