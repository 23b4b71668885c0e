#include "passes/pass_table.h"

#include <memory>
#include <utility>

#ifdef VKMESH_HAS_VULKAN
#include <vkmesh/engine/passes/bilateral_smoothing.h>
#include <vkmesh/engine/passes/collapse_costs.h>
#include <vkmesh/engine/passes/curvatures.h>
#include <vkmesh/engine/passes/dihedral_angles.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/restore_volume.h>
#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/engine/passes/swap_rounds.h>
#include <vkmesh/engine/passes/swap_scores.h>
#include <vkmesh/engine/passes/triangle_normals.h>
#include <vkmesh/engine/passes/vertex_normals.h>
#endif
#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/restore_volume.h>
#include <vkmesh/passes/surface_measures.h>
#include <vkmesh/passes/swap_rounds.h>
#include <vkmesh/passes/swap_scores.h>
#include <vkmesh/passes/triangle_normals.h>

namespace vkmesh::cli {
namespace {

using Points = std::vector<Vec3>;
using Floats = std::vector<float>;

/// compute(input, progress) as a pass on the host.
template <class Output, class Compute>
auto on_host(Compute compute) {
  return [compute](const PassInput& input, const Progress& progress, Output& output) -> Result<void> {
    VKMESH_TRY(output, compute(input, progress));
    return {};
  };
}

#ifdef VKMESH_HAS_VULKAN
/// A pass of one step, which records into Buffers: record(recorder, mesh, buffers), download(buffers).
template <class Output, class Buffers, class Record, class Download>
auto on_device(Record record, Download download) {
  return [=](Context&, DeviceMesh& mesh, const PassInput&) -> Result<DevicePass<Output>> {
    const auto buffers = std::make_shared<Buffers>();
    return DevicePass<Output>{1,
                              [=, &mesh](Recorder& recorder, std::uint32_t, std::uint32_t) {
                                return record(recorder, mesh, *buffers);
                              },
                              [=] { return download(*buffers); }};
  };
}
/// The same where the buffers are one array, the result.
template <class T, class Record>
auto on_device(Record record) {
  return on_device<std::vector<T>, DeviceArray<T>>(
      record, [](const DeviceArray<T>& result) { return result.download(); });
}
#endif

// Digests.

template <class T>
std::uint64_t fnv(std::span<const T> values, std::uint64_t hash = 0xcbf29ce484222325u) {
  for (const std::byte byte : std::as_bytes(values))
    hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
  return hash;
}

template <class T>
std::uint64_t digest_of(const std::vector<T>& values) {
  return fnv(std::span<const T>(values));
}

std::uint64_t digest_of(const SurfaceMeasures& measures) {
  return fnv(std::span(&measures, 1));
}

std::uint64_t digest_of(const DihedralAngles& angles) {
  return fnv(std::span<const float>(angles.vertex_maximum), digest_of(angles.half_edge));
}

/// Rows are told apart by nothing but their names: what their passes give is held by std::any.
template <class Output>
Pass<std::any> erased(Pass<Output> pass) {
  Pass<std::any> result;
  result.host = [host = std::move(pass.host)](const PassInput& input, const Progress& progress,
                                              std::any& output) {
    if (!output.has_value()) output.emplace<Output>();
    return host(input, progress, *std::any_cast<Output>(&output));
  };
#ifdef VKMESH_HAS_VULKAN
  result.device = [device = std::move(pass.device)](Context& context, DeviceMesh& mesh,
                                                    const PassInput& input) -> Result<DevicePass<std::any>> {
    VKMESH_TRY(DevicePass<Output> made, device(context, mesh, input));
    return DevicePass<std::any>{made.steps, std::move(made.record),
                                [download = std::move(made.download)]() -> Result<std::any> {
                                  VKMESH_TRY(Output output, download());
                                  return std::any(std::move(output));
                                }};
  };
#endif
  return result;
}

Pass<Points> triangle_normals_pass() {
  return {
      .host = [](const PassInput& in, const Progress&, Points& normals) -> Result<void> {
        normals.resize(in.mesh.face_count());
        return triangle_normals(in.mesh, in.positions, normals);
      },
#ifdef VKMESH_HAS_VULKAN
      .device = on_device<Vec3>(record_triangle_normals),
#endif
  };
}

Pass<SurfaceMeasures> surface_measures_pass() {
  return {
      .host = on_host<SurfaceMeasures>(
          [](const PassInput& in, const Progress&) { return surface_measures(in.mesh, in.positions); }),
#ifdef VKMESH_HAS_VULKAN
      .device = on_device<SurfaceMeasures, DeviceSurfaceMeasures>(
          record_surface_measures, [](const DeviceSurfaceMeasures& result) { return result.download(); }),
#endif
  };
}

Pass<Floats> collapse_costs_pass(const CollapseCostOptions& options) {
  return {
      .host = on_host<Floats>([options](const PassInput& in, const Progress&) -> Result<Floats> {
        VKMESH_TRY(const std::vector<VertexQuadric> planes, vertex_quadrics(in.mesh, in.positions, options));
        return collapse_costs(in.mesh, in.positions, planes, options);
      }),
#ifdef VKMESH_HAS_VULKAN
      .device = on_device<Floats, DeviceCollapseCosts>(
          [options](Recorder& recorder, DeviceMesh& mesh, DeviceCollapseCosts& result) {
            return record_collapse_costs(recorder, mesh, result, options);
          },
          [](const DeviceCollapseCosts& result) { return result.costs.download(); }),
#endif
  };
}

Pass<Floats> swap_scores_pass(SwapCriterion criterion) {
  return {
      .host = on_host<Floats>([criterion](const PassInput& in, const Progress&) {
        return swap_scores(in.mesh, in.positions, criterion);
      }),
#ifdef VKMESH_HAS_VULKAN
      .device =
          on_device<float>([criterion](Recorder& recorder, DeviceMesh& mesh, DeviceArray<float>& scores) {
            return record_swap_scores(recorder, mesh, scores, criterion);
          }),
#endif
  };
}

/// The corners after so many rounds.
Pass<std::vector<std::uint32_t>> swap_rounds_pass(std::uint32_t rounds) {
  using Corners = std::vector<std::uint32_t>;
  return {
      .host = on_host<Corners>([rounds](const PassInput& in, const Progress& progress) -> Result<Corners> {
        SwapRoundsOptions options;
        options.max_rounds = rounds;
        VKMESH_TRY(const SwapRounds swapped, swap_rounds(in.mesh, in.positions, options, progress));
        return Corners(swapped.mesh.origins().begin(), swapped.mesh.origins().end());
      }),
#ifdef VKMESH_HAS_VULKAN
      .device = on_device<Corners, DeviceSwapRounds>(
          [rounds](Recorder& recorder, DeviceMesh& mesh, DeviceSwapRounds& state) {
            state.rounds = 0;  // from the mesh's connectivity each time
            return record_swap_rounds(recorder, mesh, state, rounds, rounds);
          },
          [](const DeviceSwapRounds& state) { return state.corners.download(); }),
#endif
  };
}

/// A row whose pass is make(input).
template <class Make>
PassRow row(std::string name, std::string title, std::uint64_t (*bytes)(const PassBytes&), Make make,
            std::uint32_t steps = 1) {
  using Output = typename decltype(make(std::declval<const PassInput&>()))::Value;
  return {std::move(name),
          std::move(title),
          bytes,
          steps,
          [make](const PassInput& input) { return erased(make(input)); },
          [](const std::any& output) { return digest_of(*std::any_cast<Output>(&output)); }};
}

std::uint64_t vertex_normals_bytes(const PassBytes& b) {
  return b.points + b.corners + b.points;
}

PassRow vertex_normals_row(std::string name, std::string title, NormalWeights weights) {
  return row(std::move(name), std::move(title), vertex_normals_bytes,
             [weights](const PassInput&) { return vertex_normals_pass({weights}); });
}

PassRow collapse_costs_row(std::string name, std::string title, CollapsePlacement placement) {
  return row(
      std::move(name), std::move(title),
      [](const PassBytes& b) {
        return b.points + b.corners + b.twins + 24 * b.per_vertex + b.values_of_half_edges;
      },
      [placement](const PassInput& in) {
        CollapseCostOptions options = unit_frame(in.positions);
        options.placement = placement;
        return collapse_costs_pass(options);
      });
}

PassRow swap_scores_row(std::string name, std::string title, SwapCriterion criterion) {
  return row(
      std::move(name), std::move(title),
      [](const PassBytes& b) { return b.points + b.corners + b.twins + b.values_of_half_edges; },
      [criterion](const PassInput&) { return swap_scores_pass(criterion); });
}

/// Timed by ten steps in one go.
PassRow smoothing_row(std::string name, std::string title, const LaplacianSmoothingOptions& options) {
  return row(
      std::move(name), std::move(title),
      [](const PassBytes& b) { return b.points + b.neighbours + b.points; },
      [options](const PassInput&) { return laplacian_smoothing_pass(options, false); }, options.iterations);
}

/// With widths of so many mean edge lengths.
PassRow bilateral_row(std::string name, std::string title, double spatial, double influence) {
  return row(
      std::move(name), std::move(title), [](const PassBytes& b) { return b.points + b.corners + b.points; },
      [=](const PassInput& in) {
        const double length = mean_edge_length(in.mesh, in.positions);
        return bilateral_smoothing_pass({.spatial = static_cast<float>(spatial * length),
                                         .influence = static_cast<float>(influence * length)},
                                        false);
      });
}

}  // namespace

Result<const NodeNeighbours*> PassInput::neighbours() const {
  if (!neighbours_) {
    VKMESH_TRY(neighbours_, node_neighbours(mesh));
  }
  return &*neighbours_;
}

PassBytes::PassBytes(const HalfEdgeMesh& mesh)
    : per_vertex(mesh.vertex_count()),
      points(12 * per_vertex),
      corners(4 * std::uint64_t{mesh.half_edge_count()}),
      twins(corners),
      normals_of_faces(12 * std::uint64_t{mesh.face_count()}),
      values_of_half_edges(corners),
      // Each boundary half-edge stands for two directed edges.
      neighbours(4 * per_vertex + corners + 4 * std::uint64_t{mesh.boundary_half_edge_count()}) {}

Pass<Points> vertex_normals_pass(const VertexNormalsOptions& options) {
  return {
      .host = [options](const PassInput& in, const Progress&, Points& normals) -> Result<void> {
        normals.resize(in.mesh.vertex_count());
        return vertex_normals(in.mesh, in.positions, normals, options);
      },
#ifdef VKMESH_HAS_VULKAN
      .device = on_device<Points, DeviceVertexNormals>(
          [options](Recorder& recorder, DeviceMesh& mesh, DeviceVertexNormals& result) {
            return record_vertex_normals(recorder, mesh, result, options);
          },
          [](const DeviceVertexNormals& result) { return result.normals.download(); }),
#endif
  };
}

Pass<DihedralAngles> dihedral_angles_pass() {
  return {
      .host = on_host<DihedralAngles>(
          [](const PassInput& in, const Progress&) { return dihedral_angles(in.mesh, in.positions); }),
#ifdef VKMESH_HAS_VULKAN
      .device = on_device<DihedralAngles, DeviceDihedralAngles>(
          record_dihedral_angles,
          [](const DeviceDihedralAngles& result) -> Result<DihedralAngles> {
            DihedralAngles angles;
            VKMESH_TRY(angles.half_edge, result.half_edge.download());
            VKMESH_TRY(angles.vertex_maximum, result.vertex_maximum.download());
            return angles;
          }),
#endif
  };
}

Pass<std::vector<VertexCurvature>> curvatures_pass() {
  using Curvatures = std::vector<VertexCurvature>;
  return {
      .host = on_host<Curvatures>([](const PassInput& in, const Progress&) -> Result<Curvatures> {
        VKMESH_TRY(const NodeNeighbours* neighbours, in.neighbours());
        return curvatures(*neighbours, in.positions);
      }),
#ifdef VKMESH_HAS_VULKAN
      .device = on_device<VertexCurvature>(record_curvatures),
#endif
  };
}

Pass<Points> laplacian_smoothing_pass(const LaplacianSmoothingOptions& options, bool keep_volume) {
  return {
      .host = on_host<Points>([=](const PassInput& in, const Progress& progress) -> Result<Points> {
        VKMESH_TRY(const NodeNeighbours* neighbours, in.neighbours());
        VKMESH_TRY(Points smoothed, laplacian_smoothing(*neighbours, in.positions, options, progress));
        if (keep_volume) return restore_volume(in.mesh, in.positions, smoothed);
        return smoothed;
      }),
#ifdef VKMESH_HAS_VULKAN
      .device = [=](Context&, DeviceMesh& mesh, const PassInput&) -> Result<DevicePass<Points>> {
        struct Buffers {
          DeviceSmoothing smoothing;
          DeviceSurfaceMeasures before, after;
        };
        const auto buffers = std::make_shared<Buffers>();
        const auto record = [=, &mesh](Recorder& recorder, std::uint32_t first,
                                       std::uint32_t end) -> Result<void> {
          if (keep_volume && first == 0)
            VKMESH_CHECK(record_surface_measures(recorder, mesh, buffers->before));
          LaplacianSmoothingOptions portion = options;
          portion.iterations = end - first;
          VKMESH_CHECK(record_laplacian_smoothing(recorder, mesh, buffers->smoothing, portion));
          if (!keep_volume || end < options.iterations) return {};
          return record_restore_volume(recorder, mesh, buffers->before, buffers->after);
        };
        return DevicePass<Points>{options.iterations, record,
                                  [&mesh] { return mesh.positions().download(); }};
      },
#endif
  };
}

Pass<Points> bilateral_smoothing_pass(const BilateralSmoothingOptions& options, bool keep_volume) {
  return {
      .host = on_host<Points>([=](const PassInput& in, const Progress& progress) -> Result<Points> {
        VKMESH_TRY(Points smoothed, bilateral_smoothing(in.mesh, in.positions, options, progress));
        if (keep_volume) return restore_volume(in.mesh, in.positions, smoothed);
        return smoothed;
      }),
#ifdef VKMESH_HAS_VULKAN
      .device = [=](Context& context, DeviceMesh& mesh, const PassInput& in) -> Result<DevicePass<Points>> {
        struct Buffers {
          NearbyFaces nearby;
          DeviceSurfaceMeasures before, after;
        };
        const auto buffers = std::make_shared<Buffers>();
        VKMESH_TRY(buffers->nearby, NearbyFaces::create(context, in.mesh, in.positions, options));
        const auto record = [=, &mesh](Recorder& recorder, std::uint32_t, std::uint32_t) -> Result<void> {
          if (keep_volume) VKMESH_CHECK(record_surface_measures(recorder, mesh, buffers->before));
          VKMESH_CHECK(record_bilateral_smoothing(recorder, mesh, buffers->nearby));
          if (!keep_volume) return {};
          return record_restore_volume(recorder, mesh, buffers->before, buffers->after);
        };
        return DevicePass<Points>{1, record, [&mesh] { return mesh.positions().download(); }};
      },
#endif
  };
}

const std::vector<PassRow>& pass_table() {
  static const std::vector<PassRow> kTable = {
      vertex_normals_row("vertex-normals", "vertex normals", NormalWeights::kArea),
      vertex_normals_row("vertex-normals-by-angle", "vertex normals by angle", NormalWeights::kAngle),
      vertex_normals_row("vertex-normals-uniform", "", NormalWeights::kUniform),
      row(
          "triangle-normals", "triangle normals",
          [](const PassBytes& b) { return b.points + b.corners + b.normals_of_faces; },
          [](const PassInput&) { return triangle_normals_pass(); }),
      row(
          "dihedral-angles", "dihedral angles",
          [](const PassBytes& b) {
            return b.points + b.corners + b.twins + b.values_of_half_edges + 4 * b.per_vertex;
          },
          [](const PassInput&) { return dihedral_angles_pass(); }),
      row(
          "curvatures", "curvatures",
          [](const PassBytes& b) { return b.points + b.neighbours + 16 * b.per_vertex; },
          [](const PassInput&) { return curvatures_pass(); }),
      row(
          "surface-measures", "area and volume", [](const PassBytes& b) { return b.points + b.corners; },
          [](const PassInput&) { return surface_measures_pass(); }),
      collapse_costs_row("collapse-costs", "quadrics and collapse costs", CollapsePlacement::kOptimal),
      collapse_costs_row("collapse-costs-end", "", CollapsePlacement::kEndpoint),
      swap_scores_row("swap-scores", "swap scores", SwapCriterion::kMinAngle),
      swap_scores_row("swap-scores-by-quality", "", SwapCriterion::kAspectRatio),
      row("swap-rounds", "", {}, [](const PassInput&) { return swap_rounds_pass(8); }),
      smoothing_row("laplacian-smoothing", "Laplacian step", {.iterations = 10}),
      smoothing_row("taubin-smoothing", "", {.mu = -0.53f}),
      smoothing_row("cotangent-smoothing", "cotangent step",
                    {.iterations = 10, .weights = SmoothingWeights::kCotangent}),
      smoothing_row("cotangent-taubin-along-boundary", "",
                    {.boundary = SmoothingBoundary::kAlongItself,
                     .weights = SmoothingWeights::kCotangent,
                     .mu = -0.53f}),
      row("laplacian-smoothing-keeping-volume", "", {},
          [](const PassInput& in) {
            return laplacian_smoothing_pass({.iterations = 3}, in.mesh.boundary_half_edge_count() == 0);
          }),
      bilateral_row("bilateral-smoothing", "", 1.0, 0.3),
      bilateral_row("", "bilateral smoothing", 4.0, 1.0),
  };
  return kTable;
}

}  // namespace vkmesh::cli
