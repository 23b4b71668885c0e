#include "core/device.h"

#include <algorithm>
#include <cstring>

#include <vkmesh/base/exceptions_to_result.h>

#include "core/spirv.h"

namespace vkmesh::detail {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                              const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
  static_cast<MessageLog*>(log)->add(data->pMessage);
  return VK_FALSE;
}

Result<bool> has_validation_layer(const LoaderFunctions& loader) {
  std::uint32_t count = 0;
  VKMESH_VK(loader.vkEnumerateInstanceLayerProperties(&count, nullptr), "listing the Vulkan layers");
  std::vector<VkLayerProperties> layers(count);
  VKMESH_VK(loader.vkEnumerateInstanceLayerProperties(&count, layers.data()), "listing the Vulkan layers");
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& l) {
    return std::strcmp(l.layerName, kValidationLayer) == 0;
  });
}

}  // namespace

void MessageLog::add(const char* message) noexcept {
  // Runs inside a driver's call stack, where no exception may pass. A message that no memory is left for is
  // dropped.
  try {
    const std::lock_guard lock(mutex_);
    messages_.emplace_back(message);
    if (listener_) listener_(messages_.back());
  } catch (...) {
  }
}

std::vector<std::string> MessageLog::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

Result<std::unique_ptr<Instance>> Instance::create(const ContextOptions& options) {
  std::unique_ptr<Instance> instance(new Instance);
  VKMESH_TRY(instance->loader, load_loader_functions(options.get_instance_proc_addr));
  const LoaderFunctions& loader = instance->loader;
  if (loader.vkEnumerateInstanceVersion == nullptr)
    return fail(ErrorCode::kNoDevice, "the Vulkan loader is of version 1.0; the engine needs 1.1 or later");

  VkApplicationInfo application{
      VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, nullptr, 0, "vkmesh", 0, required_api_version()};
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;

  VkDebugUtilsMessengerCreateInfoEXT messenger{};
  VkValidationFeaturesEXT validation{};
  const VkValidationFeatureEnableEXT enabled[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,
      VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT,
      VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT};
  const char* const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
  if (options.validation) {
    VKMESH_TRY(const bool available, has_validation_layer(loader));
    if (!available)
      return fail(ErrorCode::kNoDevice, std::string("validation needs the layer ") + kValidationLayer +
                                            " (Debian's package vulkan-validationlayers)");
    instance->messages = std::make_unique<MessageLog>(options.on_validation_message);
    messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = on_message;
    messenger.pUserData = instance->messages.get();
    validation.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    validation.pNext = &messenger;  // so that messages on the instance itself are heard
    validation.enabledValidationFeatureCount = options.gpu_assisted_validation ? 3 : 1;
    validation.pEnabledValidationFeatures = enabled;
    info.pNext = &validation;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = extensions;
  }

  const VkResult created = loader.vkCreateInstance(&info, nullptr, &instance->handle);
  if (created == VK_ERROR_INCOMPATIBLE_DRIVER)
    return fail(
        ErrorCode::kNoDevice,
        "no Vulkan driver is installed that fits this machine (Debian's mesa-vulkan-drivers has one in "
        "software)");
  if (created != VK_SUCCESS) {
    instance->handle = VK_NULL_HANDLE;
    tl::unexpected<Error> failure = vulkan_failure(created, "making a Vulkan instance");
    if (failure.value().code == ErrorCode::kInternal) failure.value().code = ErrorCode::kNoDevice;
    return failure;
  }
  VKMESH_TRY(instance->functions, load_instance_functions(loader.vkGetInstanceProcAddr, instance->handle));
  if (options.validation && instance->functions.vkCreateDebugUtilsMessengerEXT != nullptr)
    VKMESH_VK(instance->functions.vkCreateDebugUtilsMessengerEXT(instance->handle, &messenger, nullptr,
                                                                 &instance->messenger_),
              "making a debug messenger");
  return instance;
}

Instance::~Instance() {
  if (messenger_ != VK_NULL_HANDLE) functions.vkDestroyDebugUtilsMessengerEXT(handle, messenger_, nullptr);
  if (handle == VK_NULL_HANDLE) return;
  // Where loading the functions failed this one may still be there.
  const auto destroy =
      reinterpret_cast<PFN_vkDestroyInstance>(loader.vkGetInstanceProcAddr(handle, "vkDestroyInstance"));
  if (destroy != nullptr) destroy(handle, nullptr);
}

Device::Device(const InstanceFunctions& instance_functions_, const ContextOptions& context_options)
    : instance_functions(instance_functions_), options(context_options) {}

Device::~Device() {
  if (abandoned.load()) {
    // Destroying what the device may still use is undefined; letting go of it is not.
    (void)instance.release();
    return;
  }
  for (auto& [name, cached] : kernels_) {
    functions.vkDestroyPipeline(handle, cached.kernel->pipeline_, nullptr);
    functions.vkDestroyPipelineLayout(handle, cached.kernel->layout_, nullptr);
  }
  draw_pipelines_.reset();
  if (adopted || handle == VK_NULL_HANDLE) return;
  const auto destroy = reinterpret_cast<PFN_vkDestroyDevice>(
      instance_functions.vkGetDeviceProcAddr(handle, "vkDestroyDevice"));
  if (destroy != nullptr) destroy(handle, nullptr);
}

Result<void> Device::initialise(const PhysicalDevice& physical) {
  info = physical.info;
  physical_device = physical.handle;
  crashes_on_pointer_bitcasts = physical.crashes_on_pointer_bitcasts;
  VKMESH_TRY(functions, load_device_functions(instance_functions, handle));
  instance_functions.vkGetPhysicalDeviceMemoryProperties(physical_device, &memory);

  VkPhysicalDeviceFloatControlsProperties floats{};
  floats.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FLOAT_CONTROLS_PROPERTIES;
  VkPhysicalDeviceMaintenance3Properties limits{};
  limits.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
  limits.pNext = &floats;
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &limits, {}};
  instance_functions.vkGetPhysicalDeviceProperties2(physical_device, &properties);
  max_allocation = limits.maxMemoryAllocationSize;
  max_groups = properties.properties.limits.maxComputeWorkGroupCount[0];
  max_push_constants = properties.properties.limits.maxPushConstantsSize;
  max_image_side = std::min({properties.properties.limits.maxImageDimension2D,
                             properties.properties.limits.maxFramebufferWidth,
                             properties.properties.limits.maxFramebufferHeight});
  timestamp_nanoseconds = static_cast<double>(properties.properties.limits.timestampPeriod);
  // Where rounding modes of all widths hang together, asking for one of them alone is not allowed.
  rounds_to_nearest_even = floats.shaderRoundingModeRTEFloat32 == VK_TRUE &&
                           floats.roundingModeIndependence != VK_SHADER_FLOAT_CONTROLS_INDEPENDENCE_NONE;
  keeps_signed_zeros = floats.shaderSignedZeroInfNanPreserveFloat32 == VK_TRUE;

  std::uint32_t count = 0;
  instance_functions.vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  instance_functions.vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, families.data());
  if (queue_family >= count || (families[queue_family].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0)
    return fail(ErrorCode::kUsage, "queue family " + std::to_string(queue_family) + " does not compute");
  timestamp_bits = families[queue_family].timestampValidBits;
  draws = (families[queue_family].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0;
  return {};
}

Result<void> Device::submit(const VkSubmitInfo& submit_info, VkFence fence) {
  const std::lock_guard lock(queue_mutex_);
  if (lock_queue) lock_queue();
  const VkResult result = functions.vkQueueSubmit(queue, 1, &submit_info, fence);
  if (unlock_queue) unlock_queue();
  VKMESH_VK(result, "submitting work to " + info.name);
  return {};
}

void Device::set_name(VkObjectType type, std::uint64_t object, const std::string& name) const {
  if (instance_functions.vkSetDebugUtilsObjectNameEXT == nullptr || name.empty()) return;
  const VkDebugUtilsObjectNameInfoEXT name_info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr,
                                                type, object, name.c_str()};
  // A name that was not taken is no loss.
  (void)instance_functions.vkSetDebugUtilsObjectNameEXT(handle, &name_info);
}

Result<const Kernel*> Device::kernel(const KernelSource& source) {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = kernels_.find(source.name);
  if (found != kernels_.end()) {
    const bool same = found->second.spirv == nullptr || found->second.spirv == source.spirv.data();
    if (!same)
      return fail(ErrorCode::kUsage, "two different kernels are named '" + std::string(source.name) + "'");
    return found->second.kernel.get();
  }
  // The place in the map comes first, so that a made pipeline cannot be lost to an allocation that fails.
  const auto [place, inserted] = kernels_.try_emplace(source.name);
  auto made = make_kernel(
      source, {.round_to_nearest_even = rounds_to_nearest_even, .keep_signed_zeros = keeps_signed_zeros});
  if (!made) {
    kernels_.erase(place);
    return tl::unexpected<Error>(std::move(made).error());
  }
  place->second = {source.spirv.data(), *std::move(made)};
  return place->second.kernel.get();
}

Result<void> Device::replace_kernel(const KernelSource& source) {
  const std::lock_guard lock(kernels_mutex_);
  if (kernels_.contains(source.name))
    return fail(ErrorCode::kUsage, "the kernel '" + std::string(source.name) + "' was made already");
  CachedKernel& place = kernels_[source.name];
  VKMESH_TRY(place.kernel, make_kernel(source, {}));
  return {};
}

Result<std::unique_ptr<Kernel>> Device::make_kernel(const KernelSource& source,
                                                    const FloatControls& controls) const {
  VKMESH_TRY(const SpirvKernel shader, inspect_spirv(source.spirv));
  const std::string what = "making kernel '" + std::string(source.name) + "'";
  // A struct ends on a multiple of its alignment, which the shader's last member need not reach.
  const std::uint32_t push_constant_bytes = (shader.push_constant_bytes + 7) / 8 * 8;
  if (push_constant_bytes < 8 || push_constant_bytes > max_push_constants)
    return fail(ErrorCode::kUsage, what + ": " + std::to_string(push_constant_bytes) +
                                       " bytes of push constants are outside [8, " +
                                       std::to_string(max_push_constants) + "]");
  if (shader.bitcasts_pointers && crashes_on_pointer_bitcasts)
    return fail(ErrorCode::kNoDevice,
                what + ": its SPIR-V bitcasts a pointer to a pointer, on which the driver of " + info.name +
                    " crashes; in GLSL, convert one buffer reference to another by way of a "
                    "uvec2 (GL_EXT_buffer_reference_uvec2)");

  const std::vector<std::uint32_t> spirv = with_float_controls(source.spirv, controls);
  auto kernel = std::make_unique<Kernel>();
  kernel->name_ = source.name;
  kernel->push_constant_bytes_ = push_constant_bytes;
  kernel->workgroup_size_ = shader.workgroup_size;

  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = spirv.size() * sizeof(std::uint32_t);
  module_info.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  VKMESH_VK(functions.vkCreateShaderModule(handle, &module_info, nullptr, &module), what);

  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_constant_bytes};
  VkPipelineLayoutCreateInfo layout_info{};
  layout_info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout_info.pushConstantRangeCount = 1;
  layout_info.pPushConstantRanges = &range;
  VkResult result = functions.vkCreatePipelineLayout(handle, &layout_info, nullptr, &kernel->layout_);
  if (result == VK_SUCCESS) {
    VkComputePipelineCreateInfo pipeline_info{};
    pipeline_info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    pipeline_info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    pipeline_info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    pipeline_info.stage.module = module;
    pipeline_info.stage.pName = shader.entry_point.c_str();
    pipeline_info.layout = kernel->layout_;
    result = functions.vkCreateComputePipelines(handle, VK_NULL_HANDLE, 1, &pipeline_info, nullptr,
                                                &kernel->pipeline_);
    if (result != VK_SUCCESS) functions.vkDestroyPipelineLayout(handle, kernel->layout_, nullptr);
  }
  functions.vkDestroyShaderModule(handle, module, nullptr);
  VKMESH_VK(result, what);
  set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(kernel->pipeline_), kernel->name_);
  return kernel;
}

}  // namespace vkmesh::detail
