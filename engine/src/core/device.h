// What a Context owns or borrows.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/kernel.h>

#include "core/spirv.h"
#include "core/vulkan_functions.h"

namespace vkmesh::detail {

class DrawPipelines;

/// Where validation messages go; the messenger may call from any thread.
class MessageLog {
 public:
  explicit MessageLog(std::function<void(const std::string&)> listener) : listener_(std::move(listener)) {}
  void add(const char* message) noexcept;
  [[nodiscard]] std::vector<std::string> take();

 private:
  std::mutex mutex_;
  std::vector<std::string> messages_;
  std::function<void(const std::string&)> listener_;
};

/// An instance of the engine's own, with its messenger when validation is on.
class Instance {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Instance>> create(const ContextOptions& options);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  LoaderFunctions loader;
  InstanceFunctions functions;
  VkInstance handle = VK_NULL_HANDLE;
  std::unique_ptr<MessageLog> messages;

 private:
  Instance() = default;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

/// A physical device, judged.
struct PhysicalDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
  bool crashes_on_pointer_bitcasts = false;  ///< Its driver does, while it makes a pipeline (spirv.h).
  DeviceInfo info;
};

[[nodiscard]] Result<std::vector<PhysicalDevice>> physical_devices(const InstanceFunctions& functions,
                                                                   VkInstance instance);
/// `index` is only carried into the result.
[[nodiscard]] PhysicalDevice judge(const InstanceFunctions& functions, VkPhysicalDevice handle,
                                   std::uint32_t index);
/// The device that ContextOptions::device asks for. Errors: kNoDevice, naming each device and why it was
/// rejected.
[[nodiscard]] Result<PhysicalDevice> choose(const std::vector<PhysicalDevice>& devices,
                                            const std::string& request);

class Device {
 public:
  Device(const InstanceFunctions& functions, const ContextOptions& context_options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Reads the properties of `physical` and loads the functions; `handle` must be set.
  [[nodiscard]] Result<void> initialise(const PhysicalDevice& physical);

  [[nodiscard]] Result<const Kernel*> kernel(const KernelSource& source);
  /// Gives the kernel of this source, made without float controls, to whoever asks for its name from now on:
  /// measurements of what exactness costs. Before the first call of kernel() for the name.
  [[nodiscard]] Result<void> replace_kernel(const KernelSource& source);
  /// What drawing needs, made at the first call. Errors: kNoDevice where the device or its queue cannot draw.
  /// Defined with DrawPipelines.
  [[nodiscard]] Result<DrawPipelines*> draw_pipelines();
  [[nodiscard]] Result<void> submit(const VkSubmitInfo& submit, VkFence fence);
  void set_name(VkObjectType type, std::uint64_t object, const std::string& name) const;

  InstanceFunctions instance_functions;
  VolkDeviceTable functions{};
  ContextOptions options;
  DeviceInfo info;
  std::unique_ptr<Instance> instance;  ///< Null when the device is adopted.
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice handle = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
  bool adopted = false;
  std::function<void()> lock_queue;
  std::function<void()> unlock_queue;

  VkPhysicalDeviceMemoryProperties memory{};
  std::uint64_t max_allocation = 0;
  std::uint32_t max_groups = 0;
  std::uint32_t max_push_constants = 0;
  bool rounds_to_nearest_even = false;       ///< Shaders can ask for it.
  bool keeps_signed_zeros = false;           ///< Likewise.
  bool crashes_on_pointer_bitcasts = false;  ///< As in PhysicalDevice.
  bool draws = false;                        ///< The queue takes graphics commands.
  std::uint32_t max_image_side = 0;          ///< Pixels.
  std::uint32_t timestamp_bits = 0;          ///< 0: none.
  double timestamp_nanoseconds = 0.0;

  std::atomic<std::uint64_t> allocated{0};
  /// Work outlived its recorder. Nothing that it may use can be destroyed any more.
  std::atomic<bool> abandoned{false};

 private:
  [[nodiscard]] Result<std::unique_ptr<Kernel>> make_kernel(const KernelSource& source,
                                                            const FloatControls& controls) const;

  std::mutex queue_mutex_;
  std::mutex kernels_mutex_;
  struct CachedKernel {
    const std::uint32_t* spirv = nullptr;  ///< Null: a replacement.
    std::unique_ptr<Kernel> kernel;
  };
  std::map<std::string, CachedKernel, std::less<>> kernels_;
  std::mutex draw_pipelines_mutex_;
  std::shared_ptr<DrawPipelines> draw_pipelines_;  ///< Shared, so that only `draw` need know the type.
};

/// Runs the arithmetic of the shaders on chosen values. Errors: kNoDevice, naming the function whose result
/// differs from the host's; kInternal where it is the host's that is wrong.
[[nodiscard]] Result<void> check_exactness(Context& context);

}  // namespace vkmesh::detail
