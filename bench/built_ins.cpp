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
#include "built_in_shaders.h"
#include "core/device.h"

namespace vkmesh::bench {
namespace {

Result<void> use_built_ins(Context& context) {
  for (const KernelSource& source : built_in_shaders::kernels())
    VKMESH_CHECK(context.device().replace_kernel(source));
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
