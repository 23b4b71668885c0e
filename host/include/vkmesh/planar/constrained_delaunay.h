// Constrained Delaunay triangulations: edges that must be there, polygons with holes, refinement.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/predicates.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// Two points by their numbers: a segment from the first to the second.
using PointPair = std::array<std::uint32_t, 2>;

/// Which triangles are kept, by how often the outlines wind around them.
enum class DelaunayDomain : std::uint8_t {
  kConvexHull,  ///< All of them.
  kNonZero,     ///< Where the winding number is not 0: overlapping outlines of one turn are united.
  kEvenOdd      ///< Where it is odd: what lies in two outlines is a hole, whatever their turn.
};

/// What refinement is to reach, and where it ends at the latest. Each triangle asked for too much, for
/// instance by small angles between constraints, is left, and listed.
struct DelaunayRefinement {
  /// The least angle wanted, radians, below π/3. It is reached up to 20.7°, in practice up to 33°, but for
  /// triangles at smaller angles of constraints; what cannot be reached uses up `max_points`.
  double min_angle = 0;
  /// The largest area wanted, above 0.
  std::optional<double> max_area;
  /// The most vertices to add; by default a million, and ten for each vertex that is there.
  std::optional<std::size_t> max_points;
  /// No edge shorter than this is made.
  double min_edge = 0;
};

struct ConstrainedDelaunayOptions {
  /// Segments that bound polygons: kept as constraints are, and counted by `domain`. As many must end at a
  /// place as begin there; for kEvenOdd an even number of them must meet there.
  std::span<const PointPair> outlines;
  DelaunayDomain domain = DelaunayDomain::kConvexHull;
  /// Splits constraints that cross each other between their ends, instead of refusing them.
  bool split_crossings = false;
  std::optional<DelaunayRefinement> refinement;
};

/// Where a vertex that was added lies: between three vertices before it, by weights that add up to 1, but for
/// rounding. Heights and other values of it can be mixed so.
struct AddedVertex {
  std::array<std::uint32_t, 3> vertices;
  std::array<float, 3> weights;
};

/// Why refinement left a triangle that is not as asked for.
enum class UnrefinedReason : std::uint8_t {
  kInputAngle,  ///< Constraints meet here at a smaller angle.
  kMaxPoints,   ///< No more vertices could be added.
  kMinEdge      ///< An edge would become shorter than `min_edge`, or than doubles tell apart.
};
struct UnrefinedTriangle {
  FaceId face;
  UnrefinedReason reason;
};

struct ConstrainedTriangulation {
  /// Triangles that turn counter-clockwise. Vertices that are in none of them are isolated.
  HalfEdgeMesh mesh;
  /// Places of the vertices. The first are those of delaunay(); those at the end were added.
  std::vector<DVec2> positions;
  /// For each vertex the first of the points that lie there; kInvalid for vertices that were added.
  std::vector<std::uint32_t> point_of_vertex;
  /// For each point its vertex: equal points share one.
  std::vector<std::uint32_t> vertex_of_point;
  /// The vertices that were added, in order: crossings, vertices of refinement, and copies of vertices at
  /// which the domain touches itself, one for each fan of triangles but the first.
  std::vector<AddedVertex> added;
  /// Edges of constraints and outlines, as HalfEdgeMesh::edge() names them, ascending.
  std::vector<HalfEdgeId> constrained_edges;
  /// How often constraints were split because they cross.
  std::size_t crossings = 0;
  /// How many of the vertices refinement added.
  std::size_t refined_points = 0;
  /// Triangles that refinement left, ascending.
  std::vector<UnrefinedTriangle> unrefined;
};

/// The constrained Delaunay triangulation of points: each constraint is an edge, or several where vertices
/// lie on it; every other edge is locally Delaunay, by in_circle_perturbed(). So no circle through the
/// corners of a triangle has a vertex inside that can be seen from it past the constraints. Constraints may
/// overlap, and meet at their ends and in points that lie on them. Those between equal places count for
/// nothing.
///
/// The triangles are a function of the places and the constraints, whatever their order. Points are put in as
/// by delaunay(), then each segment: the triangles that it crosses are replaced (M. V. Anglada, "An improved
/// incremental algorithm for constructing restricted Delaunay triangulations", 1997), and edges swapped.
/// About O(n log n) where segments cross few edges, one thread. Memory: about 130 bytes a vertex.
///
/// `split_crossings`: where two constraints cross in their interior, a vertex is put there, the crossing
/// rounded once, or a vertex is taken that lies within a few units in the last place; both then go through
/// it. Afterwards no two constraints cross, and each is a chain of edges from its one end to the other, which
/// lies within some roundings of its segment, but may pass other vertices on the other side. Constraints that
/// come so near to each other that rounding makes them cross again and again are refused.
///
/// Domain: a vertex at which it touches itself, so that its triangles form several fans, is repeated.
///
/// Refinement puts in centres of circles, and halves edges on constraints and on the border of the domain
/// (J. Ruppert, "A Delaunay refinement algorithm for quality 2-dimensional mesh generation", 1995), the
/// centres as near as need be (A. Üngör, "Off-centers", 2004). At small angles edges are split at powers of
/// two from their vertex (J. Ruppert, concentric shells). New vertices on constraints are rounded to doubles:
/// their edges follow the constraint but for that. It always ends. The result is a function of places and
/// constraints, too.
///
/// Errors: those of delaunay(); kUnsuitable for constraints that cross, numbers out of range and outlines
/// that do not close, each by its number; kUsage for values that refinement cannot take.
[[nodiscard]] VKMESH_API Result<ConstrainedTriangulation> constrained_delaunay(
    std::span<const DVec2> points, std::span<const PointPair> constraints,
    const ConstrainedDelaunayOptions& options = {}, const Progress& progress = {});

}  // namespace vkmesh
