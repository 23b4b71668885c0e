// Decimation: fewer triangles, by edge collapses, half-edge collapses or vertex removals.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/decimation/reason.h>
#include <vkmesh/math/length.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/triangle_surface.h>

namespace vkmesh {

/// What one step does to the mesh.
enum class DecimateOperation {
  kEdgeCollapse,      ///< Both ends of an edge become one point, which may be new.
  kHalfEdgeCollapse,  ///< One end of an edge moves to the other: no new points are made.
  kVertexRemoval      ///< A vertex goes, and the best triangulation of the hole takes the place of its faces.
};

enum class DecimateBoundary {
  kKept,     ///< Boundary vertices are locked: the boundary stays as it is.
  kInShape,  ///< Constraint planes hold the boundary's shape; see DecimateCurves.
  kFree      ///< The boundary may shrink.
};

enum class AttributeKind {
  kPlain,  ///< Any numbers: texture coordinates, colours, …
  kNormal  ///< Three components, of unit length: made so again where they were mixed.
};

/// Values of the surface beside its place, borrowed. Linear within each face; they may differ on the two
/// sides of an edge, which then is a seam.
struct DecimateAttribute {
  std::uint32_t components = 1;   ///< Scalars of a value.
  std::span<const float> values;  ///< One value after another.
  /// The value of each corner of the mesh, in the order of its half-edges. Empty: vertex v has value v.
  std::span<const std::uint32_t> corners;
  /// What it counts in the error. At 1, a change over the whole range of the values (the largest of the
  /// components' ranges; for normals, by the length of one) counts as a move by the diagonal of the bounding
  /// box. 0: it is carried along, and its seams are kept. Default 0.01.
  double weight = 0.01;
  AttributeKind kind = AttributeKind::kPlain;
  /// Floats from one value to the next, for values in an interleaved vertex buffer: `values` then begins with
  /// the first of them. Default 0: as many as components.
  std::uint32_t stride = 0;

  /// Whole values in `values`.
  [[nodiscard]] std::size_t value_count() const {
    return components == 0 || values.size() < components ? 0 : (values.size() - components) / step() + 1;
  }
  [[nodiscard]] std::span<const float> value(std::size_t i) const {
    return values.subspan(i * step(), components);
  }

 private:
  [[nodiscard]] std::size_t step() const { return stride != 0 ? stride : components; }
};

/// When to stop: the first of these that is met counts. None set: when no legal removal is left.
struct DecimateTargets {
  /// This many faces are left, or one fewer: an interior removal takes two.
  std::optional<std::size_t> faces;
  /// This many vertices are left, isolated ones not counted.
  std::optional<std::size_t> vertices;
  /// This share of the faces is left, in [0, 1].
  std::optional<double> ratio;
  /// So many seconds have passed; at least 0. The only target whose result depends on the machine. Where they
  /// have before anything was removed, the result is the input without its isolated vertices, and nothing is
  /// pruned.
  std::optional<double> seconds;
  /// Go on to a target that what is locked, or held by seams or the boundary, puts out of reach. Default off:
  /// at least an eighth of the share that was asked for is left of the vertices that may go.
  bool force = false;
};

/// What a removal costs, the cheapest being done first: A (quadric² Q + L² (density² + aspect_ratio² (1 -
/// 1/R) + normals² (1 - cos α))). A is the area that the vertex or edge stands for and Q its mean squared
/// distance to the planes; L is the length of the edge that goes, or of a vertex that goes the root of the
/// mean square of those at it; R is the worst aspect ratio of the new faces, and α the largest angle between
/// the normal of a new face and the nearest of the old ones. Each weight is at least 0, and one is above. Any
/// but `quadric` makes decimation about ten times as slow.
struct DecimateWeights {
  double quadric = 1;  ///< Default 1.
  /// At 1, a vertex is as dear as one that lies as far from the planes as from its neighbours: vertices go
  /// where they are dense. Default 0.
  double density = 0;
  double aspect_ratio = 0;  ///< Against long thin triangles. Default 0.
  double normals = 0;       ///< Against faces that look where no face looked. Default 0.
};

/// What is forbidden, whatever it costs. What was beyond a bound before may stay so, but gets no worse.
struct DecimateBounds {
  /// The largest quadric error of a removal: the root of the area-weighted mean squared distance to the
  /// planes that the kept vertex stands for (those of faces and of the boundary). Of a vertex that is
  /// removed: that of the point below or above it, to the planes that it stood for, and what the new edges
  /// lie below or above its own. Default none.
  std::optional<Length> error;
  /// The Hausdorff distance, both ways, between the surface and the original, to the precision of the
  /// coordinates. Guaranteed, by a sum of bounds that is kept with each face; about ten times as slow.
  /// Default none.
  std::optional<Length> distance;
  /// Fill DecimationReport::distance_bound without a bound. Default off.
  bool report_distance = false;
  /// The angle by which one removal may turn the normal of a face that remains. Radians, in (0, π). Default
  /// 75 degrees.
  double normal_deviation = 1.308996938995747;
  /// The angle between the normal of a face and the nearest of those of the original's faces that it stands
  /// for: each is handed on to the nearest face when it goes or moves. Radians, in (0, π). Default none.
  std::optional<double> original_normal_deviation;
  /// Bounds faces that are made: the longest side over the height upon it, as a multiple of that of an
  /// equilateral triangle; at least 1. Default none.
  std::optional<double> aspect_ratio;
  /// Bounds the length of edges that are made; above 0. Default none.
  std::optional<Length> edge_length;
  /// The edges at a vertex that gets some; at least 3. Default none.
  std::optional<std::size_t> valence;
};

/// How boundary, creases and seams keep their shape: by constraint planes that stand on their edges,
/// perpendicular to a face, each with a weight relative to a plane of the same area; at least 0.
struct DecimateCurves {
  DecimateBoundary boundary = DecimateBoundary::kInShape;  ///< Default in shape.
  double boundary_weight = 10;                             ///< For a boundary kept in shape. Default 10.
  /// Edges bent by at least this are creases. Radians, in (0, π]. Default none.
  std::optional<double> crease_angle;
  double crease_weight = 10;  ///< One plane for each face. Default 10.
  double seam_weight = 10;    ///< The same on seams. Default 10.
};

/// What stays as it is. Numbers in any order.
struct DecimateLocks {
  /// Neither moved nor removed. A collapse may end in one.
  std::vector<std::uint32_t> vertices;
  /// Ends and all: half-edges, either of the two, where 3 f + i goes from corner i of face f to the next.
  std::vector<std::uint32_t> edges;
  std::vector<std::uint32_t> faces;  ///< Corners and all.
};

struct DecimateOptions {
  /// Default edge collapse.
  DecimateOperation operation = DecimateOperation::kEdgeCollapse;
  DecimateTargets target;
  DecimateWeights weights;
  DecimateBounds bounds;
  DecimateCurves curves;
  DecimateLocks locked;
  /// See `decimate`. Default none.
  std::vector<DecimateAttribute> attributes;
  /// A number for each corner of the mesh, borrowed: corners at one vertex whose numbers differ are separated
  /// by seams, as those whose attributes differ are (materials, for example). Default none.
  std::span<const std::uint32_t> corner_groups;
  /// Before all else, take away each component whose bounding box has a diagonal of at most this. The
  /// component of most faces always stays. Ratios remain those of all faces. Default: none goes.
  std::optional<Length> prune_size;
  /// Fill BasicDecimated::history and changes. The cheapest go first then from the start, so that the result
  /// differs a little where the target is far. Default off: it takes 28 bytes a collapse; 32 more for each
  /// face that vertex removals make, about four each time; and with attributes 12 for each wedge that
  /// collapses change, one or two each time, and 4 for each component.
  bool keep_history = false;
};

enum class DecimateStop {
  kTargetReached,    ///< One of DecimateTargets but the time was met.
  kErrorBound,       ///< No collapse is left; some were refused for their error.
  kTimeLimit,        ///< DecimateTargets::seconds have passed.
  kOutOfProportion,  ///< The target is out of reach, and was not to be forced; see DecimateTargets::force.
  kNoLegalCollapse   ///< Every remaining collapse is illegal (link condition, fold-over, locked vertices).
};

/// "target reached", "error bound", "time limit", "out of proportion", "no legal collapse".
[[nodiscard]] VKMESH_API std::string name_of(DecimateStop stop);

/// One collapse or removal. Vertices and faces are the input's.
template <class Point>
struct Collapse {
  /// The vertex that stands for both from now on. Of a removal: the neighbour nearest to the one that went.
  std::uint32_t kept = kInvalid;
  std::uint32_t removed = kInvalid;  ///< The one that it has absorbed.
  Point position{};                  ///< Where `kept` lies from now on.
  /// The faces that went; on the boundary one is kInvalid.
  std::array<std::uint32_t, 2> faces{kInvalid, kInvalid};
};

/// Attributes of what is left, as a vertex buffer has them: the corners of a vertex that share all values and
/// hang together are one element, a wedge.
struct DecimatedAttributes {
  std::vector<std::uint32_t> corners;  ///< The wedge of each corner of the mesh, numbered as they come.
  /// For each attribute its values, one for each wedge. None lies outside the range of the input's.
  std::vector<std::vector<float>> values;
  /// For each wedge a corner of the input that had it. Where the vertex was not moved it has its values, bit
  /// by bit.
  std::vector<std::uint32_t> source_corner;
};

/// What the steps of a history do beside moving points: with it the input becomes the result, step by step
/// and bit by bit, in faces, corners and attributes.
///
/// A wedge goes by the corner of the input that DecimatedAttributes::source_corner names, and starts with the
/// values of that corner. A collapse puts `kept` in the place of `removed` in every face, and the wedges at
/// both may become others or get new values. A vertex removal gives faces new corners; no values change. Both
/// take away Collapse::faces. What was pruned is no part of it.
struct DecimationChanges {
  /// A face that a vertex removal has given new corners, in their order.
  struct Face {
    std::uint32_t step = 0;  ///< The step of the history.
    std::uint32_t face = kInvalid;
    std::array<std::uint32_t, 3> vertices{kInvalid, kInvalid, kInvalid};
    std::array<std::uint32_t, 3> wedges{kInvalid, kInvalid, kInvalid};  ///< With attributes.
  };
  /// From this collapse on corners of `wedge` are of `into`, which may be the same and has new values.
  struct Wedge {
    std::uint32_t step = 0;  ///< The step of the history.
    std::uint32_t wedge = kInvalid, into = kInvalid;
  };
  /// The wedge of each corner of the input; empty without attributes and corner_groups.
  std::vector<std::uint32_t> corners;
  std::vector<Face> faces;    ///< In order of their steps.
  std::vector<Wedge> wedges;  ///< The same.
  /// For each attribute the values that `into` has from then on, one for each of `wedges`.
  std::vector<std::vector<float>> values;
};

/// What a decimation did, and what it cost.
struct DecimationReport {
  DecimateStop stop = DecimateStop::kTargetReached;
  /// The largest quadric error of a removal that was done, in units of the positions (see
  /// DecimateBounds::error) and as a share of the bounding box's diagonal.
  double error = 0, relative_error = 0;
  /// The largest attribute error of a removal that was done: the root of the area-weighted mean of the
  /// squared changes of the attributes, as shares of their ranges, times their weights.
  double attribute_error = 0;
  /// At most this is the Hausdorff distance between the input, without what was pruned, and the result, in
  /// units of the positions; if DecimateBounds asks for it.
  std::optional<double> distance_bound;
  std::size_t collapses = 0;  ///< Or removals.
  /// What prune_size took away.
  std::size_t pruned_components = 0, pruned_faces = 0;
  /// How often a removal was found illegal, and why.
  CountByReason rejected;
  /// Where no target was met: what blocks the edges (of vertex removal, the vertices) that are left.
  CountByReason blocked;
};

template <class Point>
struct BasicDecimated : DecimationReport {
  HalfEdgeMesh mesh;
  std::vector<Point> positions;
  /// For each vertex of `mesh` the vertex of the input whose place it keeps in the history; ascending. A
  /// half-edge collapse leaves it where it was.
  std::vector<std::uint32_t> source_vertex;
  /// For each face of `mesh` the face of the input it was; ascending. Its corners keep their order. After
  /// vertex removal: one of those whose place it has taken, on its own side of seams.
  std::vector<std::uint32_t> source_face;
  /// For each vertex of the input the vertex of `mesh` that stands for it; kInvalid for isolated ones and
  /// those of pruned components, which are dropped.
  std::vector<std::uint32_t> vertex_map;
  DecimatedAttributes attributes;  ///< Empty without attributes and corner_groups.
  /// Every collapse in order, if asked for.
  std::vector<Collapse<Point>> history;
  DecimationChanges changes;  ///< The same.
};

using Decimated = BasicDecimated<Vec3>;

/// M. Garland and P. Heckbert, "Surface simplification using quadric error metrics" (1997): planes are
/// weighted by area, and the legal collapse of least cost is done, again and again. Vertex removal after W.
/// Schroeder, J. Zarge, W. Lorensen, "Decimation of triangle meshes" (1992), with the best of all
/// triangulations of the hole: that from which the old surface lies least far, where both are seen along the
/// normal of the vertex. Where there is none, as on a sharp edge between faces large and small, the best fan
/// of a neighbour takes the place of the faces, as in a half-edge collapse. It makes no edge that exists, no
/// sliver (of less than 1e-4 of its squared sides) in the place of wider faces, and where the boundary is
/// kept no face with two sides there that turns by more than 30 degrees. It gives the planes of the vertex to
/// the corners of the triangle below it, each its barycentric share. A vertex of more than 16 neighbours
/// stays until it has fewer. An edge collapse puts its point where the error is least.
///
/// The same input gives the same bytes everywhere. Removals go by cost, to within 6 %; where the target is
/// far from a large surface, what goes first goes in another order that comes to the same error. Late, a
/// collapse waits while it would move the surface along itself by more than the error that is due.
///
/// Legal is a removal that
/// - keeps the graph simple and the surface a manifold of the same topology: the link condition, H. Hoppe et
///   al., "Mesh optimization" (1993), with all boundary loops closed by one vertex;
/// - folds nothing over: no face turns by more than DecimateBounds::normal_deviation; none loses its area, a
///   sliver whose height falls below a share of its length included, unless it had none, and then it must
///   agree with the faces around it; and no two neighbours about the kept vertex come to stand against each
///   other by more than 120 degrees, or more than some did before. (No rule of normals alone is proof in
///   space.)
/// - keeps what is locked, the curves that seams and boundary form, and the bounds.
///
/// Attributes: H. Hoppe, "New quadric metric for simplifying meshes with appearance attributes" (1999). The
/// cost of a collapse is that of the planes plus, for each attribute, weight² times the squared deviation,
/// over the faces, of its values from those that the new point gets, which are the best for its place. Bounds
/// and reports of the error are of the planes alone. A vertex that does not move keeps its values. An edge is
/// a seam where values differ between its two sides at one of its ends, and all attributes have the same
/// seams. Both sides of a seam share their points, so none opens; a collapse along a seam joins both sides at
/// once; and none is legal that leaves a chart without a face. Vertices where seams meet or reach the
/// boundary are locked. Where a seam ends, the values at its last edge differ at the other end alone, and the
/// vertex goes as any other: a pole of a sphere, with a value for each face there, loses one with each vertex
/// next to it.
///
/// Attributes of a vertex that is removed count where old and new edges cross when seen along the normal: by
/// the values of both; and at the corners of the triangle below it, which take over what it stands for, each
/// its share: by what their values differ from that, as in a collapse into them. The best triangulation is
/// the best for all of it. A vertex of a seam goes along the seam: to the nearest point of the edge that
/// joins its two neighbours there, which is made and becomes the seam, while each side is filled for itself,
/// with its own values, and counts for itself; the ends of that edge take over. No value is made that the
/// input does not have, and each corner of a new face has that of its vertex on its side. No removal is legal
/// that takes the last face of a chart or the last vertex that a seam differs at.
///
/// Neither a far origin nor a tiny or huge unit costs precision, and points that do not move come back bit by
/// bit. Isolated vertices are dropped. Threads: as many as the caller's TBB arena has, for all but vertex
/// removals and the collapses that attributes, weights or bounds other than the error and the normal
/// deviation have a say in; the result does not depend on how many. About O(n). Memory: less than 160 bytes a
/// vertex with a result of a tenth; 28 more where the input's order has no locality; with weights 36 more;
/// with attributes about 120 more, and 20 for each component. Errors: kUnsuitable unless triangles, finite
/// and manifold; kUsage for options outside their range; kInterrupted; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<Decimated> decimate(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                                    const DecimateOptions& options,
                                                    const Progress& progress = {});
[[nodiscard]] VKMESH_API Result<BasicDecimated<DVec3>> decimate(const HalfEdgeMesh& mesh,
                                                                std::span<const DVec3> positions,
                                                                const DecimateOptions& options,
                                                                const Progress& progress = {});
/// From arrays, without half-edges: faster than to_half_edge_mesh() and the above.
[[nodiscard]] VKMESH_API Result<Decimated> decimate(const TriangleSurface& surface,
                                                    const DecimateOptions& options,
                                                    const Progress& progress = {});

}  // namespace vkmesh
