#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/decimation/decimate.h>

#include "base/parallel.h"
#include "base/prefetch.h"
#include "decimation/cost/attribute_quadrics.h"
#include "decimation/decimation_state.h"
#include "decimation/gather_result.h"
#include "decimation/legality/criteria.h"
#include "decimation/legality/wedges.h"
#include "decimation/order/collapse_order.h"
#include "decimation/runs.h"
#include "decimation/setup/frame.h"
#include "decimation/setup/initial_quadrics.h"
#include "decimation/setup/prune.h"
#include "mesh/edit/collapse_mesh.h"
#include "spatial/morton_order.h"

namespace vkmesh {
namespace {

using namespace detail;

Result<Outcome> run(DecimationState& state, const DecimateOptions& options, CollapseOrder order,
                    const Progress& progress) {
  const bool exact = order == CollapseOrder::kExact;
  if (options.operation == DecimateOperation::kVertexRemoval)
    return (state.attributes != nullptr ? run_vertex_removals<true>
                                        : run_vertex_removals<false>)(state, exact, progress);
  return (state.attributes != nullptr ? run_edge_collapses<true>
                                      : run_edge_collapses<false>)(state, options, exact, progress);
}

Result<void> check_attributes(const DecimateOptions& options, std::size_t vertices, std::size_t corners) {
  const auto usage = [](const char* what) { return fail(ErrorCode::kUsage, what); };
  if (!(options.seam_weight >= 0 && std::isfinite(options.seam_weight)))
    return usage("seam_weight must be at least 0 and finite");
  if (!options.corner_groups.empty() && options.corner_groups.size() != corners)
    return usage("corner_groups needs a number for each corner of the mesh");
  for (const DecimateAttribute& a : options.attributes) {
    if (!(a.weight >= 0 && std::isfinite(a.weight)))
      return usage("the weight of an attribute must be at least 0 and finite");
    if (a.components == 0 || (a.kind == AttributeKind::kNormal && a.components != 3))
      return usage("an attribute needs at least one component, and normals three");
    const std::size_t values = a.values.size() / a.components;
    if (a.values.size() % a.components != 0 || (a.corners.empty() && values != vertices))
      return usage("an attribute needs one value for each vertex, or the value of each corner");
    if (!a.corners.empty() && a.corners.size() != corners)
      return usage("an attribute needs a value for each corner of the mesh");
    for (const std::uint32_t value : a.corners)
      if (value >= values) return usage("a corner names no value of an attribute");
    for (const float x : a.values)
      if (!std::isfinite(x)) return fail(ErrorCode::kUnsuitable, "decimation needs finite attributes");
  }
  return {};
}

Result<void> check(const DecimateCriteria& criteria) {
  const auto usage = [](const char* what) { return fail(ErrorCode::kUsage, what); };
  for (const double weight :
       {criteria.quadric_weight, criteria.density_weight, criteria.aspect_weight, criteria.normal_weight})
    if (!(weight >= 0 && std::isfinite(weight)))
      return usage("the weight of a criterion must be at least 0 and finite");
  if (!(criteria.quadric_weight > 0 || criteria.density_weight > 0 || criteria.aspect_weight > 0 ||
        criteria.normal_weight > 0))
    return usage("some criterion needs a weight above 0");
  for (const auto& distance : {criteria.max_distance, criteria.max_relative_distance})
    if (distance && !(*distance >= 0)) return usage("max_distance must be at least 0");
  if (const auto angle = criteria.max_original_normal_deviation;
      angle && !(*angle > 0 && *angle < std::numbers::pi))
    return usage("max_original_normal_deviation must lie between 0 and pi");
  if (criteria.max_aspect_ratio && !(*criteria.max_aspect_ratio >= 1))
    return usage("max_aspect_ratio must be at least 1");
  if (criteria.max_edge_length && !(*criteria.max_edge_length > 0))
    return usage("max_edge_length must be above 0");
  if (criteria.max_valence && *criteria.max_valence < 3) return usage("max_valence must be at least 3");
  return {};
}

Result<void> check(const DecimateOptions& options, std::size_t vertices, std::size_t corners) {
  const auto usage = [](const char* what) { return fail(ErrorCode::kUsage, what); };
  if (options.max_error && !(*options.max_error >= 0)) return usage("max_error must be at least 0");
  if (options.max_relative_error && !(*options.max_relative_error >= 0))
    return usage("max_relative_error must be at least 0");
  if (options.target_ratio && !(*options.target_ratio >= 0 && *options.target_ratio <= 1))
    return usage("target_ratio must lie between 0 and 1");
  if (options.time_limit && !(*options.time_limit >= 0)) return usage("time_limit must be at least 0");
  if (!(options.max_normal_deviation > 0 && options.max_normal_deviation < std::numbers::pi))
    return usage("max_normal_deviation must lie between 0 and pi");
  if (!(options.boundary_weight >= 0 && std::isfinite(options.boundary_weight)))
    return usage("boundary_weight must be at least 0 and finite");
  if (!(options.crease_weight >= 0 && std::isfinite(options.crease_weight)))
    return usage("crease_weight must be at least 0 and finite");
  if (options.crease_angle && !(*options.crease_angle > 0 && *options.crease_angle <= std::numbers::pi))
    return usage("crease_angle must lie between 0 and pi");
  VKMESH_CHECK(check(options.criteria));
  for (const std::uint32_t v : options.locked_vertices)
    if (v >= vertices) return usage("a locked vertex is not of the mesh");
  for (const std::uint32_t h : options.locked_edges)
    if (h >= corners) return usage("a locked edge is not of the mesh");
  for (const std::uint32_t f : options.locked_faces)
    if (f >= corners / 3) return usage("a locked face is not of the mesh");
  for (const auto& size : {options.prune_size, options.prune_relative_size})
    if (size && !(*size >= 0)) return usage("prune_size must be at least 0");
  return check_attributes(options, vertices, corners);
}

/// Whether two corners at one vertex are of one group and have the same values of all attributes.
bool same_values(const DecimateOptions& options, std::uint32_t c, std::uint32_t d) {
  const auto& groups = options.corner_groups;
  if (!groups.empty() && groups[c] != groups[d]) return false;
  return std::all_of(options.attributes.begin(), options.attributes.end(), [&](const DecimateAttribute& a) {
    if (a.corners.empty() || a.corners[c] == a.corners[d]) return true;
    const auto value = [&](std::uint32_t corner) {
      return a.values.subspan(std::size_t{a.corners[corner]} * a.components, a.components);
    };
    const auto one = value(c), other = value(d);
    return std::equal(one.begin(), one.end(), other.begin());
  });
}

/// Edges and faces stay when their vertices do.
void lock(CollapseMesh& mesh, std::span<const std::uint32_t> corners, const DecimateOptions& options) {
  if (options.locked_vertices.empty() && options.locked_edges.empty() && options.locked_faces.empty()) return;
  std::vector<bool> locked(mesh.apex(), false);
  for (const std::uint32_t v : options.locked_vertices) locked[v] = true;
  for (const std::uint32_t h : options.locked_edges)
    for (const std::uint32_t c : {h, h % 3 == 2 ? h - 2 : h + 1}) locked[corners[c]] = true;
  for (const std::uint32_t f : options.locked_faces)
    for (std::size_t i = 0; i < 3; ++i) locked[corners[3 * f + i]] = true;
  for (std::uint32_t v = 0; v < mesh.apex(); ++v)
    if (locked[mesh.vertices[v].source]) mesh.vertices[v].source |= VertexRecord::kLocked;
}

/// Builds a mesh whose vertices, and faces by their first vertex, go along Morton's curve; `order` tells
/// their numbers in the input.
template <class Position>
CollapseMesh::Built build_along_curve(CollapseMesh& mesh, std::size_t vertex_count,
                                      std::span<const std::uint32_t> corners, Position&& position,
                                      std::vector<std::uint32_t>& order,
                                      std::vector<std::uint32_t>& leading) {
  order = morton_order(vertex_count, position);
  const std::size_t faces = corners.size() / 3;
  std::vector<std::uint32_t> rank(vertex_count), first(faces), face_order(faces);
  for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  const auto ranks_of = [&](std::size_t f) -> std::array<std::uint32_t, 3> {
    return {rank[corners[3 * f]], rank[corners[3 * f + 1]], rank[corners[3 * f + 2]]};
  };
  parallel_ranges(faces, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) first[f] = std::ranges::min(ranks_of(f));
  });
  counting_sort(
      vertex_count, faces, [&](std::size_t f) { return first[f]; },
      [&](std::size_t slot, std::size_t f) { face_order[slot] = static_cast<std::uint32_t>(f); });
  first = std::vector<std::uint32_t>();
  const auto face_of = [&](std::size_t f) {
    return CollapseMesh::Face{ranks_of(face_order[f]), 0, {}, face_order[f]};
  };
  return mesh.build(vertex_count, faces, face_of, leading);
}

/// Of some vertices.
double mean_weight_of(const CollapseMesh& mesh) {
  constexpr std::size_t kMost = 4096;
  const std::size_t all = mesh.apex(), some = std::min(all, kMost);
  double sum = 0;
  for (std::uint32_t i = 0; i < some; ++i) {
    sum += static_cast<double>(mesh.vertices[some == all ? i : spread_evenly(i, all)].weight);
  }
  return some > 0 ? sum / static_cast<double>(some) : 0;
}

template <class Point>
Result<BasicDecimated<Point>> decimate_arrays(std::span<const Point> points,
                                              std::span<const std::uint32_t> corners,
                                              const DecimateOptions& options, CollapseOrder order,
                                              const Progress& progress) {
  constexpr std::size_t kGrain = 1 << 14;
  const auto begun = std::chrono::steady_clock::now();
  VKMESH_CHECK(check(options, points.size(), corners.size()));
  if (corners.size() % 3 != 0) return fail(ErrorCode::kUsage, "decimation takes three corners a face");
  if (corners.size() / 3 > CollapseMesh::kMaxFaces || points.size() > CollapseMesh::kMaxVertices)
    return fail(ErrorCode::kUnsuitable,
                "decimation takes at most 2^28 vertices, 2^29 faces and boundary edges");
  CollapseMesh mesh;
  Frame frame;
  std::vector<std::uint32_t> vertex_order, leading;
  const auto local = [&](std::size_t v) {
    std::array<float, 3> x;
    for (int k = 0; k < 3; ++k)
      x[static_cast<std::size_t>(k)] =
          static_cast<float>((static_cast<double>(points[v][k]) - frame.centre[k]) * frame.scale);
    return x;
  };
  auto built = CollapseMesh::Built::kNoSuchVertex;
  if (!lacks_locality(points.size(), corners)) {
    const auto face_of = [&](std::size_t f) {
      return CollapseMesh::Face{
          {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]}, 0, {}, static_cast<std::uint32_t>(f)};
    };
    built = mesh.build(points.size(), corners.size() / 3, face_of, leading);
    if (built == CollapseMesh::Built::kDone) {
      VKMESH_TRY(frame, frame_of(points, [&](std::size_t v) { return leading[v] != kInvalid; }));
    }
  } else if (std::ranges::all_of(corners, [&](std::uint32_t c) { return c < points.size(); })) {
    {
      std::vector<std::uint8_t> in_use(points.size(), 0);
      for (const std::uint32_t c : corners) in_use[c] = 1;
      VKMESH_TRY(frame, frame_of(points, [&](std::size_t v) { return in_use[v] != 0; }));
    }
    built = build_along_curve(mesh, points.size(), corners, local, vertex_order, leading);
  }
  if (built == CollapseMesh::Built::kNoSuchVertex) return fail(ErrorCode::kUsage, "a corner names no point");
  if (built == CollapseMesh::Built::kNoManifold)
    return fail(ErrorCode::kUnsuitable, "decimation takes oriented manifolds only: consolidate first");

  const auto used = parallel_sum<std::size_t>(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t v = begin; v < end; ++v) {
      VertexRecord& vertex = mesh.vertices[v];
      prefetch_stream(&vertex);
      const std::uint32_t source = vertex_order.empty() ? static_cast<std::uint32_t>(v) : vertex_order[v];
      vertex = {};
      vertex.position = local(source);
      vertex.leading = leading[v];
      vertex.source = source;
      count += leading[v] != kInvalid ? 1 : 0;
    }
    return count;
  });
  leading = std::vector<std::uint32_t>();
  mesh.vertices[mesh.apex()] = {};
  mesh.vertices[mesh.apex()].position.fill(std::numeric_limits<float>::quiet_NaN());  // it lies nowhere
  mesh.vertices[mesh.apex()].source = VertexRecord::kLocked;  // which tells rings at the boundary
  lock(mesh, corners, options);
  if (options.boundary == DecimateBoundary::kKept)
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (std::uint32_t i = 0; i < 3; ++i)
        if (mesh.is_ghost(mesh.twin(4 * f + i)))
          mesh.vertices[mesh.origin(4 * f + i)].source |= VertexRecord::kLocked;
  const bool in_order = vertex_order.empty();
  vertex_order = std::vector<std::uint32_t>();
  detail::ConstraintWeights weights;
  if (options.boundary == DecimateBoundary::kInShape)
    weights.boundary = static_cast<float>(options.boundary_weight);
  if (options.crease_angle) {
    weights.crease = static_cast<float>(options.crease_weight);
    weights.crease_cosine = static_cast<float>(std::cos(*options.crease_angle));
  }
  std::optional<Wedges> wedges;
  if (!options.attributes.empty() || !options.corner_groups.empty()) {
    wedges.emplace(mesh, points.size(),
                   [&](std::uint32_t c, std::uint32_t d) { return same_values(options, c, d); });
    weights.seam = static_cast<float>(options.seam_weight);
    weights.wedges = &*wedges;
  }
  sum_quadrics(mesh, weights);
  std::optional<AttributeQuadrics> attributes;
  const double local_diagonal = frame.diagonal * frame.scale;
  if (wedges)
    attributes.emplace(mesh, points.size(), std::move(*wedges), options.attributes, corners, local_diagonal,
                       options.operation == DecimateOperation::kVertexRemoval);

  Pruned pruned;
  if (options.prune_size || options.prune_relative_size)
    pruned = prune_components(
        mesh,
        static_cast<float>(frame.scale * std::max(options.prune_size.value_or(0),
                                                  options.prune_relative_size.value_or(0) * frame.diagonal)));

  Limits limits;
  limits.faces = options.target_faces.value_or(0);
  if (options.target_ratio)
    limits.faces = std::max(
        limits.faces, static_cast<std::size_t>(
                          std::llround(*options.target_ratio * static_cast<double>(mesh.face_count()))));
  limits.vertices = options.target_vertices.value_or(0);
  double bound = std::numeric_limits<double>::infinity();
  if (options.max_error) bound = *options.max_error * frame.scale;
  if (options.max_relative_error) bound = std::min(bound, *options.max_relative_error * local_diagonal);
  limits.error2 = bound * bound;
  limits.cos_deviation = static_cast<float>(std::cos(options.max_normal_deviation));
  if (options.time_limit)
    limits.seconds =
        *options.time_limit - std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  Criteria criteria(options.criteria, frame, mesh);
  DecimationState state{mesh,
                        limits,
                        mesh.face_count() - pruned.faces,
                        used - pruned.vertices,
                        options.keep_history,
                        {},
                        attributes ? &*attributes : nullptr,
                        criteria.ranks() || criteria.bounds() ? &criteria : nullptr,
                        options.boundary == DecimateBoundary::kKept};
  state.mean_weight = mean_weight_of(mesh);
  if (order == CollapseOrder::kPartitioned) {
    state.partition_faces = 32;
    state.range_faces = 512;
  }
  if (attributes && options.keep_history) attributes->keep_changes();
  VKMESH_TRY(Outcome outcome, run(state, options, order, progress));
  BasicDecimated<Point> result = gather(mesh, points, in_order, frame, outcome, state.attributes);
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
  return detail::catching([&]() -> Result<BasicDecimated<Point>> {
    return decimate_arrays(positions, mesh.origins(), options, CollapseOrder::kFast, progress);
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
  return detail::decimate(surface, options, CollapseOrder::kFast, progress);
}

Result<Decimated> detail::decimate(const TriangleSurface& surface, const DecimateOptions& options,
                                   CollapseOrder order, const Progress& progress) {
  return detail::catching([&]() -> Result<Decimated> {
    return decimate_arrays(surface.points, surface.corners, options, order, progress);
  });
}

}  // namespace vkmesh
