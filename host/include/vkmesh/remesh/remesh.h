// Remeshing: triangles of like size and good shape on the surface of another mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/analysis/creases.h>
#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/length.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// How long edges are to be: by the first that is given; by none, as long as those of the input on the
/// average.
struct RemeshSize {
  std::optional<Length> edge_length;  ///< Everywhere the same; above 0.
  /// As many faces, to within some percent; at least 1. Edges are everywhere of the same length.
  std::optional<std::size_t> faces;
  /// Edges by curvature, such that chords leave an arc by this; above 0.
  std::optional<Length> deviation;
  /// Bounds of lengths by curvature; above 0. Default 2 and 40 times the deviation.
  std::optional<Length> shortest, longest;
};

/// Curves that stay: vertices move along them only, and their ends, junctions and turns of more than 45
/// degrees stay in place. So does one vertex or more of each closed curve.
struct RemeshCurves {
  bool boundary_kept = false;  ///< The boundary stays as it is, bit by bit; else as other curves do.
  std::optional<CreaseOptions> creases;  ///< Edges where the surface bends. Default none.
  /// Half-edges of the input, either of the two of an edge: seams of attributes, borders of materials.
  std::span<const std::uint32_t> edges;
  /// How far a curve of the input may lie from the edges that take its place; at least 0. Default a twentieth
  /// of the shortest length that edges are to have, and for the boundary a fifth.
  std::optional<Length> tolerance;
};

struct RemeshOptions {
  RemeshSize size;
  RemeshCurves curves;
  std::span<const std::uint32_t> locked;  ///< Vertices that stay where they are. In any order.
  /// How far the surface may part from that of the input, both ways; above 0. It is seen at samples, with a
  /// margin for what lies between. Default any. Where the input bends
  /// so that edges of the length asked for cannot hold it, its own triangles stay.
  std::optional<Length> max_deviation;
  unsigned iterations = 10;       ///< Default 10.
  std::optional<double> seconds;  ///< No step begins after so many. Default none.
};

enum class RemeshStop {
  kDone,       ///< All iterations were done.
  kTimeLimit,  ///< RemeshOptions::seconds have passed.
};

/// "done", "time limit".
[[nodiscard]] VKMESH_API std::string name_of(RemeshStop stop);

/// A point of the input's surface: of a face, by the weights of its corners, which add up to 1.
struct SurfacePoint {
  std::uint32_t face = kInvalid;
  std::array<float, 3> weights{1, 0, 0};
};

struct Remeshed {
  HalfEdgeMesh mesh;
  std::vector<Vec3> positions;
  /// Points of the input, to take attributes from: first one for each vertex, then more for vertices on
  /// curves, where the two sides of a curve are of different faces.
  std::vector<SurfacePoint> origins;
  /// For each half-edge the number of the point in `origins` that its corner has, on its own side of curves.
  std::vector<std::uint32_t> corner_origins;
  /// For each face one of the input that is nearest to its middle, on its own side of curves.
  std::vector<std::uint32_t> source_faces;
  double edge_length = 0;       ///< What was asked for in the end; of sizes by curvature the longest.
  double largest_distance = 0;  ///< From a vertex to the surface of the input.
  std::size_t splits = 0, collapses = 0, swaps = 0;
  RemeshStop stop = RemeshStop::kDone;
};

/// M. Botsch and L. Kobbelt, "A remeshing approach to multiresolution modeling" (2004): in each iteration
/// edges longer than 4/3 of their target are split and those shorter than 4/5 collapsed, edges are swapped
/// where that brings valences nearer to 6 (4 on the boundary), and vertices move to the middle of the faces
/// around them, back on the original surface. Swaps of the last iterations enlarge the least angles instead.
/// Lengths by curvature after M. Dunyach, D. Vanderhaeghe, L. Barthe, M. Botsch, "Adaptive remeshing for
/// real-time mesh deformation" (2013).
///
/// No edit and no move turns a face by more than 60 degrees, and none breaks the manifold: orientation,
/// components, boundary loops and Euler characteristic stay. What would is left undone, so that meshes whose
/// topology or locks are finer than the target keep edges that are too short. Vertices that do not move have
/// their bits. A vertex goes to the nearest point of the surface that a walk from its last one finds, and
/// crosses no curve.
///
/// The same input gives the same bytes on any number of threads; vertices move on as many as the caller's TBB
/// arena has. Isolated vertices are dropped. O(n) an iteration, but that sorts take O(n log n). Errors:
/// kUnsuitable unless triangles and finite, or where more than 2^27 faces would come of it; kUsage
/// for options outside their range; kInterrupted; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<Remeshed> remesh(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                                 const RemeshOptions& options = {},
                                                 const Progress& progress = {});

}  // namespace vkmesh
