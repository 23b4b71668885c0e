// Push constants of canary.comp.
#ifndef VKMESH_CANARY_PARAMS_H
#define VKMESH_CANARY_PARAMS_H

#include "lib/params.h"

/// canary.comp: i is a case.
VKMESH_PARAMS(CanaryParams) {
  uint first;
  uint count;
  Floats inputs;   ///< VKMESH_CANARY_INPUTS a case
  Floats results;  ///< VKMESH_CANARY_RESULTS a case: written
};

#define VKMESH_CANARY_INPUTS 9
#define VKMESH_CANARY_RESULTS 23

#endif
