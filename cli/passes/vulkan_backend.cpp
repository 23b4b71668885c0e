#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <utility>

#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/engine/passes/bilateral_smoothing.h>
#include <vkmesh/engine/passes/collapse_costs.h>
#include <vkmesh/engine/passes/curvatures.h>
#include <vkmesh/engine/passes/dihedral_angles.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/restore_volume.h>
#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/engine/passes/swap_scores.h>
#include <vkmesh/engine/passes/triangle_normals.h>
#include <vkmesh/engine/passes/vertex_normals.h>

#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

class VulkanBackend : public Backend {
 public:
  VulkanBackend(Job& job, std::unique_ptr<Context> context) : job_(job), context_(std::move(context)) {}

  Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                           const VertexNormalsOptions& options) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.vertex_normals = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_vertex_normals(recorder, device, options); }));
    return job_.timed("download", [&] { return device.download_vertex_normals(); });
  }

  Result<std::vector<Vec3>> triangle_normals(const HalfEdgeMesh& mesh,
                                             std::span<const Vec3> positions) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.triangle_normals = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_triangle_normals(recorder, device); }));
    return job_.timed("download", [&] { return device.download_triangle_normals(); });
  }

  Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.dihedral_angles = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_dihedral_angles(recorder, device); }));
    return job_.timed("download", [&]() -> Result<DihedralAngles> {
      DihedralAngles angles;
      VKMESH_TRY(angles.half_edge, device.download_half_edge_angles());
      VKMESH_TRY(angles.vertex_maximum, device.download_vertex_maxima());
      return angles;
    });
  }

  Result<std::vector<VertexCurvature>> curvatures(const HalfEdgeMesh& mesh,
                                                  std::span<const Vec3> positions) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.curvatures = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_curvatures(recorder, device); }));
    return job_.timed("download", [&] { return device.download_curvatures(); });
  }

  Result<SurfaceMeasures> surface_measures(const HalfEdgeMesh& mesh,
                                           std::span<const Vec3> positions) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.surface_measures = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_surface_measures(recorder, device); }));
    return job_.timed("download", [&] { return device.download_surface_measures(); });
  }

  Result<std::vector<Vec3>> bilateral_smoothing(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                                const BilateralSmoothingOptions& options,
                                                bool keep_volume) override {
    VKMESH_TRY(DeviceMesh device,
               upload(mesh, positions, {.bilateral_smoothing = true, .restore_volume = keep_volume}));
    VKMESH_TRY(const NearbyFaces nearby, job_.timed("upload", [&] {
      return NearbyFaces::create(*context_, mesh, positions, options);
    }));
    if (keep_volume) VKMESH_CHECK(run([&](Recorder& recorder) { return record_volume(recorder, device); }));
    VKMESH_CHECK(
        run([&](Recorder& recorder) { return record_bilateral_smoothing(recorder, device, nearby); }));
    return restored(device, keep_volume);
  }

  Result<std::vector<float>> collapse_costs(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                            const CollapseCostOptions& options) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.collapse_costs = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_collapse_costs(recorder, device, options); }));
    return job_.timed("download", [&] { return device.download_collapse_costs(); });
  }

  Result<std::vector<float>> swap_scores(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                         SwapCriterion criterion) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.swap_scores = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_swap_scores(recorder, device, criterion); }));
    return job_.timed("download", [&] { return device.download_swap_scores(); });
  }

  Result<std::vector<Vec3>> laplacian_smoothing(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                                const LaplacianSmoothingOptions& options,
                                                bool keep_volume) override {
    VKMESH_TRY(DeviceMesh device,
               upload(mesh, positions, {.laplacian_smoothing = true, .restore_volume = keep_volume}));
    if (keep_volume) VKMESH_CHECK(run([&](Recorder& recorder) { return record_volume(recorder, device); }));
    const Progress progress = job_.progress("smoothing");
    // In portions of a fraction of a second, so that progress shows and an interrupt is heard.
    LaplacianSmoothingOptions portion = options;
    portion.iterations = 1;
    for (std::uint32_t left = options.iterations; left > 0;) {
      if (!progress(1.0 - static_cast<double>(left) / options.iterations))
        return fail(ErrorCode::kInterrupted, "interrupted");
      portion.iterations = std::min(portion.iterations, left);
      VKMESH_TRY(const double milliseconds, run([&](Recorder& recorder) {
                   return record_laplacian_smoothing(recorder, device, portion);
                 }));
      left -= portion.iterations;
      if (milliseconds < 100) portion.iterations *= 2;
    }
    return restored(device, keep_volume);
  }

 private:
  Result<DeviceMesh> upload(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                            const MeshPasses& passes) {
    return job_.timed("upload", [&] { return DeviceMesh::create(*context_, mesh, positions, passes); });
  }

  /// The positions in the end.
  Result<std::vector<Vec3>> restored(DeviceMesh& device, bool keep_volume) {
    if (keep_volume)
      VKMESH_CHECK(run([&](Recorder& recorder) { return record_restore_volume(recorder, device); }));
    return job_.timed("download", [&] { return device.download_positions(); });
  }

  /// Runs what `record` records, books the device's time and returns it in milliseconds.
  template <class Record>
  Result<double> run(Record&& record) {
    VKMESH_TRY(Recorder recorder, Recorder::create(*context_));
    recorder.begin_section("pass");
    VKMESH_CHECK(record(recorder));
    const auto start = std::chrono::steady_clock::now();
    VKMESH_CHECK(recorder.submit_and_wait());
    double milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    // The device's own clock, where it has one, leaves the host's share out.
    if (const auto sections = recorder.section_times(); !sections.empty())
      milliseconds = sections[0].milliseconds;
    job_.book("device", milliseconds);
    return milliseconds;
  }

  Job& job_;
  std::unique_ptr<Context> context_;
};

}  // namespace

ContextOptions context_options(const std::string& device) {
  ContextOptions options;
  options.device = device;
#ifndef NDEBUG
  options.validation = true;
  options.on_validation_message = [](const std::string& message) {
    std::fprintf(stderr, "validation: %s\n", message.c_str());
  };
#endif
  return options;
}

Result<std::unique_ptr<Context>> open_context(Job& job, const std::string& device) {
  VKMESH_TRY(std::unique_ptr<Context> context,
             job.timed("open", [&] { return Context::create(context_options(device)); }));
  const DeviceInfo& info = context->info();
  job.json()["device"] = {{"name", info.name}, {"driver", info.driver}, {"type", name_of(info.type)}};
  job.row("device", info.name + "; " + info.driver + "; " + name_of(info.type));
  return context;
}

Result<std::unique_ptr<Backend>> open_vulkan_backend(Job& job, const std::string& device) {
  VKMESH_TRY(std::unique_ptr<Context> context, open_context(job, device));
  return std::make_unique<VulkanBackend>(job, std::move(context));
}

}  // namespace vkmesh::cli
