#include "draw/image.h"

#include <optional>
#include <utility>

#include "core/device.h"

namespace vkmesh::detail {
namespace {

/// Device-local memory where the image can lie in it.
std::optional<std::uint32_t> memory_type(const VkPhysicalDeviceMemoryProperties& properties,
                                         std::uint32_t allowed) {
  for (const VkMemoryPropertyFlags wanted : {VkMemoryPropertyFlags{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT}, 0u})
    for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i)
      if (((allowed >> i) & 1u) != 0 && (properties.memoryTypes[i].propertyFlags & wanted) == wanted)
        return i;
  return std::nullopt;
}

}  // namespace

Result<Image> Image::create(Context& context, std::uint32_t width, std::uint32_t height,
                            const ImageKind& kind, const std::string& name) {
  Device& device = context.device();
  const auto& vk = device.functions;
  const std::string what = "making the image '" + name + "'";
  Image image;
  image.device_ = context.shared_device();

  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = kind.format;
  info.extent = {width, height, 1};
  info.mipLevels = 1;
  info.arrayLayers = 1;
  info.samples = kind.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = kind.usage;
  info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  VKMESH_VK(vk.vkCreateImage(device.handle, &info, nullptr, &image.image_), what);
  device.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(image.image_), name);

  VkMemoryRequirements needs;
  vk.vkGetImageMemoryRequirements(device.handle, image.image_, &needs);
  const auto type = memory_type(device.memory, needs.memoryTypeBits);
  if (!type) return fail(ErrorCode::kNoDevice, what + ": the device has no memory of this kind");
  const std::uint64_t held = device.allocated.load();
  // As for buffers: drivers in software promise more than there is.
  const bool fits = needs.size <= device.max_allocation && held <= device.info.memory &&
                    needs.size <= device.info.memory - held;
  const VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, *type};
  const VkResult allocated = fits ? vk.vkAllocateMemory(device.handle, &allocation, nullptr, &image.memory_)
                                  : VK_ERROR_OUT_OF_DEVICE_MEMORY;
  if (allocated == VK_ERROR_OUT_OF_DEVICE_MEMORY || allocated == VK_ERROR_OUT_OF_HOST_MEMORY)
    return fail(ErrorCode::kOutOfMemory, "device memory ran out: image '" + name + "' of " +
                                             std::to_string(width) + " by " + std::to_string(height) +
                                             " pixels needs " + std::to_string(needs.size) +
                                             " bytes beside the " + std::to_string(held) + " in use");
  VKMESH_VK(allocated, what);
  image.allocated_ = needs.size;
  device.allocated += needs.size;
  VKMESH_VK(vk.vkBindImageMemory(device.handle, image.image_, image.memory_, 0), what);

  VkImageViewCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view.image = image.image_;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = kind.format;
  view.subresourceRange = {kind.aspect, 0, 1, 0, 1};
  VKMESH_VK(vk.vkCreateImageView(device.handle, &view, nullptr, &image.view_), what);
  return image;
}

Image::Image(Image&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      image_(std::exchange(other.image_, VK_NULL_HANDLE)),
      view_(std::exchange(other.view_, VK_NULL_HANDLE)),
      memory_(std::exchange(other.memory_, VK_NULL_HANDLE)),
      allocated_(std::exchange(other.allocated_, 0)) {}

Image& Image::operator=(Image&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(image_, other.image_);
  std::swap(view_, other.view_);
  std::swap(memory_, other.memory_);
  std::swap(allocated_, other.allocated_);
  return *this;
}

Image::~Image() {
  if (device_ == nullptr || device_->abandoned.load()) return;  // the device may still be using it
  device_->functions.vkDestroyImageView(device_->handle, view_, nullptr);
  device_->functions.vkDestroyImage(device_->handle, image_, nullptr);
  device_->functions.vkFreeMemory(device_->handle, memory_, nullptr);
  device_->allocated -= allocated_;
}

}  // namespace vkmesh::detail
