#include "passes/backend.h"

#include <string>

#ifdef VKMESH_HAS_VULKAN
#include <vkmesh/engine/passes/swap_rounds.h>
#endif

namespace vkmesh::cli {
namespace {

void report_host(Job& job) {
  job.json()["device"] = {{"name", "cpu"}, {"driver", "vkmesh " VKMESH_VERSION}, {"type", "host"}};
}

}  // namespace

void use_host(Job& job) {
  const std::string& asked = job.options().device;
  report_host(job);
  if (asked != "auto" && asked != "cpu")
    job.note("this subcommand runs on the host: the device " + asked + " was not used");
}

#ifdef VKMESH_HAS_VULKAN
const char* note_no_gpu(Job& job, const Error& error) {
  if (error.message.empty()) return " (no GPU)";
  job.note("no GPU serves, the CPU computes: " + error.message);
  return " (no GPU that serves)";
}
#endif

Result<SwapRounds> Backend::swap_rounds(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                        const SwapRoundsOptions& options) {
#ifdef VKMESH_HAS_VULKAN
  if (context_) {
    VKMESH_TRY(DeviceMesh device,
               job_.timed("upload", [&] { return DeviceMesh::create(*context_, mesh, positions); }));
    return job_.timed("device",
                      [&] { return run_swap_rounds(*context_, device, options, job_.progress("swapping")); });
  }
#endif
  return job_.timed("compute",
                    [&] { return vkmesh::swap_rounds(mesh, positions, options, job_.progress("swapping")); });
}

Result<Backend> open_backend(Job& job) {
  const std::string& asked = job.options().device;
  const char* why = "";
  if (asked != "cpu") {
#ifdef VKMESH_HAS_VULKAN
    auto context = open_context(job, asked);
    if (context) return Backend(job, *std::move(context));
    if (asked != "auto" || context.error().code != ErrorCode::kNoDevice)
      return tl::unexpected<Error>(std::move(context).error());
    why = note_no_gpu(job, context.error());
#else
    if (asked != "auto")
      return fail(ErrorCode::kNoDevice,
                  "there is no device " + asked + ": this program was built without Vulkan");
#endif
  }
  report_host(job);
  job.row("device", std::string("cpu") + why);
  return Backend(job);
}

}  // namespace vkmesh::cli
