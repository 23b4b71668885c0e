#include "core/fake_loader.h"

#include <cstring>

#include "core/vulkan_functions.h"
#include "support/device.h"

namespace vkmesh::test {
namespace {

// Vulkan hands its entry points no user data, so the fake in force is found here.
FakeLoader* current = nullptr;
VkInstance last_instance = VK_NULL_HANDLE;

}  // namespace

PFN_vkGetInstanceProcAddr system_loader() {
  static const auto loaded = detail::load_loader_functions(nullptr);
  return loaded ? loaded->vkGetInstanceProcAddr : nullptr;
}

FakeLoader::FakeLoader() {
  current = this;
}

FakeLoader::~FakeLoader() {
  current = nullptr;
  last_instance = VK_NULL_HANDLE;
}

ContextOptions FakeLoader::options() const {
  ContextOptions options = device_options();
  options.get_instance_proc_addr = entry;
  return options;
}

PFN_vkVoidFunction FakeLoader::entry(VkInstance instance, const char* name) {
  if (instance != VK_NULL_HANDLE) last_instance = instance;
  const auto found = current->replaced_.find(name);
  if (found != current->replaced_.end()) return found->second;
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(device_entry);
  return system_loader()(instance, name);
}

PFN_vkVoidFunction FakeLoader::device_entry(VkDevice device, const char* name) {
  const auto found = current->replaced_.find(name);
  if (found != current->replaced_.end()) return found->second;
  return reinterpret_cast<PFN_vkGetDeviceProcAddr>(find_real("vkGetDeviceProcAddr"))(device, name);
}

PFN_vkVoidFunction FakeLoader::find_real(const char* name) {
  return system_loader()(last_instance, name);
}

}  // namespace vkmesh::test
