#include "example_pass/record_face_areas.h"

#include <vkmesh/engine/core/dispatch.h>

#include "example_pass/face_areas_params.h"
#include "example_shaders.h"

namespace vkmesh {

Result<void> record_face_areas(Recorder& recorder, DeviceMesh& mesh, DeviceArray<float>& areas) {
  using P = kernels::FaceAreasParams;
  return Dispatch<P>(recorder, example_shaders::face_areas, mesh.face_count())
      .read(&P::positions, mesh.positions())
      .read(&P::corners, mesh.corners())
      .write(&P::areas, areas, mesh.face_count())
      .record();
}

}  // namespace vkmesh
