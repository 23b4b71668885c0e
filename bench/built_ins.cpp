// What exactness costs: passes with the engine's kernels, and with the same kernels compiled with built-ins.
#include <any>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/repair/consolidate.h>

#include "bench/contestants.h"
#include "built_in_shaders.h"
#include "core/device.h"
#include "passes/pass_table.h"

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
};

/// A pass on such a device.
struct Ready {
  std::shared_ptr<Place> place;
  cli::DevicePass<std::any> pass;
};

Result<double> time_of(Ready& ready, const Input& input) {
  VKMESH_CHECK(ready.place->mesh.upload_positions(input.mesh.points));
  VKMESH_TRY(Recorder recorder, Recorder::create(*ready.place->context));
  VKMESH_CHECK(ready.pass.record(recorder, 0, ready.pass.steps));
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
  VKMESH_TRY(place->mesh, DeviceMesh::create(*place->context, half_edges, input.mesh.points));
  return place;
}

}  // namespace

Result<void> add_built_ins(Programme& programme, const Input& input, const std::string& device) {
  VKMESH_TRY(HalfEdgeMesh made, to_half_edge_mesh(input.mesh));
  const auto half_edges = std::make_shared<HalfEdgeMesh>(std::move(made));
  VKMESH_TRY(const auto exact, make_place(input, *half_edges, device, false));
  VKMESH_TRY(const auto built_ins, make_place(input, *half_edges, device, true));
  const cli::PassInput of_pass(*half_edges, input.mesh.points);
  for (const cli::PassRow& row : cli::pass_table()) {
    if (row.title.empty()) continue;
    for (const auto& [name, place] : {std::pair{"exact, " + device, exact}, {kBuiltIns, built_ins}}) {
      const auto ready = std::make_shared<Ready>();
      ready->place = place;
      VKMESH_TRY(ready->pass, row.pass(of_pass).device(*place->context, place->mesh, of_pass));
      const std::string steps = row.steps == 1 ? "" : std::to_string(row.steps) + " times ";
      programme.contestants.push_back(
          {steps + row.title + " against built-ins", name,
           [&input, half_edges, ready]() -> Result<double> { return time_of(*ready, input); }});
    }
  }
  return {};
}

}  // namespace vkmesh::bench
