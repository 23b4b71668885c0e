// Heap-driven decimation by half-edge collapse with quadric error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/half_edge_mesh.h>
#include <vkmesh/progress.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

namespace vkmesh {

struct DecimateOptions {
  /// Stop when this many faces are left (or one fewer: an interior collapse removes two). Unset: no such
  /// bound.
  std::optional<std::size_t> target_faces;
  /// Stop before the first collapse whose error exceeds this: the root of the area-weighted mean squared
  /// distance, in units of the positions, to the planes of the faces that the kept vertex stands for. Unset:
  /// no such bound.
  std::optional<double> max_error;
  /// A collapse is illegal when it turns the normal of a face that remains by more than this. Radians, in (0,
  /// π). Default 75 degrees.
  double max_normal_deviation = 1.308996938995747;
  /// Weight of the constraint planes that stand on boundary edges, perpendicular to their face, relative to a
  /// plane of the same area. 0 lets the boundary shrink. Default 100.
  double boundary_weight = 100.0;
};

enum class DecimateStop {
  kTargetReached,   ///< target_faces was reached.
  kErrorBound,      ///< No collapse is left; some were refused for their error.
  kNoLegalCollapse  ///< Every remaining collapse is illegal (link condition, fold-over).
};

/// "target reached", "error bound", "no legal collapse".
[[nodiscard]] std::string name_of(DecimateStop stop);

struct Decimated {
  HalfEdgeMesh mesh;
  std::vector<Vec3> positions;
  /// For each vertex of `mesh` the vertex of the input it was; ascending. A half-edge collapse makes no new
  /// points.
  std::vector<std::uint32_t> source_vertex;
  DecimateStop stop = DecimateStop::kTargetReached;
  double error =
      0;  ///< The largest error of a collapse that was done, in units of the positions (see max_error).
  std::size_t collapses = 0;
  std::size_t rejected_link = 0;  ///< Collapses found illegal because their ends share a third neighbour.
  std::size_t rejected_fold_over = 0;  ///< Collapses found illegal because a face would fold over.
};

/// M. Garland and P. Heckbert, "Surface simplification using quadric error metrics" (1997), restricted to
/// half-edge collapses (lecture, "Half-edge collapse"): the cheapest legal collapse p → q is done, again and
/// again. Costs lie in an addressable heap, so that a removal costs O(log n). Legal is what keeps the graph
/// simple and the surface manifold (the link condition, H. Hoppe et al., "Mesh optimization", 1993) and folds
/// no face over. Ties fall to the smaller half-edge, so the same input gives the same bytes everywhere.
/// Isolated vertices are dropped. Errors: kUnsuitable unless triangles; kUsage for options outside their
/// range; kInterrupted; kOutOfMemory.
[[nodiscard]] Result<Decimated> decimate(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                         const DecimateOptions& options, const Progress& progress = {});

}  // namespace vkmesh
