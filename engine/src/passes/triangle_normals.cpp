#include <vkmesh/engine/passes/triangle_normals.h>

#include "passes/face_vectors.h"

namespace vkmesh {

Result<void> record_triangle_normals(Recorder& recorder, DeviceMesh& mesh, DeviceArray<Vec3>& normals) {
  return detail::record_face_vectors(recorder, mesh, shaders::triangle_normals, normals);
}

}  // namespace vkmesh
