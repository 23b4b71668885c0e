// Push constants of bounds_blocks.comp, face_measures.comp and sum_blocks.comp.
#ifndef VKMESH_SURFACE_MEASURES_PARAMS_H
#define VKMESH_SURFACE_MEASURES_PARAMS_H

#include "lib/params.h"

/// bounds_blocks.comp: i is a block of VKMESH_SUM_BLOCK elements.
VKMESH_PARAMS(BoundsBlocksParams) {
  uint first;
  uint count;
  Floats source;  ///< `vectors` times 3 an element: a point (1), or low and high (2)
  Floats target;  ///< 6 a block: written
  uint elements;
  uint vectors;
};

/// face_measures.comp: i is a block of VKMESH_SUM_BLOCK faces.
VKMESH_PARAMS(FaceMeasuresParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Floats bounds;     ///< 6
  Floats sums;       ///< 5 a block: written
  uint faces;
};

/// sum_blocks.comp: i is a block of VKMESH_SUM_BLOCK elements.
VKMESH_PARAMS(SumBlocksParams) {
  uint first;
  uint count;
  Floats source;  ///< 5 an element
  Floats target;  ///< 5 a block: written
  uint elements;
};

#endif
