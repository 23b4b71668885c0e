// How far a collapse moves the faces around its edge.
#pragma once

#include "mesh/edit/edge_rim.h"

namespace vkmesh::detail {

/// The squared distance between the faces at an edge before and after p, which lies at `p`, and q at `q` move
/// to p + x, as far as a few points show it: the ends and the middles of their edges, each to the faces on
/// the other side. At least `least`: what is nearer does not matter.
[[nodiscard]] float squared_distance_of_collapse(const EdgeRim& rim, const EdgeRim::Vector& p,
                                                 const EdgeRim::Vector& q, const EdgeRim::Vector& x,
                                                 float least);

}  // namespace vkmesh::detail
