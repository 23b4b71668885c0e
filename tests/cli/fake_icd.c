// A Vulkan driver that offers one discrete GPU, and fails as the environment variable VKMESH_FAKE_ICD says:
// "crash-listing" and "crash-opening" by a signal, "no-device" by an error when the device is opened.
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vk_icd.h>
#include <vulkan/vulkan_core.h>

static int asked_to(const char* what) {
  const char* asked = getenv("VKMESH_FAKE_ICD");
  return asked != NULL && strcmp(asked, what) == 0;
}

// The loader writes into the first word of each handle.
static VK_LOADER_DATA instance_object = {ICD_LOADER_MAGIC}, gpu_object = {ICD_LOADER_MAGIC};

static VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info,
                                           const VkAllocationCallbacks* allocator, VkInstance* instance) {
  (void)info;
  (void)allocator;
  *instance = (VkInstance)&instance_object;
  return VK_SUCCESS;
}

static void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* allocator) {
  (void)instance;
  (void)allocator;
}

static VkResult VKAPI_CALL no_extensions(const char* layer, uint32_t* count,
                                         VkExtensionProperties* extensions) {
  (void)layer;
  (void)extensions;
  *count = 0;
  return VK_SUCCESS;
}

static VkResult VKAPI_CALL no_device_extensions(VkPhysicalDevice gpu, const char* layer, uint32_t* count,
                                                VkExtensionProperties* extensions) {
  (void)gpu;
  return no_extensions(layer, count, extensions);
}

static VkResult VKAPI_CALL api_version(uint32_t* version) {
  *version = VK_API_VERSION_1_2;
  return VK_SUCCESS;
}

static VkResult VKAPI_CALL list_gpus(VkInstance instance, uint32_t* count, VkPhysicalDevice* gpus) {
  (void)instance;
  if (asked_to("crash-listing")) raise(SIGSEGV);
  if (gpus != NULL && *count > 0) gpus[0] = (VkPhysicalDevice)&gpu_object;
  *count = 1;
  return VK_SUCCESS;
}

static void VKAPI_CALL get_properties(VkPhysicalDevice gpu, VkPhysicalDeviceProperties* properties) {
  (void)gpu;
  memset(properties, 0, sizeof *properties);
  properties->apiVersion = VK_API_VERSION_1_2;
  properties->deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
  strcpy(properties->deviceName, "Fake GPU");
}

static void VKAPI_CALL get_properties2(VkPhysicalDevice gpu, VkPhysicalDeviceProperties2* properties) {
  get_properties(gpu, &properties->properties);
}

static void VKAPI_CALL get_features(VkPhysicalDevice gpu, VkPhysicalDeviceFeatures* features) {
  (void)gpu;
  memset(features, 0, sizeof *features);
}

static void VKAPI_CALL get_features2(VkPhysicalDevice gpu, VkPhysicalDeviceFeatures2* features) {
  get_features(gpu, &features->features);
  for (VkBaseOutStructure* next = features->pNext; next != NULL; next = next->pNext)
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES)
      ((VkPhysicalDeviceVulkan12Features*)next)->bufferDeviceAddress = VK_TRUE;
}

static void VKAPI_CALL get_memory(VkPhysicalDevice gpu, VkPhysicalDeviceMemoryProperties* memory) {
  (void)gpu;
  memset(memory, 0, sizeof *memory);
}

static void VKAPI_CALL get_families(VkPhysicalDevice gpu, uint32_t* count,
                                    VkQueueFamilyProperties* families) {
  (void)gpu;
  if (families != NULL && *count > 0) {
    memset(families, 0, sizeof *families);
    families->queueFlags = VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT;
    families->queueCount = 1;
  }
  *count = 1;
}

static VkResult VKAPI_CALL create_device(VkPhysicalDevice gpu, const VkDeviceCreateInfo* info,
                                         const VkAllocationCallbacks* allocator, VkDevice* device) {
  (void)gpu;
  (void)info;
  (void)allocator;
  (void)device;
  if (asked_to("crash-opening")) raise(SIGILL);
  return VK_ERROR_INITIALIZATION_FAILED;
}

static PFN_vkVoidFunction VKAPI_CALL get_device_proc(VkDevice device, const char* name) {
  (void)device;
  (void)name;
  return NULL;
}

// The loader asks for these as well, and nobody calls them.
static void VKAPI_CALL not_called(void) {
  abort();
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vk_icdGetInstanceProcAddr(VkInstance instance, const char* name) {
  static const struct {
    const char* name;
    PFN_vkVoidFunction function;
  } functions[] = {
      {"vkCreateInstance", (PFN_vkVoidFunction)create_instance},
      {"vkDestroyInstance", (PFN_vkVoidFunction)destroy_instance},
      {"vkEnumerateInstanceExtensionProperties", (PFN_vkVoidFunction)no_extensions},
      {"vkEnumerateInstanceVersion", (PFN_vkVoidFunction)api_version},
      {"vkEnumerateDeviceExtensionProperties", (PFN_vkVoidFunction)no_device_extensions},
      {"vkEnumeratePhysicalDevices", (PFN_vkVoidFunction)list_gpus},
      {"vkGetPhysicalDeviceProperties", (PFN_vkVoidFunction)get_properties},
      {"vkGetPhysicalDeviceProperties2", (PFN_vkVoidFunction)get_properties2},
      {"vkGetPhysicalDeviceFeatures", (PFN_vkVoidFunction)get_features},
      {"vkGetPhysicalDeviceFeatures2", (PFN_vkVoidFunction)get_features2},
      {"vkGetPhysicalDeviceMemoryProperties", (PFN_vkVoidFunction)get_memory},
      {"vkGetPhysicalDeviceQueueFamilyProperties", (PFN_vkVoidFunction)get_families},
      {"vkGetPhysicalDeviceFormatProperties", not_called},
      {"vkGetPhysicalDeviceImageFormatProperties", not_called},
      {"vkGetPhysicalDeviceSparseImageFormatProperties", not_called},
      {"vkCreateDevice", (PFN_vkVoidFunction)create_device},
      {"vkGetDeviceProcAddr", (PFN_vkVoidFunction)get_device_proc},
  };
  (void)instance;
  for (size_t i = 0; i < sizeof functions / sizeof *functions; ++i)
    if (strcmp(functions[i].name, name) == 0) return functions[i].function;
  return NULL;
}

VKAPI_ATTR VkResult VKAPI_CALL vk_icdNegotiateLoaderICDInterfaceVersion(uint32_t* version) {
  if (*version > 5) *version = 5;
  return VK_SUCCESS;
}
