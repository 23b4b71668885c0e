// Values that lie a fixed number of bytes apart, as a member of the vertices of an interleaved buffer does.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace vkmesh {

/// Values of T, `stride` bytes from each to the next. Borrowed. They need not be aligned as a T is.
template <class T>
class StridedSpan {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  constexpr StridedSpan() = default;
  /// Values side by side: a vector, an array or a span of T.
  template <class Values>
  requires std::convertible_to<const Values&, std::span<const T>>
  constexpr StridedSpan(const Values& values)
      : first_(std::span<const T>(values).data()), size_(std::span<const T>(values).size()) {}
  /// `size` values, the first of them at `first`.
  constexpr StridedSpan(const void* first, std::size_t size, std::size_t stride)
      : first_(first), size_(size), stride_(stride) {}

  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  [[nodiscard]] T operator[](std::size_t i) const {
    T value;
    std::memcpy(&value, static_cast<const std::byte*>(first_) + i * stride_, sizeof(T));
    return value;
  }
  /// Whether they lie side by side and aligned, so that packed() may be called.
  [[nodiscard]] bool is_packed() const {
    return stride_ == sizeof(T) && reinterpret_cast<std::uintptr_t>(first_) % alignof(T) == 0;
  }
  [[nodiscard]] std::span<const T> packed() const { return {static_cast<const T*>(first_), size_}; }

 private:
  const void* first_ = nullptr;
  std::size_t size_ = 0, stride_ = sizeof(T);
};

}  // namespace vkmesh
