// Decimation: collapses and removals, cheapest first, by quadric error and other criteria.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/passes/collapse_costs.h>

namespace vkmesh {

/// What one step does to the mesh.
enum class DecimateOperation {
  kEdgeCollapse,      ///< Both ends of an edge become one point, which may be new.
  kHalfEdgeCollapse,  ///< One end of an edge moves to the other: no new points are made.
  kVertexRemoval      ///< A vertex goes, and the best triangulation of the hole takes the place of its faces.
};

enum class DecimateBoundary {
  kKept,     ///< Boundary vertices are locked: the boundary stays as it is.
  kInShape,  ///< Constraint planes hold the boundary's shape; see boundary_weight.
  kFree      ///< The boundary may shrink.
};

enum class AttributeKind {
  kPlain,  ///< Any numbers: texture coordinates, colours, …
  kNormal  ///< Three components, of unit length: made so again where they were mixed.
};

/// Values of the surface beside its place, borrowed. Linear within each face; they may differ on the two
/// sides of an edge, which then is a seam.
struct DecimateAttribute {
  std::uint32_t components = 1;   ///< Of a value.
  std::span<const float> values;  ///< One value after another.
  /// The value of each corner of the mesh, in the order of its half-edges. Empty: vertex v has value v.
  std::span<const std::uint32_t> corners;
  /// What it counts in the error. At 1, a change over the whole range of the values (the largest of the
  /// components' ranges; for normals, by the length of one) counts as a move by the diagonal of the bounding
  /// box. 0: it is carried along, and its seams are kept. Default 0.01.
  double weight = 0.01;
  AttributeKind kind = AttributeKind::kPlain;
};

/// Criteria beside the quadric error, which combine. Weights decide what goes first; bounds forbid. What was
/// beyond a bound before may stay so, but gets no worse.
struct DecimateCriteria {
  // What a removal costs is A (quadric_weight² Q + L² (density_weight² + aspect_weight² (1 - 1/R) +
  // normal_weight² (1 - cos α))), where A is the area that the vertex or edge stands for, Q its mean squared
  // distance to the planes, L the length of the edge that goes (of a vertex that goes, the root of the mean
  // square of those at it), R the worst aspect ratio of the new faces, and α the largest angle between a new
  // face's normal and the nearest of the old ones. Any weight but quadric_weight takes about ten times as
  // long, since costs may fall; each at least 0.
  double quadric_weight = 1;  ///< Default 1.
  /// At 1, a vertex is as dear as one that lies as far from the planes as from its neighbours: vertices go
  /// where they are dense. Default 0.
  double density_weight = 0;
  double aspect_weight = 0;  ///< Against long thin triangles. Default 0.
  double normal_weight = 0;  ///< Against faces that look where no face looked. Default 0.

  /// No point of the surface comes to lie farther than this from the original surface, and none of that
  /// farther from the surface: the Hausdorff distance, both ways, to the precision of the coordinates. In
  /// units of the positions, and as a share of the bounding box's diagonal. Guaranteed, as a sum of
  /// bounds that is kept with each face; it takes some ten times as long. Default none.
  std::optional<double> max_distance, max_relative_distance;
  /// Fill distance_bound without a bound. Default off.
  bool watch_distance = false;
  /// Each face of the original is handed on to the nearest one when it goes or moves, and no face comes to
  /// look farther than this from where one looked that was handed to it. Radians, in (0, π). Default none.
  std::optional<double> max_original_normal_deviation;
  /// Of faces that are made: the longest side over the height upon it, as a multiple of that of an
  /// equilateral triangle; at least 1. Default none.
  std::optional<double> max_aspect_ratio;
  /// No edge that is made is longer, in units of the positions. Default none.
  std::optional<double> max_edge_length;
  /// No vertex gets more edges; at least 3. Default none.
  std::optional<std::size_t> max_valence;
};

struct DecimateOptions {
  /// Default edge collapse.
  DecimateOperation operation = DecimateOperation::kEdgeCollapse;
  /// Of edge collapses. Default optimal.
  CollapsePlacement placement = CollapsePlacement::kOptimal;

  // Rules to stop by, of which any number may be set; the first that is met counts. None set: until no legal
  // collapse is left.
  /// Stop when this many faces are left (or one fewer: an interior collapse removes two).
  std::optional<std::size_t> target_faces;
  /// Stop when this many vertices are left, isolated ones not counted.
  std::optional<std::size_t> target_vertices;
  /// Stop when this share of the faces is left, in [0, 1].
  std::optional<double> target_ratio;
  /// Do no collapse whose error exceeds this: the root of the area-weighted mean squared distance, in units
  /// of the positions, to the planes that the kept vertex stands for (those of faces and of the boundary). Of
  /// a vertex that is removed: that of the point below or above it, to the planes that it stood for, and what
  /// the new edges lie below or above its own.
  std::optional<double> max_error;
  /// The same as a share of the bounding box's diagonal.
  std::optional<double> max_relative_error;
  /// Stop after this many seconds of work. The only rule whose result depends on the machine.
  std::optional<double> time_limit;

  /// A collapse is illegal when it turns the normal of a face that remains by more than this. Radians, in (0,
  /// π). Default 75 degrees. See `decimate`.
  double max_normal_deviation = 1.308996938995747;
  /// Default in shape.
  DecimateBoundary boundary = DecimateBoundary::kInShape;
  DecimateCriteria criteria;
  /// Weight of the constraint planes that stand on boundary edges, perpendicular to their face, relative to a
  /// plane of the same area; for a boundary kept in shape. Default 10.
  double boundary_weight = 10.0;
  /// Edges bent by at least this, radians in (0, π], are creases: constraint planes stand on them as on the
  /// boundary, one for each of their faces. Default none.
  std::optional<double> crease_angle;
  double crease_weight = 10.0;  ///< Of these planes. Default 10.
  /// See `decimate`.
  std::vector<DecimateAttribute> attributes;
  /// A number for each corner of the mesh, borrowed: corners at one vertex whose numbers differ are parted by
  /// seams, as those whose attributes differ are (materials, for example). Default none.
  std::span<const std::uint32_t> corner_groups;
  /// Constraint planes stand on seams as on the boundary, one for each face; this is their weight.
  /// Default 10.
  double seam_weight = 10.0;
  /// Vertices that are neither moved nor removed, in any order. A collapse may end in one.
  std::vector<std::uint32_t> locked_vertices;
  /// Edges that stay as they are, ends and all: half-edges, either of the two, where 3 f + i goes from corner
  /// i of face f to the next.
  std::vector<std::uint32_t> locked_edges;
  /// Faces that stay as they are, corners and all.
  std::vector<std::uint32_t> locked_faces;
  /// Before all else, take away each component whose bounding box has a diagonal of at most this, in units of
  /// the positions, or as a share of the whole mesh's diagonal. The component of most faces always stays.
  /// Default: none goes. Ratios remain those of all faces.
  std::optional<double> prune_size, prune_relative_size;
  /// Fill Decimated::history and Decimated::changes. The cheapest edges go first then even where the target
  /// is far and a sweep would be faster (docs/decimation.md), so that the result differs a little. Default
  /// off: it takes 28 bytes a collapse; 32 more for each face that vertex removals make, about four each
  /// time; and with attributes 12 for each wedge that collapses change, one or two each time, and 4 for each
  /// component.
  bool keep_history = false;
};

enum class DecimateStop {
  kTargetReached,   ///< target_faces, target_vertices or target_ratio was reached.
  kErrorBound,      ///< No collapse is left; some were refused for their error.
  kTimeLimit,       ///< time_limit has passed.
  kNoLegalCollapse  ///< Every remaining collapse is illegal (link condition, fold-over, locked vertices).
};

/// "target reached", "error bound", "time limit", "no legal collapse".
[[nodiscard]] std::string name_of(DecimateStop stop);

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
    std::uint32_t step = 0;  ///< Of the history.
    std::uint32_t face = kInvalid;
    std::array<std::uint32_t, 3> vertices{kInvalid, kInvalid, kInvalid};
    std::array<std::uint32_t, 3> wedges{kInvalid, kInvalid, kInvalid};  ///< With attributes.
  };
  /// From this collapse on corners of `wedge` are of `into`, which may be the same and has new values.
  struct Wedge {
    std::uint32_t step = 0;  ///< Of the history.
    std::uint32_t wedge = kInvalid, into = kInvalid;
  };
  /// The wedge of each corner of the input; empty without attributes and corner_groups.
  std::vector<std::uint32_t> corners;
  std::vector<Face> faces;    ///< In order of their steps.
  std::vector<Wedge> wedges;  ///< The same.
  /// For each attribute the values that `into` has from then on, one for each of `wedges`.
  std::vector<std::vector<float>> values;
};

template <class Point>
struct BasicDecimated {
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
  DecimateStop stop = DecimateStop::kTargetReached;
  /// The largest error of a collapse that was done, in units of the positions (see max_error) and as a share
  /// of the bounding box's diagonal.
  double error = 0, relative_error = 0;
  /// The largest attribute error of a collapse that was done: the root of the area-weighted mean of the
  /// squared changes of the attributes, as shares of their ranges, times their weights.
  double attribute_error = 0;
  /// At most this is the Hausdorff distance between the input, without what was pruned, and the result, in
  /// units of the positions; if DecimateCriteria watches it.
  std::optional<double> distance_bound;
  std::size_t collapses = 0;
  /// What prune_size took away.
  std::size_t pruned_components = 0, pruned_faces = 0;
  // How often a collapse was found illegal, and why.
  std::size_t rejected_link = 0;       ///< It would make the surface non-manifold, or nothing.
  std::size_t rejected_fold_over = 0;  ///< A face would fold over.
  std::size_t rejected_error = 0;      ///< Its error is too large.
  std::size_t rejected_locked = 0;     ///< Both ends are locked.
  std::size_t rejected_seam = 0;       ///< It would close, part or join seams.
  std::size_t rejected_criterion = 0;  ///< A bound of DecimateCriteria forbids it.
  /// Where no target was reached and no time limit: what holds the edges (of vertex removal, the vertices)
  /// that are left.
  struct Held {
    std::size_t link = 0, fold_over = 0, error = 0, locked = 0, boundary = 0, seam = 0, criterion = 0;
  } held;
};

using Decimated = BasicDecimated<Vec3>;

/// M. Garland and P. Heckbert, "Surface simplification using quadric error metrics" (1997): planes are
/// weighted by area, and the legal collapse of least error is done, again and again. Vertex removal after W.
/// Schroeder, J. Zarge, W. Lorensen, "Decimation of triangle meshes" (1992), with the best of all
/// triangulations of the hole: that from which the old surface lies least far, where both are seen along the
/// normal of the vertex. It makes no edge that exists, and gives the planes of the vertex to the corners of
/// the triangle below it, each its barycentric share. A vertex of more than 16 neighbours stays until it has
/// fewer.
///
/// Order: with optimal placement the error of an edge only rises, so edges lie in a MonotoneQueue under lower
/// bounds of their errors, and a collapse is among the cheapest to 1/16 octave. Half-edge collapses go the
/// same way. Midpoints may fall in error, and so may costs with other weights than that of the quadrics:
/// these lie in an AddressableHeap, and the cheapest goes first. Ties fall to the order of the input, so the
/// same input gives the same bytes everywhere.
///
/// Planes do not tell how far points move within them. Once a 32nd of the faces is left, and at the
/// boundary and locked vertices once a fourth is, a legal collapse of an edge therefore waits, unless
/// criteria other than the quadrics choose, until the errors that are due allow for the distance between the
/// faces before and after: at most 1.5 times the root mean square that they stand for. It is measured from
/// the ends of the edge, its middle and the middles of the edges around, to the faces on the other side.
///
/// Legal is a collapse that
/// - keeps the graph simple and the surface a manifold of the same topology: the link condition, H. Hoppe et
///   al., "Mesh optimization" (1993), with all boundary loops closed by one vertex;
/// - folds nothing over. In the plane that is the sign of an area. In space no rule of normals alone is
///   proof: comparing a face's normal before and after (a dot product above 0) lets two neighbours turn
///   against each other by up to 90 degrees each, until one lies upon the other, says nothing of a face
///   without area, and sums up over many collapses. So here: no face turns by more than
///   max_normal_deviation; none loses its area, a sliver whose height falls below a share of its length
///   included, unless it had none, and then it must agree with the faces around it; and no two neighbours
///   about the kept vertex come to stand against each other by more than 120 degrees, or more than some did
///   before.
///
/// Attributes: H. Hoppe, "New quadric metric for simplifying meshes with appearance attributes" (1999). The
/// error of a collapse is that of the planes plus, for each attribute, weight² times the squared deviation,
/// over the faces, of its values from those that the new point gets, which are the best for its place; what
/// is said above of the order holds. max_error and `error` are of the planes alone. A vertex that does not
/// move keeps its values. An edge is a seam where values differ between its two sides at one of its ends, and
/// all attributes have the same seams. Both sides of a seam share their points, so none opens; a collapse
/// along a seam joins both sides at once; and no collapse is legal that changes which curves the seams and
/// the boundary form, or leaves a chart between them without a face. Vertices where seams end, meet or reach
/// the boundary are locked.
///
/// Of a vertex that is removed, attributes count where old and new edges cross when seen along the normal: by
/// the values of both; and at the corners of the triangle below it, which take over what it stands for, each
/// its share: by what their values differ from that, as in a collapse into them. The best triangulation is
/// the best for all of it. A vertex of a seam goes along the seam: to the nearest point of the edge that
/// joins its two neighbours there, which is made and becomes the seam, while each side is filled for itself,
/// with its own values, and counts for itself; the ends of that edge take over. No value is made that the
/// input does not have, and each corner of a new face has that of its vertex on its side. No removal is legal
/// that takes the last face of a chart or the last vertex that a seam differs at.
///
/// Positions are taken relative to the middle of their bounding box and to its size, so that neither a far
/// origin nor a tiny or huge unit costs precision; points that do not move come back bit by bit. One thread.
/// O(n log n) for midpoints, else about O(n). Memory: less than 160 bytes a vertex with a result of a tenth,
/// 36 more for midpoints, and 28 more where the input's order has no locality and is replaced by one along a
/// Morton curve; with attributes about 120 more, and 20 for each component. Isolated vertices are dropped.
/// Errors: kUnsuitable unless triangles, finite and manifold; kUsage for options outside their range;
/// kInterrupted; kOutOfMemory.
[[nodiscard]] Result<Decimated> decimate(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                         const DecimateOptions& options, const Progress& progress = {});
[[nodiscard]] Result<BasicDecimated<DVec3>> decimate(const HalfEdgeMesh& mesh,
                                                     std::span<const DVec3> positions,
                                                     const DecimateOptions& options,
                                                     const Progress& progress = {});
/// From arrays, without half-edges: faster than to_half_edge_mesh() and the above.
[[nodiscard]] Result<Decimated> decimate(const TriangleSurface& surface, const DecimateOptions& options,
                                         const Progress& progress = {});

}  // namespace vkmesh
