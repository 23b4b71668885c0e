// What exactness costs: passes with the engine's kernels, and with the same kernels compiled with built-ins.
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/engine/passes/bilateral_smoothing.h>
#include <vkmesh/engine/passes/collapse_costs.h>
#include <vkmesh/engine/passes/curvatures.h>
#include <vkmesh/engine/passes/dihedral_angles.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/swap_scores.h>
#include <vkmesh/engine/passes/triangle_normals.h>
#include <vkmesh/engine/passes/vertex_normals.h>
#include <vkmesh/repair/consolidate.h>

#include "bench/contestants.h"
#include "core/device.h"
#include "passes/params.h"

namespace vkmesh::bench {
namespace {

using std::uint32_t;
#include "shaders/bilateral_faces.spv.h"
#include "shaders/bilateral_mollify.spv.h"
#include "shaders/bilateral_move.spv.h"
#include "shaders/bilateral_normals.spv.h"
#include "shaders/collapse_costs.spv.h"
#include "shaders/cotangent_smoothing.spv.h"
#include "shaders/curvatures.spv.h"
#include "shaders/dihedral_angles.spv.h"
#include "shaders/laplacian_smoothing.spv.h"
#include "shaders/quadrics.spv.h"
#include "shaders/swap_scores.spv.h"
#include "shaders/triangle_areas.spv.h"
#include "shaders/triangle_normals.spv.h"
#include "shaders/vertex_normals.spv.h"
#include "shaders/vertex_normals_by_angle.spv.h"

Result<void> use_built_ins(Context& context) {
  const KernelSource sources[] = {
      {"bilateral_faces", k_bilateral_faces_spirv, sizeof(kernels::BilateralFacesParams)},
      {"bilateral_mollify", k_bilateral_mollify_spirv, sizeof(kernels::BilateralSumParams)},
      {"bilateral_move", k_bilateral_move_spirv, sizeof(kernels::BilateralSumParams)},
      {"bilateral_normals", k_bilateral_normals_spirv, sizeof(kernels::BilateralNormalsParams)},
      {"collapse_costs", k_collapse_costs_spirv, sizeof(kernels::CollapseCostsParams)},
      {"cotangent_smoothing", k_cotangent_smoothing_spirv, sizeof(kernels::LaplacianSmoothingParams)},
      {"curvatures", k_curvatures_spirv, sizeof(kernels::CurvaturesParams)},
      {"dihedral_angles", k_dihedral_angles_spirv, sizeof(kernels::DihedralAnglesParams)},
      {"laplacian_smoothing", k_laplacian_smoothing_spirv, sizeof(kernels::LaplacianSmoothingParams)},
      {"quadrics", k_quadrics_spirv, sizeof(kernels::QuadricsParams)},
      {"swap_scores", k_swap_scores_spirv, sizeof(kernels::SwapScoresParams)},
      {"triangle_areas", k_triangle_areas_spirv, sizeof(kernels::TrianglesParams)},
      {"triangle_normals", k_triangle_normals_spirv, sizeof(kernels::TrianglesParams)},
      {"vertex_normals", k_vertex_normals_spirv, sizeof(kernels::VertexNormalsParams)},
      {"vertex_normals_by_angle", k_vertex_normals_by_angle_spirv,
       sizeof(kernels::VertexNormalsByAngleParams)},
  };
  for (const KernelSource& source : sources) VKMESH_CHECK(context.device().replace_kernel(source));
  return {};
}

/// A device with one of the two sets of kernels, and the mesh on it.
struct Place {
  std::unique_ptr<Context> context;
  DeviceMesh mesh;
  NearbyFaces nearby;
};

using Record = std::function<Result<void>(Recorder&, Place&)>;

Result<double> time_of(Place& place, const Input& input, const Record& record) {
  VKMESH_CHECK(place.mesh.upload_positions(input.mesh.points));
  VKMESH_TRY(Recorder recorder, Recorder::create(*place.context));
  VKMESH_CHECK(record(recorder, place));
  const Stopwatch watch;
  VKMESH_CHECK(recorder.submit_and_wait());
  return watch.milliseconds();
}

Result<std::shared_ptr<Place>> make_place(const Input& input, const HalfEdgeMesh& half_edges,
                                          const std::string& device, bool built_ins) {
  const auto place = std::make_shared<Place>();
  ContextOptions options;
  options.device = device;
  VKMESH_TRY(place->context, Context::create(options));
  if (built_ins) VKMESH_CHECK(use_built_ins(*place->context));
  const MeshPasses passes{.vertex_normals = true,
                          .laplacian_smoothing = true,
                          .dihedral_angles = true,
                          .triangle_normals = true,
                          .curvatures = true,
                          .bilateral_smoothing = true,
                          .collapse_costs = true,
                          .swap_scores = true};
  VKMESH_TRY(place->mesh, DeviceMesh::create(*place->context, half_edges, input.mesh.points, passes));
  const auto width = static_cast<float>(2.0 * mean_edge_length(half_edges, input.mesh.points));
  VKMESH_TRY(place->nearby,
             NearbyFaces::create(*place->context, half_edges, input.mesh.points, {width, width}));
  return place;
}

}  // namespace

Result<void> add_built_ins(Programme& programme, const Input& input, const std::string& device) {
  VKMESH_TRY(const HalfEdgeMesh half_edges, to_half_edge_mesh(input.mesh));
  VKMESH_TRY(const auto exact, make_place(input, half_edges, device, false));
  VKMESH_TRY(const auto built_ins, make_place(input, half_edges, device, true));
  const CollapseCostOptions frame = unit_frame(input.mesh.points);
  const auto add = [&](const std::string& pass, const Record& record) {
    for (const auto& [name, place] : {std::pair{"exact, " + device, exact}, {kBuiltIns, built_ins}})
      programme.contestants.push_back({pass + " against built-ins", name,
                                       [&input, place, record] { return time_of(*place, input, record); }});
  };
  const auto steps = [](SmoothingWeights weights) {
    return [weights](Recorder& recorder, Place& place) {
      LaplacianSmoothingOptions options;
      options.iterations = kSmoothingSteps;
      options.weights = weights;
      return record_laplacian_smoothing(recorder, place.mesh, options);
    };
  };
  const auto normals = [](NormalWeights weights) {
    return [weights](Recorder& recorder, Place& place) {
      return record_vertex_normals(recorder, place.mesh, {weights});
    };
  };
  add("triangle normals", [](Recorder& r, Place& p) { return record_triangle_normals(r, p.mesh); });
  add("vertex normals", normals(NormalWeights::kArea));
  add("vertex normals by angle", normals(NormalWeights::kAngle));
  add("dihedral angles", [](Recorder& r, Place& p) { return record_dihedral_angles(r, p.mesh); });
  add("curvatures", [](Recorder& r, Place& p) { return record_curvatures(r, p.mesh); });
  add("ten smoothing steps", steps(SmoothingWeights::kUniform));
  add("ten cotangent steps", steps(SmoothingWeights::kCotangent));
  add("bilateral smoothing",
      [](Recorder& r, Place& p) { return record_bilateral_smoothing(r, p.mesh, p.nearby); });
  add("collapse costs", [frame](Recorder& r, Place& p) { return record_collapse_costs(r, p.mesh, frame); });
  add("swap scores", [](Recorder& r, Place& p) { return record_swap_scores(r, p.mesh); });
  return {};
}

}  // namespace vkmesh::bench
