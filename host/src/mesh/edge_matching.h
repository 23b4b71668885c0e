// Pairs the half-edges of faces that share an edge: what turns an indexed face set into a half-edge mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/result.h>

#include "base/stop.h"

namespace vkmesh::detail {

/// Counts of the elements of a face set, and of those that keep it from being an oriented manifold.
struct EdgeDefects {
  std::size_t points = 0, faces = 0;
  std::size_t edges = 0, boundary_edges = 0;  ///< Edges of faces that are not degenerate.
  std::size_t isolated_points = 0;            ///< Points that no face uses.

  std::size_t degenerate_faces = 0;    ///< Fewer than three corners, or a point repeated.
  std::size_t non_manifold_edges = 0;  ///< Three or more faces.
  std::size_t misoriented_edges = 0;   ///< Two faces that run the same way along the edge.
  /// Points whose faces form more than one fan; 0 while an edge or a face has a defect.
  std::size_t non_manifold_vertices = 0;
  /// One sentence that counts the defects, each with its first element; empty when there are none.
  std::string sentence;

  [[nodiscard]] bool none() const {
    return degenerate_faces + non_manifold_edges + misoriented_edges + non_manifold_vertices == 0;
  }
};

/// The arrays of a HalfEdgeMesh, as far as the defects allow: `leading` is filled only where every face and
/// every edge is in order.
struct Matching {
  EdgeDefects defects;
  std::vector<std::uint32_t> twin;
  std::vector<std::uint32_t> leading;
};

/// For each point a half-edge that leaves it: on the boundary the one without a twin, elsewhere the first;
/// kInvalid where there is none. O(points + corners).
std::vector<std::uint32_t> leading_half_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                                              std::span<const std::uint32_t> twin);

/// Corners as in IndexedFaceSet. O(points + corners) apart from the small sorts within one point.
/// Errors: kUsage for corners that name no point or offsets that do not ascend; kUnsuitable for more than
/// 2^32 - 2 corners or points; kInterrupted where `stop` is set meanwhile.
Result<Matching> match_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                             std::span<const std::uint32_t> face_offsets, Stop* stop = nullptr);

/// What match_edges() gives for the same faces after points were made one; `before` is what it gave before,
/// and `point_of` the new number of each point. Only the edges of merged points are sorted, unless faces or
/// edges have defects. Errors: as match_edges().
Result<Matching> match_merged_edges(Matching before, std::span<const std::uint32_t> point_of,
                                    std::size_t point_count, std::span<const std::uint32_t> corners,
                                    std::span<const std::uint32_t> face_offsets, Stop* stop = nullptr);

}  // namespace vkmesh::detail
