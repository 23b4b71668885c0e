// What the engine takes from volk. These work on volk's global variables: one thread at a time.
#pragma once

#include <volk.h>

#ifdef __cplusplus
extern "C" {
#endif

/// vkGetInstanceProcAddr of the system's loader, which then stays open; null without one.
PFN_vkGetInstanceProcAddr vkmesh_open_loader(void);

/// What the device lacks is null in the table.
void vkmesh_load_device_table(PFN_vkGetDeviceProcAddr entry, VkDevice device, struct VolkDeviceTable* table);

#ifdef __cplusplus
}
#endif
