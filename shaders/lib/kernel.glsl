// What every kernel begins with: push constants by buffer address, one thread an element.
#ifndef VKMESH_KERNEL_GLSL
#define VKMESH_KERNEL_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : enable

layout(local_size_x = 128) in;

#include "lib/params.h"
#ifdef VKMESH_BUILT_INS  // The benchmark's kernels, which are not exact.
#include "../bench/built_ins.glsl"
#else
#include "lib/arithmetic.glsl"
#endif

// Declares the push constants `p`.
#define VKMESH_PUSH_CONSTANTS(Params) \
  layout(push_constant, std430) uniform PushConstants { Params p; }

// The surplus threads of the last group compute the last element again and leave before they store it. (Leaving at once
// would put all that follows under a mask, and loads under a mask cost software devices twice as much.)
#define VKMESH_THREAD_INDEX(i) const uint i = p.first + min(gl_GlobalInvocationID.x, p.count - 1u)
#define VKMESH_SURPLUS_THREADS_LEAVE \
  if (gl_GlobalInvocationID.x >= p.count) return

// For the same reason gathers load the first eight elements of a list, which is all that most vertices have, without a
// condition; past the end of the list they load some other element, and drop it. They load what the list holds before
// they load what that points to, so that more loads are under way at once.
#define VKMESH_UNMASKED 8u
#define VKMESH_CLAMPED(n, end) min(n, max(end, 1u) - 1u)

// Pairs of values: a load of 64 bits costs software devices no more than one of 32. Of all types of 64 bits only addresses
// need no feature of the device; these are taken for the bits they are, and never followed.
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer Pairs { Floats at[]; };

// The values 2i and 2i + 1. Every buffer starts with a pair and ends with a whole one. (The parameter is no Pairs because
// glslang, where it meets those before Floats, asks for descriptor indexing. An address of one type becomes one of another
// by way of a uvec2 here and everywhere: SwiftShader crashes on a bitcast from pointer to pointer.)
uvec2 load2(Floats values, uint i) { return uvec2(Pairs(uvec2(values)).at[i]); }

// The values 3i to 3i + 2, which lie in two pairs.
uvec3 load3_bits(Floats values, uint i) {
  const uvec2 a = load2(values, 3 * i / 2), b = load2(values, 3 * i / 2 + 1);
  return i % 2 == 0 ? uvec3(a, b.x) : uvec3(a.y, b);
}

vec3 load3(Floats values, uint i) { return uintBitsToFloat(load3_bits(values, i)); }

void store3(Floats values, uint i, vec3 v) { values.at[3 * i] = v.x; values.at[3 * i + 1] = v.y; values.at[3 * i + 2] = v.z; }

// The first elements of a list, those from `begin` to `end`; then 0, an index that is always valid.
uint[VKMESH_UNMASKED] load_list(Uints values, uint begin, uint end) {
  uint list[VKMESH_UNMASKED];
  const uint last = (max(end, 1u) - 1u) / 2;
  uvec2 a = load2(Floats(uvec2(values)), min(begin / 2, last));
  for (uint k = 0; k < VKMESH_UNMASKED; k += 2) {
    const uvec2 b = load2(Floats(uvec2(values)), min((begin + k) / 2 + 1, last));
    const uvec2 both = begin % 2 == 0 ? a : uvec2(a.y, b.x);
    list[k] = begin + k < end ? both.x : 0u;
    list[k + 1] = begin + k + 1 < end ? both.y : 0u;
    a = b;
  }
  return list;
}

// The area vector of the face f, corner by corner.
vec3 face_area_vector(Floats positions, Uints corners, uint f) {
  const uvec3 v = load3_bits(Floats(uvec2(corners)), f);
  return area_vector(load3(positions, v.x), load3(positions, v.y), load3(positions, v.z));
}

#endif
