// Push constants of restore_volume.comp.
#ifndef VKMESH_RESTORE_VOLUME_PARAMS_H
#define VKMESH_RESTORE_VOLUME_PARAMS_H

#include "lib/params.h"

/// restore_volume.comp: i is a vertex.
VKMESH_PARAMS(RestoreVolumeParams) {
  uint first;
  uint count;
  Floats positions;  ///< 3 a vertex: read and written
  Floats before;     ///< RawMeasures
  Floats after;      ///< RawMeasures
};

#endif
