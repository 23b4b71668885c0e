// What push constants are made of, for GLSL and C++ alike. Addresses come after the two counts, so that each
// is 8-byte aligned in both languages.
#ifndef VKMESH_PARAMS_H
#define VKMESH_PARAMS_H

/// VKMESH_PARAMS(Name) { uint first; uint count; ... }; declares the push constants of a kernel, which runs
/// one thread for each i in [first, first + count). In C++ the struct is vkmesh::kernels::Name.
#ifdef __cplusplus
#include <cstdint>

#include <vkmesh/engine/core/device_array.h>

namespace vkmesh::kernels {
using uint = std::uint32_t;
using Floats = DeviceAddress<float>;
using Uints = DeviceAddress<std::uint32_t>;
using Words = DeviceAddress<std::uint32_t>;
}  // namespace vkmesh::kernels
#define VKMESH_PARAMS(Name)   \
  namespace vkmesh::kernels { \
  struct Name;                \
  }                           \
  struct vkmesh::kernels::Name
#else
// clang-format off
layout(buffer_reference, std430, buffer_reference_align = 4) buffer Floats { float at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Uints { uint at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) buffer Words { uint at[]; };
// clang-format on
#define VKMESH_PARAMS(Name) struct Name
#endif

#endif
