// The Vulkan functions that the engine calls, held by each context: no global function pointers, so that
// several contexts, and a program with a loader of its own, live side by side. Those of a device stand in
// volk's table; for those before it volk has only global variables.
#pragma once

#include <string>

#include <vkmesh/base/result.h>

#include "core/volk_tables.h"

namespace vkmesh::detail {

#define VKMESH_LOADER_FUNCTIONS(X)          \
  X(vkCreateInstance)                       \
  X(vkEnumerateInstanceExtensionProperties) \
  X(vkEnumerateInstanceLayerProperties)

#define VKMESH_INSTANCE_FUNCTIONS(X)     \
  X(vkCreateDevice)                      \
  X(vkDestroyInstance)                   \
  X(vkEnumeratePhysicalDevices)          \
  X(vkGetDeviceProcAddr)                 \
  X(vkGetPhysicalDeviceFeatures2)        \
  X(vkGetPhysicalDeviceFormatProperties) \
  X(vkGetPhysicalDeviceMemoryProperties) \
  X(vkGetPhysicalDeviceProperties)       \
  X(vkGetPhysicalDeviceProperties2)      \
  X(vkGetPhysicalDeviceQueueFamilyProperties)

// What a device must have, as members of volk's table.
#define VKMESH_DEVICE_FUNCTIONS(X)  \
  X(vkAllocateCommandBuffers)       \
  X(vkAllocateDescriptorSets)       \
  X(vkAllocateMemory)               \
  X(vkBeginCommandBuffer)           \
  X(vkBindBufferMemory)             \
  X(vkBindImageMemory)              \
  X(vkCmdBeginRenderPass)           \
  X(vkCmdBindDescriptorSets)        \
  X(vkCmdBindIndexBuffer)           \
  X(vkCmdBindPipeline)              \
  X(vkCmdBindVertexBuffers)         \
  X(vkCmdCopyBuffer)                \
  X(vkCmdCopyImageToBuffer)         \
  X(vkCmdDispatch)                  \
  X(vkCmdDraw)                      \
  X(vkCmdDrawIndexed)               \
  X(vkCmdEndRenderPass)             \
  X(vkCmdPipelineBarrier)           \
  X(vkCmdPushConstants)             \
  X(vkCmdResetQueryPool)            \
  X(vkCmdSetScissor)                \
  X(vkCmdSetViewport)               \
  X(vkCmdUpdateBuffer)              \
  X(vkCmdWriteTimestamp)            \
  X(vkCreateBuffer)                 \
  X(vkCreateCommandPool)            \
  X(vkCreateComputePipelines)       \
  X(vkCreateDescriptorPool)         \
  X(vkCreateDescriptorSetLayout)    \
  X(vkCreateFence)                  \
  X(vkCreateFramebuffer)            \
  X(vkCreateGraphicsPipelines)      \
  X(vkCreateImage)                  \
  X(vkCreateImageView)              \
  X(vkCreatePipelineLayout)         \
  X(vkCreateQueryPool)              \
  X(vkCreateRenderPass)             \
  X(vkCreateShaderModule)           \
  X(vkDestroyBuffer)                \
  X(vkDestroyCommandPool)           \
  X(vkDestroyDescriptorPool)        \
  X(vkDestroyDescriptorSetLayout)   \
  X(vkDestroyDevice)                \
  X(vkDestroyFence)                 \
  X(vkDestroyFramebuffer)           \
  X(vkDestroyImage)                 \
  X(vkDestroyImageView)             \
  X(vkDestroyPipeline)              \
  X(vkDestroyPipelineLayout)        \
  X(vkDestroyQueryPool)             \
  X(vkDestroyRenderPass)            \
  X(vkDestroyShaderModule)          \
  X(vkEndCommandBuffer)             \
  X(vkFlushMappedMemoryRanges)      \
  X(vkFreeMemory)                   \
  X(vkGetBufferDeviceAddress)       \
  X(vkGetBufferMemoryRequirements)  \
  X(vkGetDeviceQueue)               \
  X(vkGetImageMemoryRequirements)   \
  X(vkGetQueryPoolResults)          \
  X(vkInvalidateMappedMemoryRanges) \
  X(vkMapMemory)                    \
  X(vkQueueSubmit)                  \
  X(vkWaitForFences)

#define VKMESH_MEMBER(name) PFN_##name name = nullptr;

struct LoaderFunctions {
  PFN_vkGetInstanceProcAddr vkGetInstanceProcAddr = nullptr;
  PFN_vkEnumerateInstanceVersion vkEnumerateInstanceVersion = nullptr;  // absent from Vulkan 1.0
  VKMESH_LOADER_FUNCTIONS(VKMESH_MEMBER)
};

struct InstanceFunctions {
  VKMESH_INSTANCE_FUNCTIONS(VKMESH_MEMBER)
  // VK_EXT_debug_utils: null in an instance without it. Those of the engine's own have it with validation.
  PFN_vkCreateDebugUtilsMessengerEXT vkCreateDebugUtilsMessengerEXT = nullptr;
  PFN_vkDestroyDebugUtilsMessengerEXT vkDestroyDebugUtilsMessengerEXT = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT vkSetDebugUtilsObjectNameEXT = nullptr;
};

#undef VKMESH_MEMBER

/// `entry` null: the system's loader. Errors: kNoDevice without one.
[[nodiscard]] Result<LoaderFunctions> load_loader_functions(PFN_vkGetInstanceProcAddr entry);
[[nodiscard]] Result<InstanceFunctions> load_instance_functions(PFN_vkGetInstanceProcAddr entry,
                                                                VkInstance instance);
[[nodiscard]] Result<VolkDeviceTable> load_device_functions(const InstanceFunctions& functions,
                                                            VkDevice device);

/// "VK_ERROR_DEVICE_LOST", or the number.
[[nodiscard]] std::string name_of(VkResult result);

/// The error for a Vulkan call that failed: kOutOfMemory, kNoDevice for a lost device, else kInternal.
[[nodiscard]] tl::unexpected<Error> vulkan_failure(VkResult result, const std::string& what);

}  // namespace vkmesh::detail

/// Returns the error of a Vulkan call that did not succeed. `what` says what was being done.
#define VKMESH_VK(call, what)                                                                            \
  do {                                                                                                   \
    const VkResult vkmesh_vk_result = (call);                                                            \
    if (vkmesh_vk_result != VK_SUCCESS) return ::vkmesh::detail::vulkan_failure(vkmesh_vk_result, what); \
  } while (false)
