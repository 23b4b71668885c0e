#include <algorithm>
#include <cctype>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/recorder.h>

#include "core/device.h"
#include "core/fake_loader.h"
#include "support/device.h"

namespace vkmesh::test {
namespace {

using Catch::Contains;

Error error_of(const ContextOptions& options) {
  const auto context = Context::create(options);
  if (context) FAIL("a context was made on " << (*context)->info().name);
  return context.error();
}

/// Copies a few bytes from one buffer to another on the device.
void require_works(Context& context) {
  const std::vector<std::uint32_t> values = {1, 2, 3, 4, 5};
  auto from = Buffer::create(context, 20);
  auto to = Buffer::create(context, 20);
  REQUIRE(from);
  REQUIRE(to);
  REQUIRE(from->upload(std::as_bytes(std::span(values))));
  auto recorder = Recorder::create(context);
  REQUIRE(recorder);
  REQUIRE(recorder->copy(*from, *to, 20));
  REQUIRE(recorder->submit_and_wait());
  std::vector<std::uint32_t> copied(5);
  REQUIRE(to->download(std::as_writable_bytes(std::span(copied))));
  CHECK(copied == values);
}

// Replacements for Vulkan functions. Each asks the real one for what it does not change.

void VKAPI_PTR properties_of_software(VkPhysicalDevice device, VkPhysicalDeviceProperties* properties) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(device, properties);
  properties->deviceType = VK_PHYSICAL_DEVICE_TYPE_CPU;
}

void VKAPI_PTR properties_of_gpu(VkPhysicalDevice device, VkPhysicalDeviceProperties* properties) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(device, properties);
  properties->deviceType = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
}

void VKAPI_PTR properties_of_old_device(VkPhysicalDevice device, VkPhysicalDeviceProperties* properties) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(device, properties);
  properties->apiVersion = VK_API_VERSION_1_1;
}

void VKAPI_PTR features_without_addresses(VkPhysicalDevice device, VkPhysicalDeviceFeatures2* features) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceFeatures2>("vkGetPhysicalDeviceFeatures2")(device, features);
  static_cast<VkPhysicalDeviceVulkan12Features*>(features->pNext)->bufferDeviceAddress = VK_FALSE;
}

void VKAPI_PTR families_without_compute(VkPhysicalDevice device, std::uint32_t* count,
                                        VkQueueFamilyProperties* families) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceQueueFamilyProperties>("vkGetPhysicalDeviceQueueFamilyProperties")(
      device, count, families);
  for (std::uint32_t i = 0; families != nullptr && i < *count; ++i)
    families[i].queueFlags = VK_QUEUE_TRANSFER_BIT;
}

VkResult VKAPI_PTR no_devices(VkInstance, std::uint32_t* count, VkPhysicalDevice*) {
  *count = 0;
  return VK_SUCCESS;
}

VkResult VKAPI_PTR no_layers(std::uint32_t* count, VkLayerProperties*) {
  *count = 0;
  return VK_SUCCESS;
}

VkResult VKAPI_PTR no_driver(const VkInstanceCreateInfo*, const VkAllocationCallbacks*, VkInstance*) {
  return VK_ERROR_INCOMPATIBLE_DRIVER;
}

VkResult VKAPI_PTR device_fails(VkPhysicalDevice, const VkDeviceCreateInfo*, const VkAllocationCallbacks*,
                                VkDevice*) {
  return VK_ERROR_INITIALIZATION_FAILED;
}

VkResult VKAPI_PTR device_has_no_memory(VkPhysicalDevice, const VkDeviceCreateInfo*,
                                        const VkAllocationCallbacks*, VkDevice*) {
  return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

VkResult VKAPI_PTR allocation_fails(VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*,
                                    VkDeviceMemory*) {
  return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

VkResult VKAPI_PTR bind_fails(VkDevice, VkBuffer, VkDeviceMemory, VkDeviceSize) {
  return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

VkResult VKAPI_PTR submit_loses_device(VkQueue, std::uint32_t, const VkSubmitInfo*, VkFence) {
  return VK_ERROR_DEVICE_LOST;
}

/// Turns each constant 2.0 of a shader, Newton's for the reciprocal, into 2.5.
VkResult VKAPI_PTR module_of_a_bad_device(VkDevice device, const VkShaderModuleCreateInfo* info,
                                          const VkAllocationCallbacks* allocator, VkShaderModule* module) {
  std::vector<std::uint32_t> words(info->pCode, info->pCode + info->codeSize / 4);
  std::replace(words.begin(), words.end(), 0x40000000u, 0x40200000u);
  VkShaderModuleCreateInfo changed = *info;
  changed.pCode = words.data();
  return FakeLoader::real<PFN_vkCreateShaderModule>("vkCreateShaderModule")(device, &changed, allocator,
                                                                            module);
}

/// Names that were given to objects.
std::vector<std::string> names_given;

VkResult VKAPI_PTR note_name(VkDevice, const VkDebugUtilsObjectNameInfoEXT* info) {
  names_given.emplace_back(info->pObjectName);
  return VK_SUCCESS;
}

/// An instance and a device as a program of its own would make them.
struct OwnDevice {
  AdoptedDevice handles;
  std::unique_ptr<detail::Instance> instance;
  PFN_vkDestroyDevice destroy = nullptr;

  explicit OwnDevice(const ContextOptions& options = device_options()) {
    auto made = detail::Instance::create(options);
    REQUIRE(made);
    instance = *std::move(made);
    const auto& vki = instance->functions;
    const auto devices = detail::physical_devices(vki, instance->handle);
    REQUIRE(devices);
    const auto physical = detail::choose(*devices, device_name());
    REQUIRE(physical);
    const float priority = 0.5f;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = physical->queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    const VkPhysicalDeviceVulkan12Features features = required_features();
    VkDeviceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &features;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    handles.instance = instance->handle;
    handles.physical_device = physical->handle;
    handles.queue_family = physical->queue_family;
    handles.get_instance_proc_addr = system_loader();
    REQUIRE(vki.vkCreateDevice(physical->handle, &info, nullptr, &handles.device) == VK_SUCCESS);
    const auto functions = detail::load_device_functions(vki, handles.device);
    REQUIRE(functions);
    destroy = functions->vkDestroyDevice;
    functions->vkGetDeviceQueue(handles.device, handles.queue_family, 0, &handles.queue);
  }
  ~OwnDevice() {
    if (handles.device != VK_NULL_HANDLE) destroy(handles.device, nullptr);
  }
};

}  // namespace

TEST_CASE("a device is described") {
  const auto devices = list_devices();
  REQUIRE(devices);
  const DeviceInfo& info = test_context().info();
  REQUIRE(info.index < devices->size());
  const DeviceInfo& listed = (*devices)[info.index];
  CHECK(listed.name == info.name);
  CHECK(listed.usable);
  CHECK(listed.rejected.empty());
  CHECK(listed.driver == info.driver);
  CHECK(!listed.driver.empty());
  CHECK(listed.memory > 0);
  CHECK_THAT(listed.api_version, Catch::StartsWith("1."));
}

TEST_CASE("a device is chosen by index, or by a part of its name") {
  const DeviceInfo& wanted = test_context().info();
  ContextOptions options = device_options();
  options.device = std::to_string(wanted.index);
  const auto by_index = Context::create(options);
  REQUIRE(by_index);
  CHECK((*by_index)->info().name == wanted.name);

  options.device = wanted.name;
  std::transform(options.device.begin(), options.device.end(), options.device.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  REQUIRE(options.device != wanted.name);
  const auto by_name = Context::create(options);
  REQUIRE(by_name);
  CHECK((*by_name)->info().name == wanted.name);
}

TEST_CASE("a request that nothing answers names each device and the reason") {
  ContextOptions options = device_options();
  options.device = "no such device";
  const Error by_name = error_of(options);
  CHECK(by_name.code == ErrorCode::kNoDevice);
  CHECK_THAT(by_name.message,
             Contains(test_context().info().name + ": its name does not hold these letters"));
  options.device = "4000";
  const Error by_index = error_of(options);
  CHECK(by_index.code == ErrorCode::kNoDevice);
  CHECK_THAT(by_index.message, Contains("its index is " + std::to_string(test_context().info().index)));
}

TEST_CASE("auto takes a GPU, never software") {
  FakeLoader loader;
  loader.replace("vkGetPhysicalDeviceProperties", properties_of_software);
  ContextOptions options = loader.options();
  options.device = "auto";
  const Error error = error_of(options);
  CHECK(error.code == ErrorCode::kNoDevice);
  CHECK_THAT(error.message, Contains("it is software"));

  loader.replace("vkGetPhysicalDeviceProperties", properties_of_gpu);
  const auto context = Context::create(options);
  REQUIRE(context);
  CHECK((*context)->info().type == DeviceType::kIntegratedGpu);
}

TEST_CASE("two contexts work side by side, also in two threads") {
  auto first = Context::create(device_options());
  auto second = Context::create(device_options());
  REQUIRE(first);
  REQUIRE(second);
  require_works(**first);
  require_works(**second);
  first->reset();
  require_works(**second);

  std::string errors[2];
  std::vector<std::thread> threads;
  for (std::string& error : errors)
    threads.emplace_back([&error] {
      for (int i = 0; i < 3; ++i) {
        const auto context = Context::create(device_options());
        if (!context) error = context.error().describe();
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(errors[0].empty());
  CHECK(errors[1].empty());
}

TEST_CASE("an adopted device is used under its lock, and left alone") {
  OwnDevice own;
  int locked = 0, depth = 0;
  own.handles.lock_queue = [&] { ++locked, ++depth; };
  own.handles.unlock_queue = [&] { --depth; };
  for (int i = 0; i < 2; ++i) {
    const auto context = Context::adopt(own.handles);
    REQUIRE(context);
    CHECK_THAT((*context)->info().name, Contains(device_name(), Catch::CaseSensitive::No));
    const int before = locked;
    require_works(**context);
    CHECK(locked == before + 1);
    CHECK(depth == 0);
  }
}

TEST_CASE("adopting refuses what is incomplete") {
  OwnDevice own;
  AdoptedDevice handles = own.handles;
  handles.queue = VK_NULL_HANDLE;
  auto context = Context::adopt(handles);
  REQUIRE(!context);
  CHECK(context.error().code == ErrorCode::kUsage);
  handles = own.handles;
  handles.lock_queue = [] {};
  context = Context::adopt(handles);
  REQUIRE(!context);
  CHECK(context.error().code == ErrorCode::kUsage);
  handles = own.handles;
  handles.queue_family = 1000;
  context = Context::adopt(handles);
  REQUIRE(!context);
  CHECK(context.error().code == ErrorCode::kUsage);
}

TEST_CASE("adopting names the version that an instance was made for, or the device's") {
  const OwnDevice own;
  struct Case {
    const char* function;
    PFN_vkVoidFunction replacement;
    ErrorCode code;
    const char* says;
  };
  // What Mesa and the loader do for an instance of 1.1, and later loaders for one of 1.0.
  const Case cases[] = {
      {"vkGetBufferDeviceAddress", nullptr, ErrorCode::kUsage,
       "has it: set VkApplicationInfo::apiVersion to VK_API_VERSION_1_2"},
      {"vkGetPhysicalDeviceFeatures2", nullptr, ErrorCode::kUsage,
       "the adopted instance was made for a version of Vulkan below 1.2"},
      {"vkGetPhysicalDeviceProperties", reinterpret_cast<PFN_vkVoidFunction>(properties_of_old_device),
       ErrorCode::kNoDevice, "cannot be used: it needs Vulkan 1.2.0, has 1.1.0"},
  };
  for (const Case& c : cases) {
    FakeLoader loader;
    loader.replace(c.function, c.replacement);
    AdoptedDevice handles = own.handles;
    handles.get_instance_proc_addr = FakeLoader::entry;
    const auto context = Context::adopt(handles);
    REQUIRE(!context);
    CHECK(context.error().code == c.code);
    CHECK_THAT(context.error().message, Contains(c.says));
  }
}

TEST_CASE("names reach the objects of an adopted device, where its instance takes them") {
  {
    const OwnDevice own;
    FakeLoader loader;
    loader.replace("vkSetDebugUtilsObjectNameEXT", note_name);
    AdoptedDevice handles = own.handles;
    handles.get_instance_proc_addr = FakeLoader::entry;
    const auto context = Context::adopt(handles);
    REQUIRE(context);
    names_given.clear();
    REQUIRE(Buffer::create(**context, 4, BufferMemory::kDevice, "a buffer of the test"));
    CHECK(names_given == std::vector<std::string>{"a buffer of the test"});
  }
  ContextOptions plain = device_options();
  plain.validation = false;
  const OwnDevice unnamed(plain);
  const auto context = Context::adopt(unnamed.handles);
  REQUIRE(context);
  CHECK(Buffer::create(**context, 4, BufferMemory::kDevice, "a buffer of the test"));
}

TEST_CASE("a device whose arithmetic differs is refused by name") {
  FakeLoader loader;
  loader.replace("vkCreateShaderModule", module_of_a_bad_device);
  ContextOptions options = loader.options();
  const Error error = error_of(options);
  CHECK(error.code == ErrorCode::kNoDevice);
  CHECK_THAT(error.message, Contains(test_context().info().name));
  CHECK_THAT(error.message, Contains("computes reciprocal otherwise than the host"));
  options.skip_exactness_check = true;
  CHECK(Context::create(options));
}

TEST_CASE("what Vulkan refuses becomes an error that says so") {
  struct Case {
    const char* function;
    PFN_vkVoidFunction replacement;
    ErrorCode code;
    const char* says;
  };
  const auto as = [](auto function) { return reinterpret_cast<PFN_vkVoidFunction>(function); };
  const Case cases[] = {
      {"vkEnumeratePhysicalDevices", as(no_devices), ErrorCode::kNoDevice, "mesa-vulkan-drivers"},
      {"vkCreateInstance", as(no_driver), ErrorCode::kNoDevice, "mesa-vulkan-drivers"},
      {"vkCreateInstance", nullptr, ErrorCode::kNoDevice, "lacks vkCreateInstance"},
      {"vkEnumerateInstanceVersion", nullptr, ErrorCode::kNoDevice, "1.0"},
      {"vkEnumerateInstanceLayerProperties", as(no_layers), ErrorCode::kNoDevice, "vulkan-validationlayers"},
      {"vkGetPhysicalDeviceFeatures2", as(features_without_addresses), ErrorCode::kNoDevice,
       ": lacks the feature bufferDeviceAddress"},
      {"vkGetPhysicalDeviceProperties", as(properties_of_old_device), ErrorCode::kNoDevice,
       ": needs Vulkan 1.2.0, has 1.1.0"},
      {"vkGetPhysicalDeviceQueueFamilyProperties", as(families_without_compute), ErrorCode::kNoDevice,
       ": has no queue that computes"},
      {"vkCreateDevice", as(device_fails), ErrorCode::kNoDevice, "VK_ERROR_INITIALIZATION_FAILED"},
      {"vkCreateDevice", as(device_has_no_memory), ErrorCode::kOutOfMemory, "device memory ran out"},
      {"vkQueueSubmit", nullptr, ErrorCode::kNoDevice, "lacks vkQueueSubmit"},
      {"vkAllocateMemory", as(allocation_fails), ErrorCode::kOutOfMemory,
       "buffer 'canary inputs' needs 18432 bytes"},
      {"vkBindBufferMemory", as(bind_fails), ErrorCode::kOutOfMemory, "device memory ran out"},
      {"vkQueueSubmit", as(submit_loses_device), ErrorCode::kNoDevice, "the device was lost"},
  };
  for (const Case& c : cases) {
    FakeLoader loader;
    loader.replace(c.function, c.replacement);
    INFO(c.function);
    const Error error = error_of(loader.options());
    CHECK(error.code == c.code);
    CHECK_THAT(error.message, Contains(c.says));
    // The layer names what was left behind when its instance goes, which fails the run.
  }
}

}  // namespace vkmesh::test
