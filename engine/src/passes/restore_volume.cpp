#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/restore_volume.h>

#include "passes/restore_volume_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_restore_volume(Recorder& recorder, DeviceMesh& mesh, const DeviceSurfaceMeasures& before,
                                   DeviceSurfaceMeasures& after) {
  if (!mesh.is_closed()) return fail(ErrorCode::kUnsuitable, "only a closed surface has a volume to restore");
  VKMESH_CHECK(record_surface_measures(recorder, mesh, after));
  using P = kernels::RestoreVolumeParams;
  return Dispatch<P>(recorder, shaders::restore_volume, mesh.vertex_count())
      .read(&P::positions, mesh.positions())
      .read(&P::before, before.raw)
      .read(&P::after, after.raw)
      .write(&P::positions, mesh.positions())
      .record();
}

}  // namespace vkmesh
