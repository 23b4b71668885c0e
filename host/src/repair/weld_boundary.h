// Joins the boundary edges that lie at the same place.
#pragma once

#include <cstdint>
#include <span>

#include <vkmesh/base/result.h>
#include <vkmesh/repair/weld.h>

#include "base/stop.h"

namespace vkmesh::detail {

/// Makes points at equal places one, as weld() does, among those that an edge without a partner uses; others
/// stay apart. `twin` is that of match_edges() for the mesh; where it does not fit the corners, since faces
/// are degenerate, all points take part. Where nothing is merged, Welded::mesh stays empty. O(n) expected.
/// Errors: as weld(); kInterrupted where `stop` is set meanwhile.
[[nodiscard]] Result<Welded> weld_boundary(const IndexedFaceSet& mesh, std::span<const std::uint32_t> twin,
                                           Stop* stop = nullptr);

/// As weld(). Errors: kInterrupted, too.
[[nodiscard]] Result<Welded> weld(const IndexedFaceSet& mesh, const WeldOptions& options, Stop* stop);

}  // namespace vkmesh::detail
