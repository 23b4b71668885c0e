// Buffers in device memory, found by address.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <vulkan/vulkan_core.h>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/context.h>

namespace vkmesh {

enum class BufferMemory {
  kDevice,   ///< What shaders work in: fast for the device; mapped only where that is also fast for the host.
  kStaging,  ///< Written by the host, copied from.
  kReadback,  ///< Copied to, read by the host.
};

/// Range of device memory with an address that kernels take. Movable, not copyable. Empty when default-made.
class VKMESH_API Buffer {
 public:
  /// Allocates `bytes` bytes, which may be 0; their content is undefined. `name` is shown by debuggers and
  /// validation.
  /// Errors: kOutOfMemory, which says how many bytes were asked for and how many this context holds.
  [[nodiscard]] static Result<Buffer> create(Context& context, std::uint64_t bytes,
                                             BufferMemory memory = BufferMemory::kDevice,
                                             const char* name = "");

  Buffer() = default;
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;
  ~Buffer();

  [[nodiscard]] std::uint64_t size() const { return size_; }  ///< Bytes, as asked for.
  [[nodiscard]] std::uint64_t address() const { return address_; }
  [[nodiscard]] VkBuffer vk_buffer() const { return buffer_; }
  /// Tells whether create() made it in this context, if only of no bytes.
  [[nodiscard]] bool exists_in(const Context& context) const {
    return device_ != nullptr && device_ == context.shared_device();
  }
  /// The host's view of the memory; empty where it has none. After writing call flush(), before reading
  /// invalidate().
  [[nodiscard]] std::span<std::byte> mapped() const { return {mapped_, mapped_ == nullptr ? 0 : size_}; }
  [[nodiscard]] Result<void> flush();
  [[nodiscard]] Result<void> invalidate() const;

  /// Copies from or to the host, and returns when that is done: directly, or through a staging buffer of at
  /// most ContextOptions::staging_bytes. The device must not be using the buffer. O(bytes). Errors: kUsage
  /// for a range outside the buffer; kOutOfMemory; kNoDevice.
  [[nodiscard]] Result<void> upload(std::span<const std::byte> data, std::uint64_t offset = 0);
  [[nodiscard]] Result<void> download(std::span<std::byte> data, std::uint64_t offset = 0) const;

 private:
  void destroy() noexcept;

  std::shared_ptr<detail::Device> device_;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::byte* mapped_ = nullptr;
  std::uint64_t size_ = 0;
  std::uint64_t allocated_ = 0;
  std::uint64_t address_ = 0;
  bool coherent_ = true;
};

}  // namespace vkmesh
