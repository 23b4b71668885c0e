// The stages of a decimation: check, prepare, coarsen, collapse or remove, gather. `reference.cpp` says what
// all of it comes to.
#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/decimation/decimate.h>

#include "base/parallel.h"
#include "decimation/cost/attribute_quadrics.h"
#include "decimation/decimate_levels.h"
#include "decimation/decimation_state.h"
#include "decimation/gather_result.h"
#include "decimation/legality/criteria.h"
#include "decimation/parallel/coarsen.h"
#include "decimation/removals.h"
#include "decimation/setup/build_mesh.h"
#include "decimation/setup/check_options.h"
#include "decimation/setup/held_vertices.h"
#include "decimation/setup/initial_quadrics.h"
#include "decimation/setup/packed_attributes.h"
#include "decimation/setup/prepare.h"
#include "decimation/setup/prune.h"
#include "decimation/unchanged_result.h"
#include "mesh/edge_matching.h"

namespace vkmesh {
namespace {

using namespace detail;

template <class Point>
Result<BasicDecimated<Point>> decimate_until(Stop& stop, std::span<const Point> points,
                                             std::span<const std::uint32_t> corners,
                                             const DecimateOptions& options, const PartitionSizes& sizes);

/// The vertices that are left of a part of the surface when all has gone that may, apart from the rest and
/// from attributes; those locked before stay.
template <class Point>
Result<std::size_t> left_of_part(const CollapseMesh& mesh, std::span<const Point> points, const Frame& frame,
                                 const DecimateOptions& options, const Part& part,
                                 const PartitionSizes& sizes) {
  DecimateOptions alone;
  alone.operation = options.operation;
  alone.weights = options.weights;
  alone.bounds = options.bounds;
  alone.curves = options.curves;
  alone.bounds.report_distance = false;
  for (std::optional<Length>* bound :
       {&alone.bounds.error, &alone.bounds.distance, &alone.bounds.edge_length})
    if (*bound) *bound = Length::absolute((*bound)->in_units(frame.diagonal));
  std::vector<Point> places;
  for (std::uint32_t i = 0; i < part.vertices.size(); ++i) {
    const VertexRecord& vertex = mesh.vertices[part.vertices[i]];
    places.push_back(points[vertex.source & VertexRecord::kSourceMask]);
    if (vertex.has(VertexRecord::kLocked)) alone.locked.vertices.push_back(i);
  }
  const Progress silent;
  Stop never(silent, Stop::Clock::now(), std::numeric_limits<double>::infinity());
  VKMESH_TRY(const BasicDecimated<Point> left,
             decimate_until<Point>(never, places, part.corners, alone, sizes));
  return left.positions.size();
}

/// The limits of each level; without levels the one that the options ask for.
std::vector<Limits> limits_of_levels(const DecimateOptions& options, std::span<const LevelTarget> levels,
                                     std::size_t faces, const Frame& frame) {
  std::vector<Limits> limits(std::max<std::size_t>(levels.size(), 1), limits_of(options, faces, frame));
  for (std::size_t k = 0; k < levels.size(); ++k) {
    limits[k].faces = levels[k].faces;
    if (!levels[k].error) continue;
    const double error = frame.scale * levels[k].error->in_units(frame.diagonal);
    limits[k].error2 = error * error;
  }
  return limits;
}

/// Forgets which edges were queued, parked or at an interface, so that the next level begins anew; without
/// what numbers faces and vertices apart from the mesh, what is gone is forgotten, too.
void begin_again(DecimationState& state) {
  CollapseMesh& mesh = state.mesh;
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  if (state.attributes == nullptr && state.criteria == nullptr)
    mesh.compact();
  else
    parallel_ranges(mesh.half_edge_bound() / 4, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) mesh.face(static_cast<std::uint32_t>(4 * f)).tags = 0;
    });
  parallel_ranges(mesh.vertex_bound(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) mesh.vertices[v].source &= ~VertexRecord::kHasParked;
  });
  state.first_faces = state.faces;
  state.first_vertices = state.vertices;
}

/// Where an end is one that was asked for.
bool is_met(DecimateStop stop, const LevelTarget& level) {
  return stop == DecimateStop::kTargetReached || (stop == DecimateStop::kErrorBound && level.error);
}

/// Gives the surface at each level to `sink`, the first that meets no target being the last. Until something
/// has been removed, a time that is over ends it with kInterrupted.
template <class Point, class Sink>
Result<void> decimate_through(Stop& stop, std::span<const Point> points,
                              std::span<const std::uint32_t> corners, const DecimateOptions& options,
                              const PartitionSizes& sizes, std::span<const LevelTarget> levels, Sink&& sink) {
  // Prepare
  VKMESH_CHECK(stop.go_on());
  VKMESH_TRY(BuiltMesh built, build_mesh(points, corners, stop));
  CollapseMesh& mesh = built.mesh;
  const Frame& frame = built.frame;
  lock_vertices(mesh, corners, options);
  std::optional<Wedges> wedges = find_wedges(mesh, points.size(), options, stop);
  VKMESH_CHECK(stop.go_on());
  sum_quadrics(mesh, constraint_weights(options.curves, wedges), &stop);
  VKMESH_CHECK(stop.go_on());
  std::optional<AttributeQuadrics> attributes;
  if (wedges)
    attributes.emplace(mesh, points.size(), std::move(*wedges), options.attributes, corners,
                       frame.diagonal * frame.scale, options.operation == DecimateOperation::kVertexRemoval,
                       stop);
  VKMESH_CHECK(stop.go_on());
  if (attributes && options.keep_history) attributes->keep_changes();
  Pruned pruned;
  if (options.prune_size) {
    const double size = frame.scale * options.prune_size->in_units(frame.diagonal);
    VKMESH_TRY(pruned, prune_components(mesh, static_cast<float>(size), stop));
  }
  Criteria criteria(options.weights, options.bounds, frame, mesh);
  std::vector<Limits> ahead = limits_of_levels(options, levels, mesh.face_count(), frame);
  const std::size_t faces = mesh.face_count() - pruned.faces,
                    vertices = built.used_vertices - pruned.vertices;
  if (const double least = share_asked_for(ahead.back(), faces, vertices);
      least > 0 && !options.target.force) {
    const auto left_alone = [&](const Part& part) {
      return left_of_part(mesh, points, frame, options, part, sizes);
    };
    VKMESH_TRY(const std::size_t held,
               held_vertices(mesh, options, faces, vertices, least * static_cast<double>(vertices),
                             left_alone, stop));
    for (Limits& limits : ahead)
      keep_in_proportion(limits, share_asked_for(limits, faces, vertices), vertices, held);
  }
  Limits limits = ahead.front();
  DecimationState state{.mesh = mesh,
                        .limits = limits,
                        .faces = faces,
                        .vertices = vertices,
                        .keep_events = options.keep_history,
                        .attributes = attributes ? &*attributes : nullptr,
                        .criteria = criteria.ranks() || criteria.bounds() ? &criteria : nullptr,
                        .boundary_kept = options.curves.boundary == DecimateBoundary::kKept,
                        .mean_weight = mean_weight_of(mesh),
                        .sizes = sizes,
                        .stop = &stop};
  VKMESH_CHECK(stop.go_on());

  std::vector<std::uint32_t> before;  // what the vertices of the level before are in the input
  const auto remove = attributes ? remove_cheapest<true> : remove_cheapest<false>;
  for (std::size_t k = 0; k < ahead.size(); ++k) {
    limits = ahead[k];
    state.progress_from = static_cast<double>(k) / static_cast<double>(ahead.size());
    state.progress_to = static_cast<double>(k + 1) / static_cast<double>(ahead.size());
    if (state.outcome.collapses > 0) begin_again(state);

    // Coarsen; collapse or remove
    if (state.outcome.collapses == 0) coarsen_if_far_from_target(state);
    VKMESH_TRY(Outcome outcome, remove(state, options.operation));
    if (outcome.stop == DecimateStop::kTimeLimit && outcome.collapses == 0) VKMESH_CHECK(stop.go_on());

    // Gather
    VKMESH_TRY(BasicDecimated<Point> result, gather(mesh, points, corners.size() / 3, built.is_in_order,
                                                    frame, outcome, state.attributes, stop));
    if (k > 0 && result.vertex_map.size() == points.size()) {
      // From the vertices of the level before.
      for (std::uint32_t& v : before) v = result.vertex_map[v];
      result.vertex_map = std::move(before);
    }
    if (k + 1 < ahead.size()) before = result.source_vertex;
    if (attributes && options.keep_history) result.changes = attributes->take_changes();
    result.changes.faces = std::move(outcome.changed_faces);
    if (criteria.watches_distance()) result.distance_bound = criteria.distance(mesh) / frame.scale;
    result.pruned_components = pruned.components;
    result.pruned_faces = pruned.faces;
    const DecimateStop why = result.stop;
    sink(std::move(result));
    if (!levels.empty() && !is_met(why, levels[k])) break;
    state.outcome = std::move(outcome);
    state.outcome.stop = DecimateStop::kTargetReached;
    state.outcome.blocked = {};
  }
  return {};
}

/// As decimate_through(), to the one target of the options.
template <class Point>
Result<BasicDecimated<Point>> decimate_until(Stop& stop, std::span<const Point> points,
                                             std::span<const std::uint32_t> corners,
                                             const DecimateOptions& options, const PartitionSizes& sizes) {
  BasicDecimated<Point> result;
  VKMESH_CHECK(decimate_through(stop, points, corners, options, sizes, {},
                                [&](BasicDecimated<Point>&& only) { result = std::move(only); }));
  return result;
}

/// `half_edges()`: those of the surface.
template <class Point, class HalfEdges>
Result<BasicDecimated<Point>> decimate_arrays(std::span<const Point> points,
                                              std::span<const std::uint32_t> corners,
                                              const DecimateOptions& given, const PartitionSizes& sizes,
                                              const Progress& progress, Stop::Now now,
                                              HalfEdges&& half_edges) {
  VKMESH_CHECK(check_options(given, points.size(), corners.size()));
  Stop stop(progress, now(), given.target.seconds.value_or(std::numeric_limits<double>::infinity()), now);
  const PackedAttributes packed(given);
  auto result = decimate_until(stop, points, corners, packed.options(), sizes);
  if (result || result.error().code != ErrorCode::kInterrupted || stop.is_cancelled()) return result;
  VKMESH_TRY(HalfEdgeMesh mesh, half_edges());
  VKMESH_CHECK(stop.check());
  return unchanged(std::move(mesh), points, packed.options());
}

template <class Point>
Result<BasicDecimated<Point>> decimate_mesh(const HalfEdgeMesh& mesh, std::span<const Point> positions,
                                            const DecimateOptions& options, const Progress& progress) {
  if (!mesh.is_triangles())
    return fail(ErrorCode::kUnsuitable, "decimation takes triangles only: triangulate first");
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "decimation needs one position for each vertex");
  return catching([&] {
    return decimate_arrays(positions, mesh.origins(), options, PartitionSizes{}, progress, &Stop::Clock::now,
                           [&]() -> Result<HalfEdgeMesh> { return mesh; });
  });
}

}  // namespace

std::string name_of(DecimateStop stop) {
  switch (stop) {
    case DecimateStop::kTargetReached:
      return "target reached";
    case DecimateStop::kErrorBound:
      return "error bound";
    case DecimateStop::kTimeLimit:
      return "time limit";
    case DecimateStop::kOutOfProportion:
      return "out of proportion";
    case DecimateStop::kNoLegalCollapse:
      break;
  }
  return "no legal collapse";
}

Result<Decimated> decimate(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                           const DecimateOptions& options, const Progress& progress) {
  return decimate_mesh(mesh, positions, options, progress);
}

Result<BasicDecimated<DVec3>> decimate(const HalfEdgeMesh& mesh, std::span<const DVec3> positions,
                                       const DecimateOptions& options, const Progress& progress) {
  return decimate_mesh(mesh, positions, options, progress);
}

Result<Decimated> decimate(const TriangleSurface& surface, const DecimateOptions& options,
                           const Progress& progress) {
  return decimate_in_partitions(surface, options, PartitionSizes{}, progress);
}

Result<Decimated> detail::decimate_in_partitions(const TriangleSurface& surface,
                                                 const DecimateOptions& options, const PartitionSizes& sizes,
                                                 const Progress& progress, Stop::Now now) {
  const auto half_edges = [&]() -> Result<HalfEdgeMesh> {
    VKMESH_TRY(Matching matching, match_edges(surface.points.size(), surface.corners, {}));
    if (!matching.defects.none()) return fail(ErrorCode::kUnsuitable, kNoManifold);
    return HalfEdgeMesh::from_arrays({surface.corners.begin(), surface.corners.end()},
                                     std::move(matching.twin), std::move(matching.leading));
  };
  return catching([&] {
    return decimate_arrays(surface.points, surface.corners, options, sizes, progress, now, half_edges);
  });
}

Result<std::vector<Decimated>> detail::decimate_levels(const TriangleSurface& surface,
                                                       const DecimateOptions& options,
                                                       std::span<const LevelTarget> levels,
                                                       const PartitionSizes& sizes,
                                                       const Progress& progress) {
  return catching([&]() -> Result<std::vector<Decimated>> {
    VKMESH_CHECK(check_options(options, surface.points.size(), surface.corners.size()));
    Stop stop(progress, Stop::Clock::now(),
              options.target.seconds.value_or(std::numeric_limits<double>::infinity()));
    const PackedAttributes packed(options);
    std::vector<Decimated> result;
    const auto done = decimate_through(stop, surface.points, surface.corners, packed.options(), sizes, levels,
                                       [&](Decimated&& level) { result.push_back(std::move(level)); });
    if (!done && (done.error().code != ErrorCode::kInterrupted || stop.is_cancelled()))
      return tl::unexpected<Error>(done.error());
    return result;
  });
}

}  // namespace vkmesh
