// Push constants of vertex_quadrics.comp and collapse_costs.comp.
#ifndef VKMESH_COLLAPSE_COSTS_PARAMS_H
#define VKMESH_COLLAPSE_COSTS_PARAMS_H

#include "lib/params.h"

/// vertex_quadrics.comp: i is a vertex.
VKMESH_PARAMS(QuadricsParams) {
  uint first;
  uint count;
  Floats positions;      ///< 3 a vertex
  Uints corners;         ///< 3 a face
  Uints twins;           ///< 1 a half-edge
  Uints corner_offsets;  ///< vertices + 1
  Uints corner_half_edges;
  Floats quadrics;  ///< 6 a vertex: written
  float centre_x;
  float centre_y;
  float centre_z;
  float scale;
  float boundary_weight;
};

/// collapse_costs.comp: i is a half-edge.
VKMESH_PARAMS(CollapseCostsParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Uints twins;       ///< 1 a half-edge
  Floats quadrics;   ///< 6 a vertex
  Floats costs;      ///< 1 a half-edge: written
  float centre_x;
  float centre_y;
  float centre_z;
  float scale;
  uint placement;  ///< CollapsePlacement
};

// Values of CollapsePlacement.
#define VKMESH_PLACEMENT_OPTIMAL 0
#define VKMESH_PLACEMENT_ENDPOINT 2

#endif
