// Push constants of the kernels that swap edges in rounds.
#ifndef VKMESH_SWAP_ROUNDS_PARAMS_H
#define VKMESH_SWAP_ROUNDS_PARAMS_H

#include "lib/params.h"

/// swap_gains.comp: i is a half-edge.
VKMESH_PARAMS(SwapGainsParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Uints twins;       ///< 1 a half-edge
  Uints leading;     ///< 1 a vertex
  Uints locked;      ///< 1 a half-edge
  Words changed;     ///< 1 a face: the round of its last swap; cleared in the first
  Floats gains;      ///< 1 a half-edge: read and written
  Words sources;     ///< 1 a half-edge: its own number in the first round
  uint criterion;    ///< SwapCriterion
  uint round;        ///< From 1 on
  uint lock_count;   ///< 0: there are no locks
};

/// swap_best.comp: i is a vertex.
VKMESH_PARAMS(SwapBestParams) {
  uint first;
  uint count;
  Uints twins;    ///< 1 a half-edge
  Uints leading;  ///< 1 a vertex
  Floats gains;   ///< 1 a half-edge
  Words best;     ///< 1 a vertex: written
};

/// swap_select.comp: i is a half-edge.
VKMESH_PARAMS(SwapSelectParams) {
  uint first;
  uint count;
  Uints corners;   ///< 3 a face
  Uints twins;     ///< 1 a half-edge
  Floats gains;    ///< 1 a half-edge
  Uints best;      ///< 1 a vertex
  Words selected;  ///< 1 a half-edge: the round if it swaps, or 0: written
  uint round;
};

/// swap_flip.comp: i is a half-edge. All but `selected` is read and written.
VKMESH_PARAMS(SwapFlipParams) {
  uint first;
  uint count;
  Uints selected;  ///< 1 a half-edge
  Words corners;   ///< 3 a face
  Words twins;     ///< 1 a half-edge
  Words leading;   ///< 1 a vertex
  Words locked;    ///< 1 a half-edge
  Words changed;   ///< 1 a face
  Words sources;   ///< 1 a half-edge
  uint round;
  uint lock_count;
};

/// swap_count.comp: i is a block of VKMESH_SWAP_BLOCK values.
VKMESH_PARAMS(SwapCountParams) {
  uint first;
  uint count;
  Uints values;
  Words sums;  ///< Written
  uint from;   ///< Where the values begin.
  uint size;   ///< Of values.
  uint round;  ///< Values that are this count 1; 0: values are sums.
  uint to;     ///< Where the sum of block 0 goes.
};

#define VKMESH_SWAP_BLOCK 256
#define VKMESH_MAX_SWAP_VALENCE 1024   ///< kMaxSwapValence
#define VKMESH_SWAP_ROUNDS_BY_ANGLE 0  ///< SwapCriterion::kMinAngle

#endif
