#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <utility>

#include <vkmesh/engine/context.h>
#include <vkmesh/engine/device_mesh.h>
#include <vkmesh/engine/dihedral_angles.h>
#include <vkmesh/engine/laplacian_smoothing.h>
#include <vkmesh/engine/recorder.h>
#include <vkmesh/engine/vertex_normals.h>

#include "backend.h"

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

  Result<std::vector<float>> largest_dihedral_angles(const HalfEdgeMesh& mesh,
                                                     std::span<const Vec3> positions) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.dihedral_angles = true}));
    VKMESH_CHECK(run([&](Recorder& recorder) { return record_dihedral_angles(recorder, device); }));
    return job_.timed("download", [&] { return device.download_vertex_maxima(); });
  }

  Result<std::vector<Vec3>> laplacian_smoothing(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                                const LaplacianSmoothingOptions& options) override {
    VKMESH_TRY(DeviceMesh device, upload(mesh, positions, {.laplacian_smoothing = true}));
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
    return job_.timed("download", [&] { return device.download_positions(); });
  }

 private:
  Result<DeviceMesh> upload(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                            const MeshPasses& passes) {
    return job_.timed("upload", [&] { return DeviceMesh::create(*context_, mesh, positions, passes); });
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

Result<std::unique_ptr<Backend>> open_vulkan_backend(Job& job, const std::string& device) {
  VKMESH_TRY(std::unique_ptr<Context> context,
             job.timed("open", [&] { return Context::create(context_options(device)); }));
  const DeviceInfo& info = context->info();
  job.json()["device"] = {{"name", info.name}, {"driver", info.driver}, {"type", name_of(info.type)}};
  job.row("device", info.name + "; " + info.driver + "; " + name_of(info.type));
  return std::make_unique<VulkanBackend>(job, std::move(context));
}

}  // namespace vkmesh::cli
