// Holes that vertices leave behind, filled as a half-edge collapse fills them.
#pragma once

#include <cstddef>

#include "decimation/cost/retriangulation.h"

namespace vkmesh::detail {

/// Fills the hole of a lane for which retriangulate() has found nothing, where the surface about v is no
/// graph along any one direction: on sharp edges between faces large and small, and on thin parts. The best
/// fan of one neighbour, to which v then goes as in a half-edge collapse and which takes over all, costs what
/// the quadric of v is there, and with attributes what they cost in that. No face turns farther than in a
/// collapse. Where v lies on the boundary or a seam, the fan is that of an end of the new edge. Sets `error`,
/// `third` and `heir` of the lane, and `error` of attributes, or leaves all as it is. O(n²).
void fill_with_fan(RetriangulationBatch& batch, std::size_t neighbours, std::size_t lane, float cos_deviation,
                   RetriangulationAttributes* attributes = nullptr);

}  // namespace vkmesh::detail
