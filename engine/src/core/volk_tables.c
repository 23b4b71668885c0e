// volk, whose variables and functions bear names of our own here (engine/CMakeLists.txt makes volk_names.h),
// so that a program may link volk or the Vulkan loader beside this library.
// clang-format off
#include "volk_names.h"
#include <volk.c>
// clang-format on

#include "core/volk_tables.h"

PFN_vkGetInstanceProcAddr vkmesh_open_loader(void) {
  return volkInitialize() == VK_SUCCESS ? vkGetInstanceProcAddr : NULL;
}

void vkmesh_load_device_table(PFN_vkGetDeviceProcAddr entry, VkDevice device, struct VolkDeviceTable* table) {
  vkGetDeviceProcAddr = entry;
  volkLoadDeviceTable(table, device);
}
