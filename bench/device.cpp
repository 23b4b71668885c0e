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
  // The mesh, and what passes keep from run to run.
  struct OnDevice {
    std::shared_ptr<Context> context;  // Outlives what follows.
    std::shared_ptr<HalfEdgeMesh> connectivity;
    DeviceMesh mesh;
    DeviceVertexNormals normals;
    DeviceSmoothing smoothing;
  };
  const auto place = std::make_shared<OnDevice>();
  place->context = context;
  place->connectivity = connectivity;
  VKMESH_TRY(place->mesh, DeviceMesh::create(*context, *connectivity, input.mesh.points));

  programme.contestants.push_back(
      {step::kUpload, name, [context, &input, connectivity]() -> Result<double> {
         const Stopwatch watch;
         VKMESH_TRY(DeviceMesh copy, DeviceMesh::create(*context, *connectivity, input.mesh.points));
         // What normals and smoothing ask for.
         VKMESH_CHECK(copy.corners());
         VKMESH_CHECK(copy.corner_offsets());
         VKMESH_CHECK(copy.neighbour_offsets());
         return watch.milliseconds();
       }});
  programme.contestants.push_back({step::kNormals, name, [place] {
                                     return timed(*place->context, [&](Recorder& recorder) {
                                       return record_vertex_normals(recorder, place->mesh, place->normals);
                                     });
                                   }});
  programme.contestants.push_back({step::kSmoothing, name, [place, &input]() -> Result<double> {
                                     VKMESH_CHECK(place->mesh.upload_positions(input.mesh.points));
                                     LaplacianSmoothingOptions smoothing;
                                     smoothing.iterations = kSmoothingSteps;
                                     return timed(*place->context, [&](Recorder& recorder) {
                                       return record_laplacian_smoothing(recorder, place->mesh,
                                                                         place->smoothing, smoothing);
                                     });
                                   }});
  return {};
}

}  // namespace vkmesh::bench
