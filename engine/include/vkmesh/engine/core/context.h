// Vulkan devices: those that there are, and one in use.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan_core.h>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>

namespace vkmesh {

namespace detail {
class Device;
}

enum class DeviceType { kDiscreteGpu, kIntegratedGpu, kVirtualGpu, kSoftware, kOther };

/// Name of a type: "discrete", "integrated", "virtual", "software", "other".
[[nodiscard]] VKMESH_API std::string name_of(DeviceType type);

/// A device that Vulkan offers.
struct DeviceInfo {
  std::uint32_t index = 0;  ///< Number that ContextOptions::device takes.
  std::string name;         ///< "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string driver;       ///< "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)".
  DeviceType type = DeviceType::kOther;
  std::string api_version;   ///< "1.3.230".
  std::uint64_t memory = 0;  ///< Bytes of device-local memory.
  /// Rounds after which a thread leaves all its loops, counted over all of them: 65535 on Mesa's llvmpipe.
  std::uint64_t loop_rounds = UINT64_MAX;
  bool usable = false;   ///< Has what the engine requires.
  std::string rejected;  ///< Reason, where `usable` is false.
};

struct ContextOptions {
  /// Device to open. "auto" (default): the first usable of discrete, integrated, virtual GPUs, never a
  /// software device. "2": by index. Anything else: the first usable device whose name contains it, whatever
  /// the case
  /// ("llvmpipe").
  std::string device = "auto";
  /// Turns on the Khronos validation layer with synchronization validation. Default false.
  bool validation = false;
  /// Adds GPU-assisted validation, which is slow. Needs `validation`. Default false.
  bool gpu_assisted_validation = false;
  /// Called with each validation message, on any thread that calls Vulkan; they are also kept in the context.
  std::function<void(const std::string&)> on_validation_message;
  /// Skips the check that the device's arithmetic equals the host's bit by bit. Default false.
  bool skip_exactness_check = false;
  /// Moves data through staging buffers even where the host could write the device's memory. Default false.
  bool force_staging = false;
  /// Bytes of a staging buffer; more data goes in several rounds. Default 32 MiB.
  std::uint64_t staging_bytes = std::uint64_t{32} << 20;
  /// Largest number of threads of one dispatch; longer work is split, so that no watchdog stops it. Default
  /// 4 Mi.
  std::uint32_t max_threads_per_dispatch = std::uint32_t{1} << 22;
  /// Entry point of the Vulkan loader. Default: that of the system's loader, opened at run time.
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
};

/// Device of the caller's, which the engine uses and never destroys. It must have been created with what
/// required_features() and required_extensions() name, its instance with at least required_api_version() as
/// VkApplicationInfo::apiVersion, and both must outlive the context and all that is made with it. Where the
/// instance has VK_EXT_debug_utils, buffers, images and pipelines bear names.
struct AdoptedDevice {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  ///< Its family must support compute.
  std::uint32_t queue_family = 0;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  /// Called around each use of the queue, for callers that use it from other threads. Both or neither. They
  /// must not throw.
  std::function<void()> lock_queue;
  std::function<void()> unlock_queue;
};

/// Returns VK_API_VERSION_1_2.
[[nodiscard]] VKMESH_API std::uint32_t required_api_version();
/// Features of Vulkan 1.2 that must be enabled: bufferDeviceAddress. `pNext` is null.
[[nodiscard]] VKMESH_API VkPhysicalDeviceVulkan12Features required_features();
/// Names of required device extensions: none today.
[[nodiscard]] VKMESH_API std::span<const char* const> required_extensions();

/// Lists every device of the machine, usable or not, in the loader's order.
/// Errors: kNoDevice when there is no Vulkan loader, or no instance can be made.
[[nodiscard]] VKMESH_API Result<std::vector<DeviceInfo>> list_devices(const ContextOptions& options = {});

/// A device and its queue, the kernels made for it, and a tally of its memory. Several contexts may live at
/// once. Its functions may be called from several threads. What is made with it (buffers, recorders, meshes)
/// may outlive it, works on, and keeps the device open.
class VKMESH_API Context {
 public:
  /// Opens a device, and checks its arithmetic on a few hundred values.
  /// Errors: kNoDevice (no loader, no device that fits the request, each named with the reason why not, the
  /// layer of `validation` missing, arithmetic that differs from the host's), kOutOfMemory; kInternal where
  /// vkmesh was compiled with options that change its own arithmetic.
  [[nodiscard]] static Result<std::unique_ptr<Context>> create(const ContextOptions& options = {});

  /// Works on the caller's device. Options on validation and on the choice of a device are ignored. Errors:
  /// kUsage for a missing handle, or an instance made for a version of Vulkan below required_api_version();
  /// kNoDevice where the device lacks what is required or computes otherwise.
  [[nodiscard]] static Result<std::unique_ptr<Context>> adopt(const AdoptedDevice& adopted,
                                                              const ContextOptions& options = {});

  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  [[nodiscard]] const DeviceInfo& info() const;
  /// Bytes of device memory that buffers of this context hold now.
  [[nodiscard]] std::uint64_t allocated_bytes() const;
  /// Takes the validation messages gathered since the last call.
  [[nodiscard]] std::vector<std::string> take_validation_messages();

  /// Internal: for the engine's own sources. The device closes with the last who share it.
  explicit Context(std::shared_ptr<detail::Device> device);
  [[nodiscard]] const std::shared_ptr<detail::Device>& shared_device() const { return device_; }
  [[nodiscard]] detail::Device& device() const { return *device_; }

 private:
  std::shared_ptr<detail::Device> device_;
};

}  // namespace vkmesh
