// The stages of a decimation: check, prepare, coarsen, collapse or remove, gather. `reference.cpp` says what
// all of it comes to.
#include <chrono>
#include <limits>
#include <optional>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/decimation/decimate.h>

#include "decimation/cost/attribute_quadrics.h"
#include "decimation/decimation_state.h"
#include "decimation/gather_result.h"
#include "decimation/legality/criteria.h"
#include "decimation/parallel/coarsen.h"
#include "decimation/removals.h"
#include "decimation/setup/build_mesh.h"
#include "decimation/setup/check_options.h"
#include "decimation/setup/initial_quadrics.h"
#include "decimation/setup/packed_attributes.h"
#include "decimation/setup/prepare.h"
#include "decimation/setup/prune.h"

namespace vkmesh {
namespace {

using namespace detail;

template <class Point>
Result<BasicDecimated<Point>> decimate_arrays(std::span<const Point> points,
                                              std::span<const std::uint32_t> corners,
                                              const DecimateOptions& given, const PartitionSizes& sizes,
                                              const Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  VKMESH_CHECK(check_options(given, points.size(), corners.size()));
  const PackedAttributes packed(given);
  const DecimateOptions& options = packed.options();

  // Prepare
  Stop stop(progress, begun, options.target.seconds.value_or(std::numeric_limits<double>::infinity()));
  VKMESH_TRY(BuiltMesh built, build_mesh(points, corners));
  VKMESH_CHECK(stop.check());
  CollapseMesh& mesh = built.mesh;
  const Frame& frame = built.frame;
  lock_vertices(mesh, corners, options);
  std::optional<Wedges> wedges = find_wedges(mesh, points.size(), options);
  if (!stop.is_set() || wedges) sum_quadrics(mesh, constraint_weights(options.curves, wedges));
  VKMESH_CHECK(stop.check());
  std::optional<AttributeQuadrics> attributes;
  if (wedges)
    attributes.emplace(mesh, points.size(), std::move(*wedges), options.attributes, corners,
                       frame.diagonal * frame.scale, options.operation == DecimateOperation::kVertexRemoval);
  if (attributes && options.keep_history) attributes->keep_changes();
  Pruned pruned;
  if (options.prune_size)
    pruned = prune_components(mesh,
                              static_cast<float>(frame.scale * options.prune_size->in_units(frame.diagonal)));
  Criteria criteria(options.weights, options.bounds, frame, mesh);
  Limits limits = limits_of(options, mesh.face_count(), frame);
  const std::size_t faces = mesh.face_count() - pruned.faces,
                    vertices = built.used_vertices - pruned.vertices;
  keep_in_proportion(limits, mesh, options, faces, vertices);
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
  VKMESH_CHECK(stop.check());

  // Coarsen; collapse or remove
  if (!stop.is_set()) coarsen_if_far_from_target(state);
  const auto remove = attributes ? remove_cheapest<true> : remove_cheapest<false>;
  VKMESH_TRY(Outcome outcome, remove(state, options.operation));

  // Gather
  BasicDecimated<Point> result = gather(mesh, points, built.is_in_order, frame, outcome, state.attributes);
  if (attributes) result.changes = attributes->take_changes();
  result.changes.faces = std::move(outcome.changed_faces);
  if (criteria.watches_distance()) result.distance_bound = criteria.distance(mesh) / frame.scale;
  result.pruned_components = pruned.components;
  result.pruned_faces = pruned.faces;
  return result;
}

template <class Point>
Result<BasicDecimated<Point>> decimate_mesh(const HalfEdgeMesh& mesh, std::span<const Point> positions,
                                            const DecimateOptions& options, const Progress& progress) {
  if (!mesh.is_triangles())
    return fail(ErrorCode::kUnsuitable, "decimation takes triangles only: triangulate first");
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "decimation needs one position for each vertex");
  return catching(
      [&] { return decimate_arrays(positions, mesh.origins(), options, PartitionSizes{}, progress); });
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
                                                 const Progress& progress) {
  return catching([&] { return decimate_arrays(surface.points, surface.corners, options, sizes, progress); });
}

}  // namespace vkmesh
