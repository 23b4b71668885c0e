// A vector for each face, as several passes need it.
#pragma once

#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/mesh/device_mesh.h>

#include "passes/triangle_normals_params.h"
#include "shaders.h"

namespace vkmesh::detail {

/// Records shaders::triangle_areas or shaders::triangle_normals.
inline Result<void> record_face_vectors(Recorder& recorder, DeviceMesh& mesh, const KernelSource& kernel,
                                        DeviceArray<Vec3>& vectors) {
  using P = kernels::TrianglesParams;
  return Dispatch<P>(recorder, kernel, mesh.face_count())
      .read(&P::positions, mesh.positions())
      .read(&P::corners, mesh.corners())
      .write(&P::vectors, vectors, mesh.face_count())
      .record();
}

}  // namespace vkmesh::detail
