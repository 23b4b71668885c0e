// Push constants of swap_scores.comp.
#ifndef VKMESH_SWAP_SCORES_PARAMS_H
#define VKMESH_SWAP_SCORES_PARAMS_H

#include "lib/params.h"

/// swap_scores.comp: i is a half-edge.
VKMESH_PARAMS(SwapScoresParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Uints twins;       ///< 1 a half-edge
  Floats scores;     ///< 1 a half-edge: written
  uint criterion;    ///< SwapCriterion
};

#define VKMESH_SWAP_BY_ANGLE 0  ///< SwapCriterion::kMinAngle
#define VKMESH_NO_SWAP -4.0f    ///< kNoSwap

#endif
