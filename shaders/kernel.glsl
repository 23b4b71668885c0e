// What every kernel begins with: push constants by buffer address, one thread an element.
#ifndef VKMESH_KERNEL_GLSL
#define VKMESH_KERNEL_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : enable

layout(local_size_x = 128) in;

#include "params.h"
#ifdef VKMESH_BUILT_INS  // The benchmark's kernels, which are not exact.
#include "../bench/built_ins.glsl"
#else
#include "arithmetic.glsl"
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
// condition; past the end of the list they load an element again, and drop it. They load what the list holds before
// they load what that points to, so that more loads are under way at once.
#define VKMESH_UNMASKED 8u
#define VKMESH_CLAMPED(n, end) min(n, max(end, 1u) - 1u)

vec3 load3(Floats values, uint i) { return vec3(values.at[3 * i], values.at[3 * i + 1], values.at[3 * i + 2]); }

void store3(Floats values, uint i, vec3 v) { values.at[3 * i] = v.x; values.at[3 * i + 1] = v.y; values.at[3 * i + 2] = v.z; }

// The area vector of the face f, corner by corner.
vec3 face_area_vector(Floats positions, Uints corners, uint f) {
  const uvec3 v = uvec3(corners.at[3 * f], corners.at[3 * f + 1], corners.at[3 * f + 2]);
  return area_vector(load3(positions, v.x), load3(positions, v.y), load3(positions, v.z));
}

#endif
