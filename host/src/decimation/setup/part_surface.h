// Parts triangles that are no oriented manifold, so that they become one without moving anything.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vkmesh::detail {

struct PartedSurface {
  std::vector<std::uint32_t> corners;  ///< The vertex of each corner: an oriented manifold.
  /// The point of each vertex. The first vertices are the points themselves, others are copies.
  std::vector<std::uint32_t> point_of;
  /// For each point whether the surface was parted at it: it must not move, or the parts would come apart.
  std::vector<std::uint8_t> parted;
};

/// Keeps two faces joined at an edge where it is clear that they are neighbours:
/// - where they are its only ones, run along it in opposite directions and are not each other's reverse (the
///   two sides of a card, which is boundary there);
/// - where of the faces at the edge they alone share both `wedges` (vertices of the buffer, of which several
///   may lie at one point), as the front faces of a double-sided part do;
/// - where two faces and the reverses of both meet: each with the one that is not its reverse.
/// All others are parted, as are fans of faces that meet in a point alone; the points of what is parted are
/// told, while the two sides of a double-sided part go apart freely, since each is whole. No corner may have
/// its face's other corners at its point. O(n log n).
[[nodiscard]] PartedSurface part_surface(std::size_t points, std::span<const std::uint32_t> corners,
                                         std::span<const std::uint32_t> wedges);

}  // namespace vkmesh::detail
