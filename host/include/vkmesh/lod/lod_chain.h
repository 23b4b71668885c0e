// Static levels of detail: a surface at several numbers of faces, each made from the one before.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/math/length.h>
#include <vkmesh/mesh/triangle_surface.h>

namespace vkmesh {

/// Whose vertices a level has.
enum class LodVertices {
  kOwn,    ///< Its own, in the order of the input.
  kShared  ///< The first of those of the level before, so that one vertex buffer serves all levels.
};

/// One of `ratios`, `errors` and `count` says which levels there are beside level 0, the input.
struct LodChainOptions {
  /// The share of the input's faces of level 1, 2, …; falling, in (0, 1).
  std::vector<double> ratios;
  /// The largest quadric error (see DecimateBounds::error) of level 1, 2, …; rising, above 0.
  std::vector<Length> errors;
  std::size_t count = 0;   ///< Levels in all; each has `reduction` times the faces of the one before.
  double reduction = 0.5;  ///< In (0, 1). Default 0.5.
  /// What holds for all levels. Of the target only `seconds`, for all of them, and `force` may be set, and
  /// `keep_history` not; the error may be bounded where `errors` is empty.
  DecimateOptions decimate;
  /// Default own. Edge collapses move points, so that no two levels share them.
  LodVertices vertices = LodVertices::kOwn;
  /// Orders the faces of each level for the caches of a renderer (meshoptimizer's order for vertex caches),
  /// and vertices by their first use. Default off. Refused where vkmesh was built without meshoptimizer.
  bool optimize = false;
  /// Measures how far each level lies from the input: fills LodLevel::distance. Default off.
  bool measure = false;
  SurfaceDistanceOptions measuring;
};

/// A level: the surface, and what its decimation from the input was. `error`, `attribute_error`, `collapses`
/// and `rejected` are those of all removals since the input, and so rise from level to level;
/// `distance_bound` bounds the distance from the input, too.
struct LodLevel : Decimated {
  std::optional<SurfaceDistance> distance;  ///< From the input (A) to this level (B); if asked for.
};

struct LodChain {
  /// From the finest to the coarsest. The first is the input, without isolated vertices and without what
  /// prune_size takes away. Faces fall strictly: a level that would have as many as the one before is left
  /// out.
  std::vector<LodLevel> levels;
  /// The last decimation that was tried: its `stop` says why the chain ends, and `blocked` what blocks the
  /// next level, where not all levels could be made.
  DecimationReport last;
};

/// One decimation (see `decimate`) that stops at each level: quadrics and bounds are carried on, so that a
/// level of n faces is as near to the input as a decimation straight to n, and the chain takes little more
/// time than its last level alone (the idea of H. Hoppe, "Progressive meshes", 1996: levels of one sequence
/// of removals). Each level is a manifold with the input's topology; those of half-edge collapses and
/// vertex removals have vertices of the level before.
///
/// Shared vertices are numbered by first use, the coarsest level's first, and so are wedges: with n vertices
/// at level k, these are the first n of every finer level, with the same places and values, and the wedges
/// likewise. The vertex buffer of the chain is that of level 0.
///
/// The first level that cannot be made as asked is the last: `last.stop` says what held it. About the time of
/// one decimation, and 20 ns for each face and vertex of the input a level. Errors: those of `decimate`;
/// kUsage for options outside their range, for shared vertices with edge collapses, and for `optimize`
/// without meshoptimizer.
[[nodiscard]] VKMESH_API Result<LodChain> lod_chain(const TriangleSurface& surface,
                                                    const LodChainOptions& options,
                                                    const Progress& progress = {});

/// Whether LodChainOptions::optimize is there.
[[nodiscard]] VKMESH_API bool has_vertex_cache_order();

}  // namespace vkmesh
