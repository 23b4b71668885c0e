// Which devices there are, what they lack, and which one a request means.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "core/device.h"

namespace vkmesh {

std::string name_of(DeviceType type) {
  switch (type) {
    case DeviceType::kDiscreteGpu:
      return "discrete";
    case DeviceType::kIntegratedGpu:
      return "integrated";
    case DeviceType::kVirtualGpu:
      return "virtual";
    case DeviceType::kSoftware:
      return "software";
    case DeviceType::kOther:
      break;
  }
  return "other";
}

namespace detail {
namespace {

DeviceType type_of(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return DeviceType::kDiscreteGpu;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return DeviceType::kIntegratedGpu;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceType::kVirtualGpu;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return DeviceType::kSoftware;
    default:
      return DeviceType::kOther;
  }
}

std::string version_text(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) +
         "." + std::to_string(VK_API_VERSION_PATCH(version));
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Empty where the request means this device.
std::string why_not(const PhysicalDevice& device, const std::string& request,
                    std::optional<std::uint32_t> index) {
  const bool automatic = request == "auto";
  if (index && *index != device.info.index) return "its index is " + std::to_string(device.info.index);
  if (!automatic && !index && lower(device.info.name).find(lower(request)) == std::string::npos)
    return "its name does not hold these letters";
  if (!device.info.usable) return device.info.rejected;
  if (automatic && device.info.type == DeviceType::kSoftware)
    return "it is software, which must be asked for by name";
  return {};
}

}  // namespace

PhysicalDevice judge(const InstanceFunctions& functions, VkPhysicalDevice handle, std::uint32_t index) {
  PhysicalDevice device;
  device.handle = handle;
  device.info.index = index;

  VkPhysicalDeviceProperties properties;
  functions.vkGetPhysicalDeviceProperties(handle, &properties);
  device.info.name = properties.deviceName;
  device.info.type = type_of(properties.deviceType);
  device.info.api_version = version_text(properties.apiVersion);
  VkPhysicalDeviceMemoryProperties memory;
  functions.vkGetPhysicalDeviceMemoryProperties(handle, &memory);
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if ((memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0)
      device.info.memory = std::max<std::uint64_t>(device.info.memory, memory.memoryHeaps[i].size);

  if (properties.apiVersion < required_api_version()) {
    device.info.driver = version_text(properties.driverVersion);
    device.info.rejected =
        "needs Vulkan " + version_text(required_api_version()) + ", has " + device.info.api_version;
    return device;
  }
  VkPhysicalDeviceDriverProperties driver{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, nullptr, {}, {}, {}, {}};
  VkPhysicalDeviceProperties2 more{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver, {}};
  functions.vkGetPhysicalDeviceProperties2(handle, &more);
  device.info.driver =
      std::string(driver.driverName) + " " +
      (driver.driverInfo[0] != 0 ? driver.driverInfo : version_text(properties.driverVersion));
  if (driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE) device.info.loop_rounds = 65535;
  device.crashes_on_pointer_bitcasts = driver.driverID == VK_DRIVER_ID_GOOGLE_SWIFTSHADER;

  VkPhysicalDeviceVulkan12Features features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features, {}};
  functions.vkGetPhysicalDeviceFeatures2(handle, &all);
  if (features.bufferDeviceAddress == VK_FALSE) {
    device.info.rejected = "lacks the feature bufferDeviceAddress";
    return device;
  }

  std::uint32_t count = 0;
  functions.vkGetPhysicalDeviceQueueFamilyProperties(handle, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  functions.vkGetPhysicalDeviceQueueFamilyProperties(handle, &count, families.data());
  const auto family_with = [&](VkQueueFlags flags) {
    return std::find_if(families.begin(), families.end(), [flags](const VkQueueFamilyProperties& f) {
      return (f.queueFlags & flags) == flags && f.queueCount > 0;
    });
  };
  // One that draws as well, where there is one; Vulkan promises it for devices that draw at all.
  auto family = family_with(VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT);
  if (family == families.end()) family = family_with(VK_QUEUE_COMPUTE_BIT);
  if (family == families.end()) {
    device.info.rejected = "has no queue that computes";
    return device;
  }
  device.queue_family = static_cast<std::uint32_t>(family - families.begin());
  device.info.usable = true;
  return device;
}

Result<std::vector<PhysicalDevice>> physical_devices(const InstanceFunctions& functions,
                                                     VkInstance instance) {
  std::uint32_t count = 0;
  VKMESH_VK(functions.vkEnumeratePhysicalDevices(instance, &count, nullptr), "listing the Vulkan devices");
  std::vector<VkPhysicalDevice> handles(count);
  if (count > 0)
    VKMESH_VK(functions.vkEnumeratePhysicalDevices(instance, &count, handles.data()),
              "listing the Vulkan devices");
  handles.resize(count);
  std::vector<PhysicalDevice> devices;
  for (std::uint32_t i = 0; i < count; ++i) devices.push_back(judge(functions, handles[i], i));
  return devices;
}

Result<PhysicalDevice> choose(const std::vector<PhysicalDevice>& devices, const std::string& request) {
  if (devices.empty())
    return fail(ErrorCode::kNoDevice,
                "Vulkan offers no device: no driver is installed that fits this machine (Debian's "
                "mesa-vulkan-drivers has one in software)");
  std::optional<std::uint32_t> index;
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(request.data(), request.data() + request.size(), number);
  if (error == std::errc() && end == request.data() + request.size()) index = number;

  const PhysicalDevice* best = nullptr;
  std::string reasons;
  for (const PhysicalDevice& device : devices) {
    const std::string reason = why_not(device, request, index);
    if (!reason.empty()) {
      reasons += (reasons.empty() ? "" : "; ") + device.info.name + ": " + reason;
      continue;
    }
    // The enumerators stand in the order of preference; a request by name takes the first.
    if (best == nullptr || (request == "auto" && device.info.type < best->info.type)) best = &device;
  }
  if (best == nullptr)
    return fail(ErrorCode::kNoDevice, "no Vulkan device answers '" + request + "' (" + reasons + ")");
  return *best;
}

}  // namespace detail
}  // namespace vkmesh
