// Push constants of curvatures.comp.
#ifndef VKMESH_CURVATURES_PARAMS_H
#define VKMESH_CURVATURES_PARAMS_H

#include "lib/params.h"

/// curvatures.comp: i is a vertex.
VKMESH_PARAMS(CurvaturesParams) {
  uint first;
  uint count;
  Floats positions;         ///< 3 a vertex
  Uints neighbour_offsets;  ///< vertices + 1
  Uints neighbour_ids;
  Uints boundary_bits;  ///< bit i % 32 of word i / 32: vertex i lies on the boundary
  Floats curvatures;    ///< 4 a vertex, as VertexCurvature: written
};

#endif
