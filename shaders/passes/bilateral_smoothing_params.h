// Push constants of bilateral_*.comp.
#ifndef VKMESH_BILATERAL_SMOOTHING_PARAMS_H
#define VKMESH_BILATERAL_SMOOTHING_PARAMS_H

#include "lib/params.h"

/// bilateral_faces.comp: i is a face, by its place in the grid.
VKMESH_PARAMS(BilateralFacesParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Uints face_order;  ///< the face at each place
  Floats faces;      ///< 4 a place, centroid and area: written
  float spatial;
};

/// bilateral_normals.comp: i is a face, by its place in the grid.
VKMESH_PARAMS(BilateralNormalsParams) {
  uint first;
  uint count;
  Floats mollified;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Uints face_order;  ///< the face at each place
  Floats normals;    ///< 3 a place: written
};

/// bilateral_mollify.comp, bilateral_move.comp: i is a vertex, by its place in the grid.
VKMESH_PARAMS(BilateralSumParams) {
  uint first;
  uint count;
  Floats positions;              ///< 3 a vertex
  Uints vertex_order;            ///< the vertex at each place
  Uints cells;                   ///< the cell of each place
  Uints range_offsets;           ///< cells + 1
  Uints ranges;                  ///< 2 a range: the first place of its faces, and the place after its last
  Floats faces;                  ///< 4 a place, from bilateral_faces
  Floats normals;                ///< 3 a place, from bilateral_normals; not read by bilateral_mollify
  Floats target;                 ///< 3 a vertex: written
  float spatial;                 ///< σ_f
  float per_spatial;             ///< 1 / σ_f
  float spatial_over_influence;  ///< σ_f / σ_g
};

#endif
