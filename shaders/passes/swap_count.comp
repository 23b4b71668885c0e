#version 460
#extension GL_GOOGLE_include_directive : require
// Counts swaps, or adds up counts, by blocks.
#include "lib/kernel.glsl"
#include "passes/swap_rounds_params.h"

VKMESH_PUSH_CONSTANTS(SwapCountParams);

void main() {
  VKMESH_THREAD_INDEX(block);
  VKMESH_SURPLUS_THREADS_LEAVE;
  const uint begin = block * VKMESH_SWAP_BLOCK, end = min(begin + VKMESH_SWAP_BLOCK, p.size);
  uint sum = 0;
  for (uint i = begin; i < end; ++i) {
    const uint value = p.values.at[p.from + i];
    sum += p.round == 0u ? value : (value == p.round ? 1u : 0u);
  }
  p.sums.at[p.to + block] = sum;
}
