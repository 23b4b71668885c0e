// The render pass and the graphics pipelines of drawing, made once for a device.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include <vulkan/vulkan_core.h>

#include <vkmesh/base/result.h>

namespace vkmesh::detail {

class Device;

enum class DrawShaders : std::uint32_t {
  kIndexed,  ///< Triangles through vertex and index buffers.
  kCorners,  ///< Triangles corner by corner.
  kPoints,
  kLines,
};

/// What a pipeline is made for.
struct DrawPipelineKey {
  DrawShaders shaders = DrawShaders::kIndexed;
  // Specialization constants 0, 1 and 2: see draw_params.h.
  std::uint32_t color_source = 0;
  std::uint32_t edges = 0;
  std::uint32_t show_flipped = 0;

  friend auto operator<=>(const DrawPipelineKey&, const DrawPipelineKey&) = default;
};

class DrawPipelines {
 public:
  static constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_UNORM;
  static constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;

  /// Errors: kNoDevice where the device or its queue cannot draw; kOutOfMemory.
  [[nodiscard]] static Result<std::unique_ptr<DrawPipelines>> create(Device& device);
  ~DrawPipelines();
  DrawPipelines(const DrawPipelines&) = delete;
  DrawPipelines& operator=(const DrawPipelines&) = delete;

  /// Attachments: colour and depth of kSamples, and the resolved colour, which it leaves ready to copy from.
  [[nodiscard]] VkRenderPass render_pass() const { return render_pass_; }
  [[nodiscard]] VkFormat depth_format() const { return depth_format_; }
  /// Binds set 0, a kernels::DrawView.
  [[nodiscard]] VkDescriptorSetLayout set_layout() const { return set_layout_; }
  /// Push constants are a kernels::DrawParams for the vertex and fragment stages.
  [[nodiscard]] VkPipelineLayout layout() const { return layout_; }
  /// Made at the first call; may be called from several threads. Errors: kOutOfMemory, kNoDevice.
  [[nodiscard]] Result<VkPipeline> pipeline(const DrawPipelineKey& key);

 private:
  explicit DrawPipelines(Device& device) : device_(device) {}
  [[nodiscard]] Result<void> make_render_pass();
  [[nodiscard]] Result<void> make_layout();
  [[nodiscard]] Result<void> make_pipeline(const DrawPipelineKey& key, VkPipeline& pipeline) const;

  Device& device_;
  VkFormat depth_format_ = VK_FORMAT_UNDEFINED;
  VkRenderPass render_pass_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  std::mutex mutex_;
  std::map<DrawPipelineKey, VkPipeline> pipelines_;
};

}  // namespace vkmesh::detail
