// Whether a removal would fold faces over.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <vkmesh/math/vec.h>

#include "decimation/collapse_neighbourhood.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Whether some face at an edge turns too far or loses its area, one that had none stands against the others,
/// or two neighbours come to stand against each other, when p, which lies at `p`, and q at `q` move to p + x.
/// Both rings need at least two vertices, and must not be the same face.
[[nodiscard]] bool folds_over(const CollapseNeighbourhood& neighbourhood, const Vector3& p, const Vector3& q,
                              const Vector3& x, float cos_deviation);

/// Whether two neighbours among the triangles that fill the hole of a vertex stand against each other.
/// `ring`: the neighbours of the vertex; triangles: as CollapseMesh::fill_hole() takes them, the first closes
/// the boundary unless the ring is `closed`. What faces turn by, the triangulation has seen to.
[[nodiscard]] bool folds_over(const LargeArray<VertexRecord>& vertices, std::uint32_t vertex,
                              std::span<const std::uint32_t> ring, bool closed,
                              std::span<const std::array<std::uint8_t, 3>> triangles);

/// Whether the triangle of a, b and c, two sides of which are on a boundary that is kept, looks within 30
/// degrees of where those of v at these sides look.
[[nodiscard]] bool ear_stays_in_place(const DVec3& v, const DVec3& a, const DVec3& b, const DVec3& c);

}  // namespace vkmesh::detail
