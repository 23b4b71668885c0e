#version 460
#extension GL_GOOGLE_include_directive : require
// The sums of blocks of what face_measures.comp wrote.
#include "lib/kernel.glsl"
#include "passes/surface_measures_params.h"

VKMESH_PUSH_CONSTANTS(SumBlocksParams);

void main() {
  VKMESH_THREAD_INDEX(b);
  const uint begin = VKMESH_SUM_BLOCK * b;
  precise float sums[5] = float[5](0.0, 0.0, 0.0, 0.0, 0.0);
  for (uint k = 0; k < VKMESH_SUM_BLOCK; ++k)
    for (uint j = 0; j < 5; ++j) {
      precise float more = sums[j] + p.source.at[5 * min(begin + k, p.elements - 1u) + j];
      sums[j] = begin + k < p.elements ? more : sums[j];
    }
  VKMESH_SURPLUS_THREADS_LEAVE;
  for (uint j = 0; j < 5; ++j) p.target.at[5 * b + j] = sums[j];
}
