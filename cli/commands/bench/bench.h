// Where vkmesh bench times passes: on the host, or on a Vulkan device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <vkmesh/base/result.h>

#include "job/common.h"
#include "passes/pass_table.h"

namespace vkmesh::cli {

/// A place where passes run.
class BenchPlace {
 public:
  /// Runs a pass once, and returns the milliseconds; the first run may be slower.
  using Run = std::function<Result<double>()>;

  BenchPlace() = default;
  virtual ~BenchPlace() = default;
  BenchPlace(const BenchPlace&) = delete;
  BenchPlace& operator=(const BenchPlace&) = delete;

  /// Makes a pass ready, with all that it needs in place. The input must outlive it.
  virtual Result<Run> prepare(const PassRow& row, const PassInput& input) = 0;
  /// Milliseconds of a plain copy of so many bytes, each read and written.
  virtual Result<double> copy(std::uint64_t bytes) = 0;
  /// Whether decimation, which is no pass, runs here.
  [[nodiscard]] virtual bool decimates() const = 0;
};

#ifdef VKMESH_HAS_VULKAN
/// On a device, chosen as ContextOptions::device is; reported in the job. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<BenchPlace>> open_vulkan_bench(Job& job, const std::string& device);
#endif

}  // namespace vkmesh::cli
