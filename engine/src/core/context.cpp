#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/core/context.h>

#include "core/device.h"

namespace vkmesh {
namespace {

/// Loaders and drivers hide what is newer than the version that an instance was made for, and have no
/// function that tells this version.
Result<void> require_instance_version(const AdoptedDevice& adopted) {
  const auto load = [&](const char* name) { return adopted.get_instance_proc_addr(adopted.instance, name); };
  const auto get_properties =
      reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(load("vkGetPhysicalDeviceProperties"));
  const auto get_device_proc_addr = reinterpret_cast<PFN_vkGetDeviceProcAddr>(load("vkGetDeviceProcAddr"));
  if (get_properties == nullptr || get_device_proc_addr == nullptr) return {};  // No instance hides these.
  VkPhysicalDeviceProperties properties;
  get_properties(adopted.physical_device, &properties);
  if (properties.apiVersion < required_api_version()) return {};  // It is the device that is too old.
  if (load("vkGetPhysicalDeviceFeatures2") != nullptr &&
      get_device_proc_addr(adopted.device, "vkGetBufferDeviceAddress") != nullptr)
    return {};
  return fail(ErrorCode::kUsage, "the adopted instance was made for a version of Vulkan below 1.2, though " +
                                     std::string(properties.deviceName) +
                                     " has it: set VkApplicationInfo::apiVersion to VK_API_VERSION_1_2");
}

}  // namespace

std::uint32_t required_api_version() {
  return VK_API_VERSION_1_2;
}

VkPhysicalDeviceVulkan12Features required_features() {
  VkPhysicalDeviceVulkan12Features features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  features.bufferDeviceAddress = VK_TRUE;
  return features;
}

std::span<const char* const> required_extensions() {
  return {};
}

Result<std::vector<DeviceInfo>> list_devices(const ContextOptions& options) {
  return detail::catching([&]() -> Result<std::vector<DeviceInfo>> {
    VKMESH_TRY(const auto instance, detail::Instance::create(options));
    VKMESH_TRY(const auto devices, detail::physical_devices(instance->functions, instance->handle));
    std::vector<DeviceInfo> infos;
    for (const detail::PhysicalDevice& device : devices) infos.push_back(device.info);
    return infos;
  });
}

Context::Context(std::shared_ptr<detail::Device> device) : device_(std::move(device)) {}

Context::~Context() = default;

Result<std::unique_ptr<Context>> Context::create(const ContextOptions& options) {
  return detail::catching([&]() -> Result<std::unique_ptr<Context>> {
    VKMESH_TRY(auto instance, detail::Instance::create(options));
    VKMESH_TRY(const auto devices, detail::physical_devices(instance->functions, instance->handle));
    VKMESH_TRY(const detail::PhysicalDevice physical, detail::choose(devices, options.device));

    auto device = std::make_shared<detail::Device>(instance->functions, options);
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = physical.queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkPhysicalDeviceVulkan12Features features = required_features();
    VkDeviceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &features;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = static_cast<std::uint32_t>(required_extensions().size());
    info.ppEnabledExtensionNames = required_extensions().data();
    device->instance = std::move(instance);
    const VkResult created =
        device->instance_functions.vkCreateDevice(physical.handle, &info, nullptr, &device->handle);
    if (created != VK_SUCCESS) {
      device->handle = VK_NULL_HANDLE;
      tl::unexpected<Error> failure = detail::vulkan_failure(created, "opening " + physical.info.name);
      if (failure.value().code == ErrorCode::kInternal) failure.value().code = ErrorCode::kNoDevice;
      return failure;
    }
    device->queue_family = physical.queue_family;
    VKMESH_CHECK(device->initialise(physical));
    device->functions.vkGetDeviceQueue(device->handle, device->queue_family, 0, &device->queue);

    auto context = std::make_unique<Context>(std::move(device));
    if (!options.skip_exactness_check) VKMESH_CHECK(detail::check_exactness(*context));
    return context;
  });
}

Result<std::unique_ptr<Context>> Context::adopt(const AdoptedDevice& adopted, const ContextOptions& options) {
  return detail::catching([&]() -> Result<std::unique_ptr<Context>> {
    if (adopted.instance == VK_NULL_HANDLE || adopted.physical_device == VK_NULL_HANDLE ||
        adopted.device == VK_NULL_HANDLE || adopted.queue == VK_NULL_HANDLE ||
        adopted.get_instance_proc_addr == nullptr)
      return fail(ErrorCode::kUsage, "an adopted device needs every handle, and vkGetInstanceProcAddr");
    if (static_cast<bool>(adopted.lock_queue) != static_cast<bool>(adopted.unlock_queue))
      return fail(ErrorCode::kUsage, "lock_queue and unlock_queue go together");
    VKMESH_CHECK(require_instance_version(adopted));
    VKMESH_TRY(const auto functions,
               detail::load_instance_functions(adopted.get_instance_proc_addr, adopted.instance));
    const detail::PhysicalDevice physical = detail::judge(functions, adopted.physical_device, 0);
    if (!physical.info.usable)
      return fail(ErrorCode::kNoDevice, physical.info.name + " cannot be used: it " + physical.info.rejected);

    auto device = std::make_shared<detail::Device>(functions, options);
    device->adopted = true;
    device->handle = adopted.device;
    device->queue = adopted.queue;
    device->queue_family = adopted.queue_family;
    device->lock_queue = adopted.lock_queue;
    device->unlock_queue = adopted.unlock_queue;
    VKMESH_CHECK(device->initialise(physical));
    auto context = std::make_unique<Context>(std::move(device));
    if (!options.skip_exactness_check) VKMESH_CHECK(detail::check_exactness(*context));
    return context;
  });
}

const DeviceInfo& Context::info() const {
  return device_->info;
}

std::uint64_t Context::allocated_bytes() const {
  return device_->allocated.load();
}

std::vector<std::string> Context::take_validation_messages() {
  if (!device_->instance || !device_->instance->messages) return {};
  return device_->instance->messages->take();
}

}  // namespace vkmesh
