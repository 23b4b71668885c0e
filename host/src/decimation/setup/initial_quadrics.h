// The quadrics that vertices start with.
#pragma once

#include "base/stop.h"
#include "decimation/legality/wedges.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Planes that stand on edges, perpendicular to a face of theirs, weighted by these times the edge's squared
/// length.
struct ConstraintWeights {
  float boundary = 0.0f;  ///< On boundary edges.
  float crease = 0.0f;    ///< On edges between faces whose normals are farther apart than crease_cosine.
  float crease_cosine = -1.0f;
  float seam = 0.0f;  ///< On the seams of `wedges`.
  const Wedges* wedges = nullptr;
};

/// Adds to the quadrics of the vertices, which must be zero, the planes of their faces, weighted by area, and
/// constraint planes. O(n). Where `stop` is set meanwhile they are of no use.
void sum_quadrics(CollapseMesh& mesh, const ConstraintWeights& weights, Stop* stop = nullptr);

}  // namespace vkmesh::detail
