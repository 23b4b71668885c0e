// Push constants of laplacian_smoothing.comp and cotangent_smoothing.comp.
#ifndef VKMESH_LAPLACIAN_SMOOTHING_PARAMS_H
#define VKMESH_LAPLACIAN_SMOOTHING_PARAMS_H

#include "lib/params.h"

/// laplacian_smoothing.comp, cotangent_smoothing.comp: i is a vertex.
VKMESH_PARAMS(LaplacianSmoothingParams) {
  uint first;
  uint count;
  Uints neighbour_offsets;  ///< vertices + 1
  Uints neighbour_ids;
  Uints boundary_bits;  ///< bit i % 32 of word i / 32: vertex i lies on the boundary
  Uints locked_bits;    ///< likewise: it stays
  Floats source;        ///< 3 a vertex
  Floats target;        ///< 3 a vertex: written
  float factor;         ///< λ or μ
  uint boundary_rule;   ///< SmoothingBoundary
};

// Values of SmoothingBoundary.
#define VKMESH_BOUNDARY_FIXED 0
#define VKMESH_BOUNDARY_ALONG_ITSELF 1

#endif
