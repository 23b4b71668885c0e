// Which points are one point: from polygons that carry their own corners to shared points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/length.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/mesh/polygon_soup.h>

namespace vkmesh {

struct WeldOptions {
  /// Points at most this far apart are one; 0 (default) identifies equal coordinates only (0 equals -0).
  Length tolerance;
};

struct Welded {
  IndexedFaceSet mesh;
  /// For each point of the input the point of `mesh` that it became.
  std::vector<std::uint32_t> point_of;
  std::size_t merged_points = 0;  ///< How many points there are fewer.
  double largest_move = 0;        ///< How far at most a point went to become another, a length.
  /// Point channels that became corner channels, because points that met differ in them.
  std::vector<std::string> seams;
};

/// Identifies points within the tolerance of each other, and whatever hangs together so (no tear is left
/// between points closer than the tolerance; a chain of close points becomes one point, and `largest_move`
/// tells). Points that are one lie where the first of them in the order of (x, y, z) lies. Which points are
/// one, and where, does not depend on their order; they are numbered by first appearance. Faces keep their
/// order and their corners: those that lose a corner by it are left for `consolidate` to judge. A point
/// channel in which points that meet differ becomes a corner channel, so that a seam of texture coordinates
/// or normals stays a seam over a connected surface; where a corner channel of that name is there already,
/// or without faces, the value of the first point is kept.
///
/// A grid of cells within which all points are one, sorted; neighbouring cells are compared in one sweep for
/// each offset. O(n log n) for points that do not crowd the cells; with k points in neighbouring cells O(n k)
/// at worst. Errors: kUsage for a tolerance that is negative or not finite, for corners that name no point;
/// kOutOfMemory.
[[nodiscard]] VKMESH_API Result<Welded> weld(const IndexedFaceSet& mesh, const WeldOptions& options = {});

/// The same for the corners of a soup, exactly: equal coordinates are one point. Points in order of first
/// appearance; faces and their channels keep their order. O(n) expected for n corners (a hash table).
/// Errors: kOutOfMemory; kUnsuitable for more than 2^32 - 2 corners.
[[nodiscard]] VKMESH_API Result<IndexedFaceSet> weld(const PolygonSoup& soup);

/// Gives each point a copy for each different combination of values that its corners have in the corner
/// channels of these names, which become point channels: what weld() made of points that differed is made
/// undone, for files and vertex buffers whose attributes belong to points. The copies of a point follow each
/// other, in order of first appearance; equal means equal bytes. A name that no corner channel has is passed
/// over; points that no face uses have the value 0. O(n) expected for n corners. Errors: kUsage for corners
/// that name no point; kUnsuitable for more than 2^32 - 2 copies; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<IndexedFaceSet> split_at_seams(IndexedFaceSet mesh,
                                                               std::span<const std::string> names);

/// The faces with corners of their own: the way back, after which weld() gives the same faces over the points
/// that they use. Channels of faces follow; a soup has no place for those of points and corners. O(n) for n
/// corners. Errors: kUsage for corners that name no point; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<PolygonSoup> to_polygon_soup(const IndexedFaceSet& mesh);

}  // namespace vkmesh
