// Push constants of face_areas.comp.
#ifndef VKMESH_FACE_AREAS_PARAMS_H
#define VKMESH_FACE_AREAS_PARAMS_H

#include "lib/params.h"

/// face_areas.comp: i is a face.
VKMESH_PARAMS(FaceAreasParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex
  Uints corners;     ///< 3 a face
  Floats areas;      ///< 1 a face: written
};

#endif
