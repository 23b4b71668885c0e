// The quadrics that vertices start with.
#pragma once

#include "decimation/collapse_mesh.h"

namespace vkmesh::detail {

/// Adds to the quadrics of the vertices, which must be zero, the planes of their faces, weighted by area, and
/// for each boundary edge the plane that stands on it, perpendicular to its face, weighted by
/// `boundary_weight` times its squared length. O(n).
void sum_quadrics(CollapseMesh& mesh, float boundary_weight);

}  // namespace vkmesh::detail
