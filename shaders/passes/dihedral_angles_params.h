// Push constants of dihedral_angles.comp and vertex_maxima.comp.
#ifndef VKMESH_DIHEDRAL_ANGLES_PARAMS_H
#define VKMESH_DIHEDRAL_ANGLES_PARAMS_H

#include "lib/params.h"

/// dihedral_angles.comp: i is a half-edge.
VKMESH_PARAMS(DihedralAnglesParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Floats normals;    ///< 3 a face, from triangle_normals
  Uints twins;
  Floats angles;  ///< 1 a half-edge: written
};

/// vertex_maxima.comp: i is a vertex.
VKMESH_PARAMS(VertexMaximaParams) {
  uint first;
  uint count;
  Floats angles;         ///< 1 a half-edge of a triangle mesh
  Uints corner_offsets;  ///< vertices + 1
  Uints corner_half_edges;
  Floats maxima;  ///< 1 a vertex: written
};

#endif
