#include <vkmesh/engine/passes/triangle_normals.h>

#include "passes/face_vectors.h"

namespace vkmesh {

Result<void> record_triangle_normals(Recorder& recorder, DeviceMesh& mesh) {
  if (!mesh.passes().triangle_normals)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass triangle_normals");
  return detail::record_face_vectors(recorder, mesh, shaders::triangle_normals, mesh.triangle_normals());
}

}  // namespace vkmesh
