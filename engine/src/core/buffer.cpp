#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/core/recorder.h>

#include "core/device.h"

namespace vkmesh {
namespace {

/// Memory properties to ask for, the best first.
std::span<const VkMemoryPropertyFlags> preferences(BufferMemory memory) {
  // Memory of the device is mapped only where the host reads it through its cache: elsewhere staging is
  // faster.
  static constexpr VkMemoryPropertyFlags kDevice[] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                                          VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                                          VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
                                                      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
  static constexpr VkMemoryPropertyFlags kStaging[] = {
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT};
  static constexpr VkMemoryPropertyFlags kReadback[] = {
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT};
  switch (memory) {
    case BufferMemory::kStaging:
      return kStaging;
    case BufferMemory::kReadback:
      return kReadback;
    case BufferMemory::kDevice:
      break;
  }
  return kDevice;
}

std::optional<std::uint32_t> memory_type(const VkPhysicalDeviceMemoryProperties& properties,
                                         std::uint32_t allowed, BufferMemory memory) {
  for (const VkMemoryPropertyFlags wanted : preferences(memory))
    for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i)
      if (((allowed >> i) & 1u) != 0 && (properties.memoryTypes[i].propertyFlags & wanted) == wanted)
        return i;
  return std::nullopt;
}

tl::unexpected<Error> does_not_fit(const std::string& name, std::uint64_t bytes, std::uint64_t held) {
  return fail(ErrorCode::kOutOfMemory, "device memory ran out: buffer '" + name + "' needs " +
                                           std::to_string(bytes) + " bytes beside the " +
                                           std::to_string(held) + " in use");
}

}  // namespace

Result<Buffer> Buffer::create(Context& context, std::uint64_t bytes, BufferMemory memory, const char* name) {
  return detail::catching([&]() -> Result<Buffer> {
    detail::Device& device = context.device();
    const auto& vk = device.functions;
    const std::uint64_t held = device.allocated.load();
    // Drivers in software promise more than there is, and end the process when it is touched: so we count
    // ourselves.
    if (bytes > device.max_allocation ||
        (memory == BufferMemory::kDevice && (held > device.info.memory || bytes > device.info.memory - held)))
      return does_not_fit(name, bytes, held);

    Buffer buffer;
    buffer.device_ = context.shared_device();
    buffer.size_ = bytes;
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    // Kernels load eight bytes at once, and one element even of an empty list: three corners or coordinates.
    info.size = std::max<std::uint64_t>((bytes + 7) / 8 * 8, 16);
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                 VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    const std::string what = "making buffer '" + std::string(name) + "'";
    VKMESH_VK(vk.vkCreateBuffer(device.handle, &info, nullptr, &buffer.buffer_), what);
    device.set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer.buffer_), name);

    VkMemoryRequirements needs;
    vk.vkGetBufferMemoryRequirements(device.handle, buffer.buffer_, &needs);
    const auto type = memory_type(device.memory, needs.memoryTypeBits, memory);
    if (!type) return fail(ErrorCode::kNoDevice, what + ": the device has no memory of this kind");
    const VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO, nullptr,
                                          VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT, 0};
    const VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &flags, needs.size, *type};
    const VkResult allocated = vk.vkAllocateMemory(device.handle, &allocation, nullptr, &buffer.memory_);
    if (allocated == VK_ERROR_OUT_OF_DEVICE_MEMORY || allocated == VK_ERROR_OUT_OF_HOST_MEMORY)
      return does_not_fit(name, bytes, held);
    VKMESH_VK(allocated, what);
    buffer.allocated_ = needs.size;
    device.allocated += needs.size;
    VKMESH_VK(vk.vkBindBufferMemory(device.handle, buffer.buffer_, buffer.memory_, 0), what);

    const VkMemoryPropertyFlags properties = device.memory.memoryTypes[*type].propertyFlags;
    buffer.coherent_ = (properties & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) != 0;
    const bool fast_for_host =
        (properties & VK_MEMORY_PROPERTY_HOST_CACHED_BIT) != 0 && !device.options.force_staging;
    if ((properties & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0 &&
        (memory != BufferMemory::kDevice || fast_for_host)) {
      void* mapped = nullptr;
      VKMESH_VK(vk.vkMapMemory(device.handle, buffer.memory_, 0, VK_WHOLE_SIZE, 0, &mapped), what);
      buffer.mapped_ = static_cast<std::byte*>(mapped);
    }
    const VkBufferDeviceAddressInfo address{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr,
                                            buffer.buffer_};
    buffer.address_ = vk.vkGetBufferDeviceAddress(device.handle, &address);
    return buffer;
  });
}

Buffer::Buffer(Buffer&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      buffer_(std::exchange(other.buffer_, VK_NULL_HANDLE)),
      memory_(std::exchange(other.memory_, VK_NULL_HANDLE)),
      mapped_(std::exchange(other.mapped_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      allocated_(std::exchange(other.allocated_, 0)),
      address_(std::exchange(other.address_, 0)),
      coherent_(other.coherent_) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  destroy();
  device_ = std::exchange(other.device_, nullptr);
  buffer_ = std::exchange(other.buffer_, VK_NULL_HANDLE);
  memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
  mapped_ = std::exchange(other.mapped_, nullptr);
  size_ = std::exchange(other.size_, 0);
  allocated_ = std::exchange(other.allocated_, 0);
  address_ = std::exchange(other.address_, 0);
  coherent_ = other.coherent_;
  return *this;
}

Buffer::~Buffer() {
  destroy();
}

void Buffer::destroy() noexcept {
  if (device_ == nullptr) return;
  const std::shared_ptr<detail::Device> device = std::exchange(device_, nullptr);
  if (device->abandoned.load()) return;  // the device may still be using it
  device->functions.vkDestroyBuffer(device->handle, buffer_, nullptr);
  device->functions.vkFreeMemory(device->handle, memory_, nullptr);
  device->allocated -= allocated_;
}

Result<void> Buffer::flush() {
  if (coherent_ || mapped_ == nullptr) return {};
  const VkMappedMemoryRange all{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_, 0, VK_WHOLE_SIZE};
  VKMESH_VK(device_->functions.vkFlushMappedMemoryRanges(device_->handle, 1, &all), "flushing a buffer");
  return {};
}

Result<void> Buffer::invalidate() const {
  if (coherent_ || mapped_ == nullptr) return {};
  const VkMappedMemoryRange all{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_, 0, VK_WHOLE_SIZE};
  VKMESH_VK(device_->functions.vkInvalidateMappedMemoryRanges(device_->handle, 1, &all),
            "invalidating a buffer");
  return {};
}

Result<void> Buffer::upload(std::span<const std::byte> data, std::uint64_t offset) {
  return detail::catching([&]() -> Result<void> {
    if (offset > size_ || data.size() > size_ - offset)
      return fail(ErrorCode::kUsage, "an upload does not fit into the buffer");
    if (data.empty()) return {};
    if (mapped_ != nullptr) {
      std::memcpy(mapped_ + offset, data.data(), data.size());
      return flush();
    }
    Context context(device_);
    const std::uint64_t round = std::min<std::uint64_t>(data.size(), device_->options.staging_bytes);
    VKMESH_TRY(Buffer staging, create(context, round, BufferMemory::kStaging, "staging"));
    for (std::uint64_t done = 0; done < data.size(); done += round) {
      const std::uint64_t bytes = std::min<std::uint64_t>(round, data.size() - done);
      std::memcpy(staging.mapped_, data.data() + done, bytes);
      VKMESH_CHECK(staging.flush());
      VKMESH_TRY(Recorder recorder, Recorder::create(context));
      VKMESH_CHECK(recorder.copy(staging, *this, bytes, 0, offset + done));
      VKMESH_CHECK(recorder.submit_and_wait());
    }
    return {};
  });
}

Result<void> Buffer::download(std::span<std::byte> data, std::uint64_t offset) const {
  return detail::catching([&]() -> Result<void> {
    if (offset > size_ || data.size() > size_ - offset)
      return fail(ErrorCode::kUsage, "a download reaches past the end of the buffer");
    if (data.empty()) return {};
    if (mapped_ != nullptr) {
      VKMESH_CHECK(invalidate());
      std::memcpy(data.data(), mapped_ + offset, data.size());
      return {};
    }
    Context context(device_);
    const std::uint64_t round = std::min<std::uint64_t>(data.size(), device_->options.staging_bytes);
    VKMESH_TRY(const Buffer staging, create(context, round, BufferMemory::kReadback, "readback"));
    for (std::uint64_t done = 0; done < data.size(); done += round) {
      const std::uint64_t bytes = std::min<std::uint64_t>(round, data.size() - done);
      VKMESH_TRY(Recorder recorder, Recorder::create(context));
      VKMESH_CHECK(recorder.copy(*this, staging, bytes, offset + done, 0));
      VKMESH_CHECK(recorder.submit_and_wait());
      VKMESH_CHECK(staging.invalidate());
      std::memcpy(data.data() + done, staging.mapped_, bytes);
    }
    return {};
  });
}

}  // namespace vkmesh
