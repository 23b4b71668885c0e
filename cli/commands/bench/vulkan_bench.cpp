// The passes of vkmesh bench on a Vulkan device.
#include <algorithm>
#include <optional>
#include <utility>

#include <vkmesh/engine/core/context.h>

#include "commands/bench/bench.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

class VulkanBench : public BenchPlace {
 public:
  explicit VulkanBench(std::unique_ptr<Context> context) : context_(std::move(context)) {}

  Result<Run> prepare(const PassRow& row, const PassInput& input) override {
    struct Ready {
      DeviceMesh mesh;
      DevicePass<std::any> pass;
    };
    const auto ready = std::make_shared<Ready>();
    VKMESH_TRY(ready->mesh, DeviceMesh::create(*context_, input.mesh, input.positions));
    VKMESH_TRY(ready->pass, row.pass(input).device(*context_, ready->mesh, input));
    // Positions that have moved by a run are as good to time the next with.
    return Run([this, ready] {
      return run_recorded(
          *context_, [&](Recorder& recorder) { return ready->pass.record(recorder, 0, ready->pass.steps); });
    });
  }

  Result<double> copy(std::uint64_t bytes) override {
    const std::uint64_t whole = std::max<std::uint64_t>(bytes / 4 * 4, 4);
    if (!from_ || from_->size() != whole) {
      from_.reset();
      to_.reset();
      VKMESH_TRY(from_, Buffer::create(*context_, whole, BufferMemory::kDevice, "copied"));
      VKMESH_TRY(to_, Buffer::create(*context_, whole, BufferMemory::kDevice, "copy"));
    }
    return run_recorded(*context_, [&](Recorder& recorder) { return recorder.copy(*from_, *to_, whole); });
  }

  [[nodiscard]] bool decimates() const override { return false; }

 private:
  std::unique_ptr<Context> context_;
  std::optional<Buffer> from_, to_;
};

}  // namespace

Result<std::unique_ptr<BenchPlace>> open_vulkan_bench(Job& job, const std::string& device) {
  VKMESH_TRY(std::unique_ptr<Context> context, open_context(job, device));
  return std::make_unique<VulkanBench>(std::move(context));
}

}  // namespace vkmesh::cli
