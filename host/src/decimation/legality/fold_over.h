// Whether a collapse would fold faces over.
#pragma once

#include "decimation/collapse_neighbourhood.h"

namespace vkmesh::detail {

/// Whether some face at an edge turns too far or loses its area, one that had none stands against the others,
/// or two neighbours come to stand against each other, when p, which lies at `p`, and q at `q` move to p + x.
/// Both rings need at least two vertices, and must not be the same face.
[[nodiscard]] bool folds_over(const CollapseNeighbourhood& around, const CollapseNeighbourhood::Vector& p,
                              const CollapseNeighbourhood::Vector& q, const CollapseNeighbourhood::Vector& x,
                              float cos_deviation);

}  // namespace vkmesh::detail
