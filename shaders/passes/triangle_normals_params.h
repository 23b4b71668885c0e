// Push constants of triangle_areas.comp and triangle_normals.comp.
#ifndef VKMESH_TRIANGLE_NORMALS_PARAMS_H
#define VKMESH_TRIANGLE_NORMALS_PARAMS_H

#include "lib/params.h"

/// triangle_areas.comp, triangle_normals.comp: i is a face.
VKMESH_PARAMS(TrianglesParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Floats vectors;    ///< 3 a face: written
};

#endif
