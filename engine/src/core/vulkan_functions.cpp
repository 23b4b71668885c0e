#include "core/vulkan_functions.h"

#include <mutex>

namespace vkmesh::detail {
namespace {

// Over volk's global variables.
std::mutex volk_mutex;

tl::unexpected<Error> missing(const char* function) {
  return fail(ErrorCode::kNoDevice, std::string("the Vulkan driver lacks ") + function);
}

}  // namespace

#define VKMESH_LOAD(name)                                     \
  functions.name = reinterpret_cast<PFN_##name>(load(#name)); \
  if (functions.name == nullptr) return missing(#name);

Result<LoaderFunctions> load_loader_functions(PFN_vkGetInstanceProcAddr entry) {
  if (entry == nullptr) {
    // It stays open until the process ends: drivers leave thread-exit handlers behind that would jump into
    // it.
    const std::lock_guard lock(volk_mutex);
    entry = vkmesh_open_loader();
  }
  if (entry == nullptr)
    return fail(ErrorCode::kNoDevice,
                "there is no Vulkan loader on this machine (libvulkan.so.1; Debian's package libvulkan1)");
  const auto load = [&](const char* name) { return entry(VK_NULL_HANDLE, name); };
  LoaderFunctions functions;
  functions.vkGetInstanceProcAddr = entry;
  functions.vkEnumerateInstanceVersion =
      reinterpret_cast<PFN_vkEnumerateInstanceVersion>(load("vkEnumerateInstanceVersion"));
  VKMESH_LOADER_FUNCTIONS(VKMESH_LOAD)
  return functions;
}

Result<InstanceFunctions> load_instance_functions(PFN_vkGetInstanceProcAddr entry, VkInstance instance) {
  const auto load = [&](const char* name) { return entry(instance, name); };
  InstanceFunctions functions;
  VKMESH_INSTANCE_FUNCTIONS(VKMESH_LOAD)
  functions.vkCreateDebugUtilsMessengerEXT =
      reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(load("vkCreateDebugUtilsMessengerEXT"));
  functions.vkDestroyDebugUtilsMessengerEXT =
      reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(load("vkDestroyDebugUtilsMessengerEXT"));
  functions.vkSetDebugUtilsObjectNameEXT =
      reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(load("vkSetDebugUtilsObjectNameEXT"));
  return functions;
}

#undef VKMESH_LOAD

Result<VolkDeviceTable> load_device_functions(const InstanceFunctions& instance, VkDevice device) {
  VolkDeviceTable functions{};
  {
    const std::lock_guard lock(volk_mutex);
    vkmesh_load_device_table(instance.vkGetDeviceProcAddr, device, &functions);
  }
#define VKMESH_REQUIRE(name) \
  if (functions.name == nullptr) return missing(#name);
  VKMESH_DEVICE_FUNCTIONS(VKMESH_REQUIRE)
#undef VKMESH_REQUIRE
  return functions;
}

std::string name_of(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "VK_ERROR_OUT_OF_HOST_MEMORY";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "VK_ERROR_INITIALIZATION_FAILED";
    case VK_ERROR_DEVICE_LOST:
      return "VK_ERROR_DEVICE_LOST";
    case VK_ERROR_MEMORY_MAP_FAILED:
      return "VK_ERROR_MEMORY_MAP_FAILED";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "VK_ERROR_LAYER_NOT_PRESENT";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "VK_ERROR_EXTENSION_NOT_PRESENT";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "VK_ERROR_FEATURE_NOT_PRESENT";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "VK_ERROR_INCOMPATIBLE_DRIVER";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "VK_ERROR_TOO_MANY_OBJECTS";
    default:
      return "VkResult " + std::to_string(static_cast<int>(result));
  }
}

tl::unexpected<Error> vulkan_failure(VkResult result, const std::string& what) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return fail(ErrorCode::kOutOfMemory, what + ": host memory ran out");
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return fail(ErrorCode::kOutOfMemory, what + ": device memory ran out");
    case VK_ERROR_DEVICE_LOST:
      return fail(ErrorCode::kNoDevice, what + ": the device was lost");
    default:
      return fail(ErrorCode::kInternal, what + ": " + name_of(result));
  }
}

}  // namespace vkmesh::detail
