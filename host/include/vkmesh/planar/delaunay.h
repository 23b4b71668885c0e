// Delaunay triangulations of points in the plane, exact.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/predicates.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

struct DelaunayTriangulation {
  /// Triangles that turn counter-clockwise and cover the convex hull; points on its edges are vertices, too.
  /// No triangles where all points are collinear.
  HalfEdgeMesh mesh;
  /// For each vertex the first of the points that lie there.
  std::vector<std::uint32_t> point_of_vertex;
  /// For each point its vertex: equal points share one.
  std::vector<std::uint32_t> vertex_of_point;
};

/// The Delaunay triangulation of points: no circle through the corners of a triangle has a vertex inside.
/// Where four or more vertices lie on one circle, in_circle_perturbed() chooses the diagonals. So the
/// triangles depend on the set of points alone.
///
/// Numbers are canonical. Vertices are numbered along the curve of D. Hilbert (1891), so that neighbours
/// stand near each other: any order of the same points gives the same mesh. Faces begin with their least
/// vertex and are ordered by it and the vertex after it.
///
/// Points are inserted in rounds of eight times as many, each along the curve (N. Amenta, S. Choi, G. Rote,
/// "Incremental constructions con BRIO", 2003), by swaps of edges (C. L. Lawson, "Software for C1 surface
/// interpolation", 1977), of tens of thousands on all cores. About O(n log n). Memory: about 100 bytes a
/// point. The result is the same on any number of threads.
///
/// Errors: kUnsuitable for coordinates that are not finite, and for more than 2^29 - 2 points; kInterrupted;
/// kOutOfMemory.
[[nodiscard]] VKMESH_API Result<DelaunayTriangulation> delaunay(std::span<const DVec2> points,
                                                                const Progress& progress = {});

struct SwappedToDelaunay {
  HalfEdgeMesh mesh;
  std::size_t swaps = 0;
};

/// Swaps the edges of a triangulation in the plane, until each is Delaunay: the vertex beyond it is not in
/// the circle of the triangle on this side, by in_circle_perturbed(). By that the least angle of the two
/// triangles grows; where all edges are so, all circles are empty (C. L. Lawson, 1977).
///
/// From any triangulation of the same points come the same triangles. Boundary edges stay: where the
/// boundary is that of the convex hull, the triangles are those of delaunay(), else those of the constrained
/// triangulation within the boundary. Vertices keep their numbers, faces are numbered as by delaunay().
/// O(n + swaps), of which there are O(n²) at worst, and a few a point from random diagonals. Memory: about
/// 100 bytes a point. Progress: the fraction is not known, and said to be a half.
///
/// Errors: kUnsuitable unless triangles that turn counter-clockwise, of finite coordinates, that do not
/// overlap; kInterrupted; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<SwappedToDelaunay> swap_to_delaunay(const HalfEdgeMesh& mesh,
                                                                    std::span<const DVec2> points,
                                                                    const Progress& progress = {});

}  // namespace vkmesh
