// Typed values in device memory: what meshes are made of, and what passes write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/buffer.h>

namespace vkmesh {

/// Address of values of T in device memory, in the push constants of a kernel (see dispatch.h).
template <class T>
struct DeviceAddress {
  std::uint64_t value = 0;
};

/// Array of T in device memory. Empty when default-made. It keeps its memory while that suffices: results and
/// scratch that a caller keeps from frame to frame cost no allocation. Movable, not copyable.
template <class T>
class DeviceArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Makes room for `size` values; what they are is undefined. Memory that is too small, or of another
  /// context, is given back first, so that no recorded work that has yet to run may use it. `name` is shown
  /// by debuggers and validation. Errors: kOutOfMemory.
  [[nodiscard]] Result<void> resize(Context& context, std::size_t size, const char* name = "") {
    if (!exists_in(context) || buffer_.size() < size * sizeof(T)) {
      size_ = 0;
      buffer_ = {};
      VKMESH_TRY(buffer_, Buffer::create(context, size * sizeof(T), BufferMemory::kDevice, name));
    }
    size_ = size;
    return {};
  }

  /// Replaces the values by these, which may be more or fewer. The device must not be using the array.
  /// O(size). Errors: as resize(), kNoDevice; the array is then empty.
  [[nodiscard]] Result<void> upload(Context& context, std::span<const T> values, const char* name = "") {
    VKMESH_CHECK(resize(context, values.size(), name));
    auto uploaded = buffer_.upload(std::as_bytes(values));
    if (!uploaded) *this = {};
    return uploaded;
  }

  /// Downloads the values, once the work that writes them has run. O(size). Errors: kOutOfMemory, kNoDevice.
  [[nodiscard]] Result<std::vector<T>> download() const {
    return detail::catching([&]() -> Result<std::vector<T>> {
      std::vector<T> values(size_);
      VKMESH_CHECK(buffer_.download(std::as_writable_bytes(std::span(values))));
      return values;
    });
  }

  [[nodiscard]] std::size_t size() const { return size_; }  ///< Values.
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }
  /// Tells whether resize() or upload() made it in this context, if only for no values.
  [[nodiscard]] bool exists_in(const Context& context) const { return buffer_.exists_in(context); }

 private:
  Buffer buffer_;
  std::size_t size_ = 0;
};

}  // namespace vkmesh
