// Where the compute passes of a subcommand run: their CPU references, or a Vulkan device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <vkmesh/base/result.h>
#ifdef VKMESH_HAS_VULKAN
#include <vkmesh/engine/core/context.h>
#endif
#include <vkmesh/passes/swap_rounds.h>

#include "job/common.h"
#include "passes/pass_table.h"

namespace vkmesh::cli {

/// The host, or a device. Passes give the same bits on all, and book their times in the job that this was
/// opened for.
class Backend {
 public:
  explicit Backend(Job& job) : job_(job) {}
#ifdef VKMESH_HAS_VULKAN
  Backend(Job& job, std::unique_ptr<Context> context) : job_(job), context_(std::move(context)) {}
#endif

  template <class Output>
  [[nodiscard]] Result<Output> run(const Pass<Output>& pass, const PassInput& input) {
#ifdef VKMESH_HAS_VULKAN
    if (context_) {
      VKMESH_TRY(DeviceMesh mesh, job_.timed("upload", [&] {
        return DeviceMesh::create(*context_, input.mesh, input.positions);
      }));
      VKMESH_TRY(const DevicePass<Output> ready,
                 job_.timed("upload", [&] { return pass.device(*context_, mesh, input); }));
      VKMESH_CHECK(run_steps(ready.steps, ready.record));
      return job_.timed("download", ready.download);
    }
#endif
    Output output{};
    VKMESH_CHECK(job_.timed("compute", [&] { return pass.host(input, job_.progress("smoothing"), output); }));
    return output;
  }

  /// Rounds of edge swaps, which end when one swaps nothing.
  [[nodiscard]] Result<SwapRounds> swap_rounds(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                               const SwapRoundsOptions& options);

 private:
#ifdef VKMESH_HAS_VULKAN
  /// Runs the steps in portions of a fraction of a second, so that progress shows and an interrupt is heard.
  [[nodiscard]] Result<void> run_steps(
      std::uint32_t steps,
      const std::function<Result<void>(Recorder&, std::uint32_t, std::uint32_t)>& record);
#endif

  Job& job_;
#ifdef VKMESH_HAS_VULKAN
  std::unique_ptr<Context> context_;
#endif
};

/// The backend that --device asks for, reported in the job. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<Backend> open_backend(Job& job);

/// For subcommands that run on the host alone: reports that, and says so when another device was asked for.
void use_host(Job& job);

#ifdef VKMESH_HAS_VULKAN
/// How every subcommand opens a device. In debug builds the validation layer watches, and speaks on standard
/// error.
[[nodiscard]] ContextOptions context_options(const std::string& device);

/// Notes why "auto" has come to the CPU, unless there is just no GPU; what the device's row then adds to
/// "cpu".
[[nodiscard]] const char* note_no_gpu(Job& job, const Error& error);

/// Reports the device that the job runs on.
void report_device(Job& job, const DeviceInfo& info);

/// A Vulkan device, chosen as ContextOptions::device is, and for "auto" by probe_for_auto(); reported in the
/// job. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<Context>> open_context(Job& job, const std::string& device);

/// Runs what `record` records. Returns the device's time in milliseconds, by its own clock where it has one.
[[nodiscard]] Result<double> run_recorded(Context& context,
                                          const std::function<Result<void>(Recorder&)>& record);
#endif

}  // namespace vkmesh::cli
