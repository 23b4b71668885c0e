// Voronoi diagrams of points in the plane, clipped to a convex polygon; Lloyd's relaxation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/predicates.h>
#include <vkmesh/mesh/handles.h>

namespace vkmesh {

struct VoronoiOptions {
  /// The convex polygon that cells are clipped to, its corners in either direction; corners within a side are
  /// passed over. Empty: bounds_of_sites().
  std::vector<DVec2> clip;
  /// So many times all sites move to the centroids of their cells (S. P. Lloyd, "Least squares quantization
  /// in PCM", 1982), so that cells become rounder and more even. Sites with empty cells stay.
  unsigned lloyd_iterations = 0;
};

/// One cell for each site: the points of the clip polygon that no other site is nearer to.
struct VKMESH_API VoronoiDiagram {
  /// Where the sites are, each place once, along Hilbert's curve; after Lloyd's relaxation where they moved.
  std::vector<DVec2> sites;
  /// For each site the first of the points that it stands for.
  std::vector<std::uint32_t> point_of_site;
  /// For each point its site: equal points share one.
  std::vector<std::uint32_t> site_of_point;
  /// Corners of cells, each once: those within the polygon, those of the polygon, then those on its sides.
  std::vector<DVec2> vertices;
  /// Cell i has the corners [cell_offsets[i], cell_offsets[i + 1]); none if it lies outside the polygon.
  std::vector<std::uint32_t> cell_offsets;
  /// The vertex at each corner, counter-clockwise around each cell.
  std::vector<std::uint32_t> corners;
  /// The cell across the edge from each corner to the next, or kInvalid where that is the polygon's side.
  std::vector<std::uint32_t> neighbours;

  [[nodiscard]] std::size_t cell_count() const { return sites.size(); }
  [[nodiscard]] std::span<const std::uint32_t> cell(std::size_t i) const {
    return {corners.data() + cell_offsets[i], cell_offsets[i + 1] - cell_offsets[i]};
  }
  [[nodiscard]] std::span<const std::uint32_t> neighbours_of(std::size_t i) const {
    return {neighbours.data() + cell_offsets[i], cell_offsets[i + 1] - cell_offsets[i]};
  }
  /// 0 of an empty cell. O(corners of the cell).
  [[nodiscard]] double area(std::size_t i) const;
  /// The site of an empty cell. O(corners of the cell).
  [[nodiscard]] DVec2 centroid(std::size_t i) const;
};

/// The Voronoi diagram of points: the dual of delaunay(), clipped to a convex polygon.
///
/// Which vertices there are, which cells they are corners of and which cells meet is exact: it is decided by
/// predicates of the sites and the polygon, never by rounded vertices. Four or more cells meet at a vertex
/// where their sites are cocircular; cells that meet at a single point are no neighbours. The cells that are
/// not empty are the faces of an oriented manifold whose boundary is the polygon. Their areas add up to that
/// of the polygon, up to rounding.
///
/// Vertices are rounded once for all cells. Each coordinate is off by at most 2^-50 of the largest coordinate
/// of the polygon, and within the polygon by at most 2^-47 of the largest of the vertex and its sites. So a
/// cell may turn clockwise at corners, or be of no area, within that distance.
///
/// Collinear sites have strips for cells, a single one has the polygon. The diagram is a function of the set
/// of points and the polygon: any order of the same points gives the same bytes but for the two maps of
/// points. O(n log n), and the number of sides of the polygon for each edge that crosses its bounds, and for
/// each vertex where it is not a box; on all cores beyond the triangulation. Memory: about 210 bytes a point,
/// 130 of them the result.
///
/// Errors: kUnsuitable for points that delaunay() refuses, and where the polygon is not convex, has no area
/// or corners that are not finite; kInterrupted; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<VoronoiDiagram> voronoi(std::span<const DVec2> points,
                                                        const VoronoiOptions& options = {},
                                                        const Progress& progress = {});

/// The corners of the box around points, enlarged by a tenth of its longer side; where all points are equal
/// by 1, or by a tenth of their larger coordinate if that is more. Empty without points. O(n).
[[nodiscard]] VKMESH_API std::vector<DVec2> bounds_of_sites(std::span<const DVec2> points);

}  // namespace vkmesh
