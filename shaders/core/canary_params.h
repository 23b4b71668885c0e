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
// Times the number of a case: integers up to 2^31, most of which no float is equal to. Passes convert degrees
// of vertices, which are smaller, since a triangle mesh has fewer than 2^32 half-edges, three a face; drivers
// may differ beyond.
#define VKMESH_CANARY_UINT_STEP 4194309u

#endif
