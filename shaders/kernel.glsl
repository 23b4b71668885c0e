// What every kernel begins with: push constants by buffer address, one thread an element.
#ifndef VKMESH_KERNEL_GLSL
#define VKMESH_KERNEL_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : enable

layout(local_size_x = 128) in;

#include "params.h"
#include "arithmetic.glsl"

// Declares the push constants `p` and the index `i` of this thread, and ends the surplus threads of the last group.
#define VKMESH_PUSH_CONSTANTS(Params) \
  layout(push_constant, std430) uniform PushConstants { Params p; }

#define VKMESH_THREAD_INDEX(i)                   \
  uint i = gl_GlobalInvocationID.x;              \
  if (i >= p.count) return;                      \
  i += p.first

vec3 load3(Floats values, uint i) { return vec3(values.at[3 * i], values.at[3 * i + 1], values.at[3 * i + 2]); }

void store3(Floats values, uint i, vec3 v) {
  values.at[3 * i] = v.x;
  values.at[3 * i + 1] = v.y;
  values.at[3 * i + 2] = v.z;
}

#endif
