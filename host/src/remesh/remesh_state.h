// The mesh while it is remeshed, and what its steps share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/geometric.hpp>

#include <vkmesh/math/vec.h>

#include "base/stop.h"
#include "mesh/edit/edit_mesh.h"
#include "remesh/deviation_bound.h"
#include "remesh/feature_curves.h"
#include "remesh/original_surface.h"
#include "remesh/target_lengths.h"

namespace vkmesh::detail {

enum class VertexKind : std::uint32_t {
  kFree,   ///< Moves on the surface.
  kCurve,  ///< Moves along a curve.
  kFixed   ///< Stays.
};

/// Coordinates are those of the input times a power of two, and values that a float of the input's scale
/// has: what tests find on them holds for the result.
struct RemeshVertex {
  DVec3 position;
  std::uint32_t leading;  // for the mesh
  /// Where it is on the original: a face if it is free, a curve if it lies on one, a vertex if it is fixed.
  std::uint32_t place;
  double along;  // a curve
  float length;  // that edges are to have here
  /// The number of edges, that to the apex included, and the best one.
  std::uint32_t valence : 20, best_valence : 9;
  std::uint32_t is_placed : 1;  // a free one on the original surface, not on an edge that was split
  VertexKind kind : 2;

  [[nodiscard]] bool alive() const { return (leading & kVertexGone) == 0; }
  [[nodiscard]] bool is_free() const { return kind == VertexKind::kFree; }
};
static_assert(sizeof(RemeshVertex) == 48);

using RemeshMesh = EditMesh<RemeshVertex>;

/// Tags of half-edges, both of an edge: it is of a curve; it is neither split nor collapsed; it was to be
/// split, and could not, for the time that splits are done.
inline constexpr unsigned kCurveTag = 0, kKeptTag = 1, kRefusedTag = 2;

/// Edges are split beyond this multiple of their target length, and collapsed below that: what comes of
/// either is nearer to the target than what was (M. Botsch, L. Kobbelt, "A remeshing approach to
/// multiresolution modeling", 2004).
inline constexpr double kSplitBeyond = 4.0 / 3.0, kCollapseBelow = 4.0 / 5.0;
/// Collapses make no edges beyond this multiple of their target: by a little more than what is split again,
/// or regular meshes that are too dense, whose collapses all make edges of 3/2 of theirs, would stay so.
inline constexpr double kLongestMade = 1.4;

struct RemeshState {
  RemeshMesh mesh;
  OriginalSurface& surface;
  Stop& stop;
  FeatureCurves curves;
  TargetLengths lengths;
  DeviationBound deviation;
  double scale = 1, inverse_scale = 1;                   // of coordinates, powers of two
  double curve_tolerance2 = 0, boundary_tolerance2 = 0;  // squared, of curves from their chords
  std::size_t splits = 0, collapses = 0, swaps = 0;
  /// Splits end with these: beside edges that cannot be split there may be no end of edges that are too long.
  std::size_t splits_left = 0;

  /// Whether the step is to end after so many edits: what it has done is whole.
  [[nodiscard]] bool is_stopped(std::size_t edits) const {
    if (edits % 1024 == 0) stop.ask();
    return stop.is_set();
  }
  [[nodiscard]] const DVec3& position(std::uint32_t v) const { return mesh.vertices[v].position; }
  [[nodiscard]] bool is_curve(std::uint32_t h) const { return mesh.has_tag(h, kCurveTag); }
  [[nodiscard]] DVec3 rounded(const DVec3& p) const { return DVec3(Vec3(p * inverse_scale)) * scale; }

  [[nodiscard]] double squared_length(std::uint32_t h) const {
    const DVec3 d = position(mesh.target(h)) - position(mesh.origin(h));
    return glm::dot(d, d);
  }
  /// The target length of an edge.
  [[nodiscard]] double target(std::uint32_t v, std::uint32_t w) const {
    return static_cast<double>(std::min(mesh.vertices[v].length, mesh.vertices[w].length));
  }

  /// The curve of an edge of one.
  [[nodiscard]] std::uint32_t curve_of(std::uint32_t h) const {
    const std::uint32_t v = mesh.origin(h), w = mesh.target(h);
    for (const std::uint32_t end : {v, w})
      if (mesh.vertices[end].kind == VertexKind::kCurve) return mesh.vertices[end].place;
    return curves.single_edge(mesh.vertices[v].place, mesh.vertices[w].place);
  }
  /// Where one of the vertices of a curve is along it.
  [[nodiscard]] double along(std::uint32_t curve, std::uint32_t v) const {
    const RemeshVertex& vertex = mesh.vertices[v];
    return vertex.kind == VertexKind::kCurve ? vertex.along : curves.along_end(curve, vertex.place);
  }
  /// The squared distance that a curve may have from the chords that take its place.
  [[nodiscard]] double tolerance2(std::uint32_t curve) const {
    return curves.is_boundary(curve) ? boundary_tolerance2 : curve_tolerance2;
  }
  /// The point of the original surface at the origin of h, on the side of curves where the face of h is.
  [[nodiscard]] Foot original_at(std::uint32_t h) const;
  /// A face of the original that is near that of h, and of its patch.
  [[nodiscard]] std::uint32_t original_near(std::uint32_t h) const;
};

/// Twice the area of a triangle, along its normal.
[[nodiscard]] inline DVec3 area_vector(const DVec3& a, const DVec3& b, const DVec3& c) {
  return glm::cross(b - a, c - a);
}

/// The squared tangent of the least angle: 3 for an equilateral triangle, 0 for one without area.
[[nodiscard]] inline double shape_of(const DVec3& a, const DVec3& b, const DVec3& c) {
  const DVec3 ab = b - a, bc = c - b, ca = a - c;
  const double ab2 = glm::dot(ab, ab), bc2 = glm::dot(bc, bc), ca2 = glm::dot(ca, ca);
  const DVec3 area = glm::cross(ab, ca);
  // The sides at the least angle are the two longer ones; twice their product is what the sides say.
  const double product = 0.5 * (ab2 + bc2 + ca2) - std::min({ab2, bc2, ca2});
  return product > 0 ? glm::dot(area, area) / (product * product) : 0;
}
/// The same of angles in degrees.
inline constexpr double kShape15 = 0.071797, kShape20 = 0.132474, kShape30 = 0.333333;

/// A face turns by less than this in an edit or a move: 60 degrees.
inline constexpr double kCosMostTurn = 0.5;
/// Two faces that a swap makes stand at less than this to each other, unless those before did not: 45
/// degrees.
inline constexpr double kCosMostBend = 0.7071067811865476;
/// Two faces fold where they come to stand at more than this to each other: 120 degrees.
inline constexpr double kCosFold = -0.5;

/// The cosine of the angle between two vectors; 1 where one has no length.
[[nodiscard]] inline double cosine(const DVec3& a, const DVec3& b) {
  const double lengths = std::sqrt(glm::dot(a, a)) * std::sqrt(glm::dot(b, b));
  return lengths > 0 ? glm::dot(a, b) / lengths : 1.0;
}

/// Whether the shape of a triangle of this area vector is at least so good.
[[nodiscard]] inline bool is_shaped(const DVec3& a, const DVec3& b, const DVec3& c, const DVec3& area,
                                    double shape) {
  const DVec3 ab = b - a, bc = c - b, ca = a - c;
  const double ab2 = glm::dot(ab, ab), bc2 = glm::dot(bc, bc), ca2 = glm::dot(ca, ca),
               product = 0.5 * (ab2 + bc2 + ca2) - std::min({ab2, bc2, ca2});
  return glm::dot(area, area) >= shape * product * product;
}

/// Whether a face that changes keeps its side: its normal turns by less than the angle of the cosine.
/// `around`: the sum of the area vectors before, by which faces without area are judged.
[[nodiscard]] inline bool keeps_side(const DVec3& before, const DVec3& after, const DVec3& around,
                                     double cosine) {
  const double b2 = glm::dot(before, before), a2 = glm::dot(after, after);
  if (!(a2 > 0)) return !(b2 > 0);
  if (!(b2 > 0)) return glm::dot(around, after) >= 0;
  const double both = glm::dot(before, after);
  return both > 0 && both * both >= cosine * cosine * b2 * a2;
}

/// Whether two neighbouring faces come to stand against each other by more than 120 degrees, and by more than
/// before: a fold.
[[nodiscard]] inline bool folds(const DVec3& one_before, const DVec3& other_before, const DVec3& one,
                                const DVec3& other) {
  if (glm::dot(one, other) >= 0) return false;
  const double now = cosine(one, other);
  return now < kCosFold && now < cosine(one_before, other_before);
}

// The steps. Each says how many edits or moves it did.

/// Splits edges that are too long, the longest first, until there are none.
std::size_t split_long_edges(RemeshState& state);
/// Collapses edges that are too short, the shortest first.
std::size_t collapse_short_edges(RemeshState& state);
/// Swaps edges where that brings valences nearer to the best.
std::size_t swap_for_valence(RemeshState& state);
/// Swaps edges where that makes the least angle larger.
std::size_t swap_for_angles(RemeshState& state);
/// Takes triangles of small angles away: the shortest side of needles collapses.
std::size_t collapse_needles(RemeshState& state);
/// Moves vertices towards the middle of their neighbours, on the surface or along their curve.
std::size_t relax_vertices(RemeshState& state);

}  // namespace vkmesh::detail
