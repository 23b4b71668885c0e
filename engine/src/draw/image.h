// An image in device memory, with its view.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <vulkan/vulkan_core.h>

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/context.h>

namespace vkmesh::detail {

struct ImageKind {
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  VkImageUsageFlags usage = 0;
  VkImageAspectFlags aspect = 0;
};

/// Moves, does not copy. Counted among the context's memory.
class Image {
 public:
  /// Errors: kOutOfMemory, kNoDevice.
  [[nodiscard]] static Result<Image> create(Context& context, std::uint32_t width, std::uint32_t height,
                                            const ImageKind& kind, const std::string& name);

  Image() = default;
  Image(Image&& other) noexcept;
  Image& operator=(Image&& other) noexcept;
  ~Image();

  [[nodiscard]] VkImage handle() const { return image_; }
  [[nodiscard]] VkImageView view() const { return view_; }

 private:
  std::shared_ptr<Device> device_;
  VkImage image_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::uint64_t allocated_ = 0;
};

}  // namespace vkmesh::detail
