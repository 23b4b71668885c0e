// Compute shaders, and the pipelines made of them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <vulkan/vulkan_core.h>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/context.h>

namespace vkmesh {

/// SPIR-V of a compute shader that takes all its data by push constants: first two 32-bit counts `first` and
/// `count`, then buffer addresses and numbers. It runs one thread for each element in [first, first + count),
/// in workgroups of one dimension.
struct KernelSource {
  const char* name = "";
  std::span<const std::uint32_t> spirv;  ///< Must stay where it is while the context lives.
};

/// Compute pipeline, made once for a context, which keeps it.
class VKMESH_API Kernel {
 public:
  /// Returns the kernel of that name, made by the first call. May be called from several threads.
  /// Where the device offers it, the SPIR-V is made to ask for rounding to nearest even and for signed zeros,
  /// infinities and NaNs to be kept (VK_KHR_shader_float_controls, core in Vulkan 1.2).
  /// Errors: kUsage for SPIR-V that is no such shader; kNoDevice for SPIR-V that the device's driver is known
  /// to crash on (SwiftShader: an OpBitcast from pointer to pointer); kOutOfMemory.
  [[nodiscard]] static Result<const Kernel*> get(Context& context, const KernelSource& source);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] VkPipeline pipeline() const { return pipeline_; }
  [[nodiscard]] VkPipelineLayout layout() const { return layout_; }
  /// Size of the struct of push constants, rounded up to a multiple of 8.
  [[nodiscard]] std::uint32_t push_constant_bytes() const { return push_constant_bytes_; }
  [[nodiscard]] std::uint32_t workgroup_size() const { return workgroup_size_; }

 private:
  friend class detail::Device;
  std::string name_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  std::uint32_t push_constant_bytes_ = 0;
  std::uint32_t workgroup_size_ = 1;
};

}  // namespace vkmesh
