// Storage for millions of records that are all written before they are read.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "base/huge_pages.h"
#include "base/prefetch.h"

namespace vkmesh::detail {

/// An array that is not filled when it is made, in large pages where the system grants them: where what is
/// read next lies anywhere, a walk through page tables costs as much as the read.
template <class T>
class LargeArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  LargeArray() = default;
  explicit LargeArray(std::size_t size) : size_(size) {
    const std::size_t bytes = size * sizeof(T);
    const std::size_t alignment = bytes < kLargePage ? kCacheLine : kLargePage;
    data_ = Data(static_cast<T*>(::operator new(bytes, std::align_val_t(alignment))), Deleter{alignment});
    prefer_large_pages(data_.get(), bytes);
  }

  [[nodiscard]] T& operator[](std::size_t i) { return data_.get()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data_.get()[i]; }
  [[nodiscard]] T* data() { return data_.get(); }
  [[nodiscard]] const T* data() const { return data_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Keeps the first `kept` elements.
  void grow(std::size_t size, std::size_t kept) {
    LargeArray larger(size);
    std::memcpy(static_cast<void*>(larger.data_.get()), data_.get(), kept * sizeof(T));
    *this = std::move(larger);
  }

 private:
  struct Deleter {
    std::size_t alignment = kCacheLine;
    void operator()(T* data) const { ::operator delete(data, std::align_val_t(alignment)); }
  };
  using Data = std::unique_ptr<T, Deleter>;
  Data data_;
  std::size_t size_ = 0;
};

}  // namespace vkmesh::detail
