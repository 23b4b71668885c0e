// Kernels and what they read and write, said once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/kernel.h>
#include <vkmesh/engine/core/recorder.h>

namespace vkmesh {

/// One run of a kernel, in the making. `Params` is the struct of push constants shared with the shader:
///
///     Dispatch<Params>(recorder, kernel, mesh.vertex_count())
///         .read(&Params::positions, mesh.positions())
///         .write(&Params::normals, normals, mesh.vertex_count())
///         .record();
///
/// read() and write() put the address of an array into the push constants, and tell the recorder what the
/// kernel does with it, so that barriers are where they must be. Errors wait for record().
template <class Params>
class Dispatch {
  static_assert(std::is_trivially_copyable_v<Params> && std::is_standard_layout_v<Params>);
  static_assert(offsetof(Params, first) == 0 && offsetof(Params, count) == 4);

 public:
  /// For the elements 0 to `threads` − 1. The kernel is made for the context when it is recorded first.
  Dispatch(Recorder& recorder, const KernelSource& kernel, std::uint64_t threads)
      : recorder_(recorder), kernel_(kernel), threads_(threads) {}

  /// Reads an array of elements of the address' type, or of structs of them.
  template <class Element, class T>
  [[nodiscard]] Dispatch& read(DeviceAddress<Element> Params::*address, const DeviceArray<T>& array) {
    static_assert(kHolds<T, Element>, "the kernel takes values of another type");
    return read(address, array.buffer());
  }
  /// The same of an array that is made when it is asked for, as those of DeviceMesh are.
  template <class Element, class T>
  [[nodiscard]] Dispatch& read(DeviceAddress<Element> Params::*address, Result<const DeviceArray<T>*> array) {
    if (array) return read(address, **array);
    if (status_) status_ = tl::unexpected<Error>(std::move(array).error());
    return *this;
  }
  template <class Element>
  [[nodiscard]] Dispatch& read(DeviceAddress<Element> Params::*address, const Buffer& buffer) {
    (params_.*address).value = buffer.address();
    reads_.add(buffer);
    return *this;
  }

  /// Writes the array; a kernel that reads it, too, says so by read().
  template <class Element, class T>
  [[nodiscard]] Dispatch& write(DeviceAddress<Element> Params::*address, const DeviceArray<T>& array) {
    static_assert(kHolds<T, Element>, "the kernel takes values of another type");
    return write(address, array.buffer());
  }
  /// The same, after making room for `size` values (see DeviceArray::resize()).
  template <class Element, class T>
  [[nodiscard]] Dispatch& write(DeviceAddress<Element> Params::*address, DeviceArray<T>& array,
                                std::size_t size) {
    if (status_) status_ = array.resize(recorder_.context(), size, kernel_.name);
    return write(address, std::as_const(array));
  }
  template <class Element>
  [[nodiscard]] Dispatch& write(DeviceAddress<Element> Params::*address, const Buffer& buffer) {
    (params_.*address).value = buffer.address();
    writes_.add(buffer);
    return *this;
  }

  /// Sets a number.
  template <class Number>
  [[nodiscard]] Dispatch& set(Number Params::*field, std::type_identity_t<Number> value) {
    params_.*field = value;
    return *this;
  }

  /// Adds it to the recorder's work. Long work is split; `first` and `count` are filled for each part.
  /// Errors: kUsage where the shader's push constants have another size, for more than 2^32 − 1 threads, and
  /// after Recorder::submit_and_wait(); what arrays were refused for; as Kernel::get().
  [[nodiscard]] Result<void> record() {
    VKMESH_CHECK(std::move(status_));
    return recorder_.dispatch(kernel_, std::as_bytes(std::span(&params_, 1)), threads_, reads_.all(),
                              writes_.all());
  }

 private:
  template <class T, class Element>
  static constexpr bool kHolds = std::is_integral_v<T> == std::is_integral_v<Element> &&
                                 sizeof(T) % sizeof(Element) == 0;

  /// One for each address at most.
  class Buffers {
   public:
    void add(const Buffer& buffer) {
      if (count_ < buffers_.size()) buffers_[count_++] = &buffer;
    }
    [[nodiscard]] std::span<const Buffer* const> all() const { return {buffers_.data(), count_}; }

   private:
    std::array<const Buffer*, sizeof(Params) / sizeof(std::uint64_t)> buffers_{};
    std::size_t count_ = 0;
  };

  Recorder& recorder_;
  const KernelSource& kernel_;
  std::uint64_t threads_;
  Params params_{};
  Buffers reads_, writes_;
  Result<void> status_;
};

}  // namespace vkmesh
