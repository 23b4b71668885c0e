// How far a collapse moves the faces around its edge.
#pragma once

#include "decimation/collapse_neighbourhood.h"

namespace vkmesh::detail {

/// The squared distance between the faces at an edge before and after p, which lies at `p`, and q at `q` move
/// to p + x, as far as a few points show it: the ends and the middles of their edges, each to the faces on
/// the other side. At least `least`: what is nearer does not matter.
[[nodiscard]] float squared_distance_of_collapse(const CollapseNeighbourhood& around,
                                                 const CollapseNeighbourhood::Vector& p,
                                                 const CollapseNeighbourhood::Vector& q,
                                                 const CollapseNeighbourhood::Vector& x, float least);

}  // namespace vkmesh::detail
