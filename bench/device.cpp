// vkmesh on a Vulkan device.
#include <memory>
#include <utility>

#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/vertex_normals.h>
#include <vkmesh/repair/consolidate.h>

#include "bench/contestants.h"

namespace vkmesh::bench {
namespace {

/// Recording, submission and execution.
template <class Record>
Result<double> timed(Context& context, Record&& record) {
  const Stopwatch watch;
  VKMESH_TRY(Recorder recorder, Recorder::create(context));
  VKMESH_CHECK(record(recorder));
  VKMESH_CHECK(recorder.submit_and_wait());
  return watch.milliseconds();
}

}  // namespace

Result<void> add_device(Programme& programme, const Input& input, const std::string& device) {
  ContextOptions options;
  options.device = device;
  VKMESH_TRY(const std::shared_ptr<Context> context, Context::create(options));
  const DeviceInfo& info = context->info();
  programme.libraries.push_back({info.name, info.driver});
  const std::string name = "vkmesh, " + device;

  VKMESH_TRY(HalfEdgeMesh half_edges, to_half_edge_mesh(input.mesh));
  const auto connectivity = std::make_shared<HalfEdgeMesh>(std::move(half_edges));
  const MeshPasses passes{.vertex_normals = true, .laplacian_smoothing = true};
  VKMESH_TRY(DeviceMesh uploaded, DeviceMesh::create(*context, *connectivity, input.mesh.points, passes));
  // Named after the context in each capture, so that it goes before the context does.
  const auto mesh = std::make_shared<DeviceMesh>(std::move(uploaded));

  programme.contestants.push_back(
      {step::kUpload, name, [context, &input, connectivity, passes]() -> Result<double> {
         const Stopwatch watch;
         VKMESH_TRY(const DeviceMesh copy,
                    DeviceMesh::create(*context, *connectivity, input.mesh.points, passes));
         return watch.milliseconds();
       }});
  programme.contestants.push_back(
      {step::kNormals, name, [context, mesh] {
         return timed(*context, [&](Recorder& recorder) { return record_vertex_normals(recorder, *mesh); });
       }});
  programme.contestants.push_back({step::kSmoothing, name, [context, &input, mesh]() -> Result<double> {
                                     VKMESH_CHECK(mesh->upload_positions(input.mesh.points));
                                     LaplacianSmoothingOptions smoothing;
                                     smoothing.iterations = kSmoothingSteps;
                                     return timed(*context, [&](Recorder& recorder) {
                                       return record_laplacian_smoothing(recorder, *mesh, smoothing);
                                     });
                                   }});
  return {};
}

}  // namespace vkmesh::bench
