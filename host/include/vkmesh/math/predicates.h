// Exact predicates of points in the plane: signs of determinants as real numbers have them.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/math/vec.h>

namespace vkmesh {

using DVec2 = glm::vec<2, double, glm::packed_highp>;

// Each is right for all finite coordinates, subnormal ones included, whatever the processor, the compiler's
// flags and the rounding of the moment. Rounded arithmetic with a bound of its error decides nearly all,
// some nanoseconds each (J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust
// geometric predicates", 1997); what it leaves is computed in whole numbers.

/// Whether a, b and c turn counter-clockwise: 1, clockwise: -1, or are collinear: 0.
[[nodiscard]] VKMESH_API int orientation(DVec2 a, DVec2 b, DVec2 c);

/// Where d lies of the circle through a, b and c, which turn counter-clockwise: 1 inside, 0 on it, -1
/// outside. The opposite where they turn clockwise.
[[nodiscard]] VKMESH_API int in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d);

/// The same where no four different points are cocircular: every point is lifted above the paraboloid
/// x² + y² by an infinitesimal amount, and infinitely more than all that are less in lexicographic order
/// (O. Devillers, M. Teillaud, "Perturbations for Delaunay and weighted Delaunay 3D triangulations", 2011).
/// Never 0 for four different points that are not collinear.
[[nodiscard]] VKMESH_API int in_circle_perturbed(DVec2 a, DVec2 b, DVec2 c, DVec2 d);

}  // namespace vkmesh
