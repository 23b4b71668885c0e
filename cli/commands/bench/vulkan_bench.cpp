// The passes of vkmesh bench on a Vulkan device.
#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/engine/passes/bilateral_smoothing.h>
#include <vkmesh/engine/passes/collapse_costs.h>
#include <vkmesh/engine/passes/curvatures.h>
#include <vkmesh/engine/passes/dihedral_angles.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/engine/passes/swap_scores.h>
#include <vkmesh/engine/passes/triangle_normals.h>
#include <vkmesh/engine/passes/vertex_normals.h>

#include "commands/bench/bench.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

using Record = std::function<Result<void>(Recorder&, DeviceMesh&)>;

class VulkanBench : public BenchPlace {
 public:
  explicit VulkanBench(std::unique_ptr<Context> context) : context_(std::move(context)) {}

  Result<void> for_each_pass(const BenchSubject& s, const std::string& only,
                             const std::function<Result<void>(const BenchPass&)>& use) override {
    const BenchBytes bytes(s);
    const auto normals = [](NormalWeights weights) {
      return [weights](Recorder& r, DeviceMesh& m) { return record_vertex_normals(r, m, {weights}); };
    };
    const auto steps = [](LaplacianSmoothingOptions options) {
      return [options](Recorder& r, DeviceMesh& m) { return record_laplacian_smoothing(r, m, options); };
    };
    const CollapseCostOptions frame = unit_frame(s.positions);
    const auto timed = [&](const char* name, std::uint64_t touched, const MeshPasses& passes,
                           const Record& record, double runs = 1) -> Result<void> {
      if (std::string(name).find(only) == std::string::npos) return {};
      VKMESH_TRY(DeviceMesh mesh, DeviceMesh::create(*context_, s.mesh, s.positions, passes));
      return use({name, touched, [&]() -> Result<double> {
                    VKMESH_TRY(const double all, time([&](Recorder& r) { return record(r, mesh); }));
                    return all / runs;
                  }});
    };
    VKMESH_CHECK(timed("triangle normals", bytes.triangle_normals, {.triangle_normals = true},
                       record_triangle_normals));
    VKMESH_CHECK(timed("vertex normals", bytes.vertex_normals, {.vertex_normals = true},
                       normals(NormalWeights::kArea)));
    VKMESH_CHECK(timed("vertex normals by angle", bytes.vertex_normals, {.vertex_normals = true},
                       normals(NormalWeights::kAngle)));
    VKMESH_CHECK(
        timed("dihedral angles", bytes.dihedral_angles, {.dihedral_angles = true}, record_dihedral_angles));
    VKMESH_CHECK(timed("curvatures", bytes.curvatures, {.curvatures = true}, record_curvatures));
    VKMESH_CHECK(timed("Laplacian step", bytes.smoothing_step, {.laplacian_smoothing = true},
                       steps({.iterations = kBenchSteps}), kBenchSteps));
    VKMESH_CHECK(timed("cotangent step", bytes.smoothing_step, {.laplacian_smoothing = true},
                       steps({.iterations = kBenchSteps, .weights = SmoothingWeights::kCotangent}),
                       kBenchSteps));
    VKMESH_CHECK(
        timed("area and volume", bytes.measures, {.surface_measures = true}, record_surface_measures));
    VKMESH_CHECK(timed("quadrics and collapse costs", bytes.collapse_costs, {.collapse_costs = true},
                       [&](Recorder& r, DeviceMesh& m) { return record_collapse_costs(r, m, frame); }));
    VKMESH_CHECK(timed("swap scores", bytes.swap_scores, {.swap_scores = true},
                       [](Recorder& r, DeviceMesh& m) { return record_swap_scores(r, m); }));
    if (std::string("bilateral smoothing").find(only) == std::string::npos) return {};
    const BilateralWidth width = bench_widths(s);
    VKMESH_TRY(const NearbyFaces nearby,
               NearbyFaces::create(*context_, s.mesh, s.positions, {width.spatial, width.influence}));
    // Positions that have moved by a run are as good to time the next with.
    return timed("bilateral smoothing", bytes.bilateral_smoothing, {.bilateral_smoothing = true},
                 [&](Recorder& r, DeviceMesh& m) { return record_bilateral_smoothing(r, m, nearby); });
  }

  Result<double> copy(std::uint64_t bytes) override {
    const std::uint64_t whole = std::max<std::uint64_t>(bytes / 4 * 4, 4);
    if (!from_ || from_->size() != whole) {
      from_.reset();
      to_.reset();
      VKMESH_TRY(from_, Buffer::create(*context_, whole, BufferMemory::kDevice, "copied"));
      VKMESH_TRY(to_, Buffer::create(*context_, whole, BufferMemory::kDevice, "copy"));
    }
    return time([&](Recorder& recorder) { return recorder.copy(*from_, *to_, whole); });
  }

 private:
  /// The device's time, by its own clock where it has one.
  template <class Work>
  Result<double> time(Work&& record) {
    VKMESH_TRY(Recorder recorder, Recorder::create(*context_));
    recorder.begin_section("pass");
    VKMESH_CHECK(record(recorder));
    const auto start = std::chrono::steady_clock::now();
    VKMESH_CHECK(recorder.submit_and_wait(std::chrono::minutes(10)));
    const double wall =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const auto sections = recorder.section_times();
    return sections.empty() ? wall : sections[0].milliseconds;
  }

  std::unique_ptr<Context> context_;
  std::optional<Buffer> from_, to_;
};

}  // namespace

Result<std::unique_ptr<BenchPlace>> open_vulkan_bench(Job& job, const std::string& device) {
  VKMESH_TRY(std::unique_ptr<Context> context, open_context(job, device));
  return std::make_unique<VulkanBench>(std::move(context));
}

}  // namespace vkmesh::cli
