// Push constants of vertex_normals.comp and vertex_normals_by_angle.comp.
#ifndef VKMESH_VERTEX_NORMALS_PARAMS_H
#define VKMESH_VERTEX_NORMALS_PARAMS_H

#include "lib/params.h"

/// vertex_normals.comp: i is a vertex.
VKMESH_PARAMS(VertexNormalsParams) {
  uint first;
  uint count;
  Floats areas;          ///< 3 a face, from triangle_areas or triangle_normals
  Uints corner_offsets;  ///< vertices + 1
  Uints corner_half_edges;
  Floats normals;  ///< 3 a vertex: written
};

/// vertex_normals_by_angle.comp: i is a vertex.
VKMESH_PARAMS(VertexNormalsByAngleParams) {
  uint first;
  uint count;
  Floats positions;      ///< 3 a vertex
  Uints corners;         ///< 3 a face
  Floats face_normals;   ///< 3 a face, from triangle_normals
  Uints corner_offsets;  ///< vertices + 1
  Uints corner_half_edges;
  Floats normals;  ///< 3 a vertex: written
};

#endif
