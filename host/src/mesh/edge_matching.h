// Which faces share an edge: the core of consolidation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/repair/consolidate.h>

namespace vkmesh::detail {

/// What `match_edges` found: the arrays of a HalfEdgeMesh, and the report. `leading` and the count of
/// non-manifold vertices are filled only when every edge is in order.
struct Matching {
  ConsolidateReport report;
  std::vector<std::uint32_t> twin;
  std::vector<std::uint32_t> leading;
};

/// Corners as in IndexedFaceSet. O(points + corners) apart from the small sorts within one point.
/// Errors: kUsage for corners that name no point or offsets that do not ascend; kUnsuitable for more than
/// 2^32 - 2 corners or points.
Result<Matching> match_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                             std::span<const std::uint32_t> face_offsets);

}  // namespace vkmesh::detail
