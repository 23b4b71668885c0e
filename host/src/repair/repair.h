// Repairs a mesh that is no oriented manifold: steps 2 to 5 of consolidation.
#pragma once

#include <cstdint>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/repair/consolidate.h>

#include "base/stop.h"
#include "mesh/edge_matching.h"

namespace vkmesh::detail {

struct Repaired {
  IndexedFaceSet mesh;
  std::vector<std::uint32_t> source_point, source_face;
  /// For each face, whether it runs the other way than in the input.
  std::vector<std::uint8_t> flipped;
  Matching matching;  ///< The edges of `mesh`, paired.
};

/// Steps 2 to 5 of consolidate(): the result is an oriented manifold. Counts in `report` what it does.
/// Errors: kUnsuitable for a surface that is not orientable and not to be cut; kInterrupted.
[[nodiscard]] Result<Repaired> repair(const IndexedFaceSet& mesh, bool cut_non_orientable,
                                      ConsolidateReport& report, Stop& stop);

}  // namespace vkmesh::detail
