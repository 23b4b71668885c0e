// A vector for each face, as several passes need it.
#pragma once

#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>

#include "passes/triangle_normals_params.h"
#include "shaders.h"

namespace vkmesh::detail {

/// Records triangle_areas or triangle_normals, into `vectors`.
inline Result<void> record_face_vectors(Recorder& recorder, const DeviceMesh& mesh,
                                        const KernelSource& source, const Buffer& vectors) {
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), source));
  kernels::TrianglesParams params{};
  params.positions = mesh.positions().address();
  params.corners = mesh.corners().address();
  params.vectors = vectors.address();
  return recorder.dispatch(*kernel, params, mesh.face_count(), {&mesh.positions(), &mesh.corners()},
                           {&vectors});
}

}  // namespace vkmesh::detail
