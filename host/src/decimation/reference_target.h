// What keeps a target of the reference decimator out of reach.
#pragma once

#include <cstddef>

#include <vkmesh/decimation/decimate.h>

namespace vkmesh::detail {

/// How many vertices are left at least on the way to `faces` faces: a target that locked vertices and small
/// parts put out of reach is not bought with the rest, of which an eighth of the share that was asked for is
/// left. Where it is forced, as many as options.target.vertices. Small parts are decimated alone to see what
/// is left of them.
[[nodiscard]] std::size_t least_vertices_by_reference(const TriangleSurface& surface, std::size_t faces,
                                                      const DecimateOptions& options);

}  // namespace vkmesh::detail
