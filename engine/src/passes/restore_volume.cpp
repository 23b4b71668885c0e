#include <vkmesh/engine/passes/restore_volume.h>

#include "passes/raw_measures.h"
#include "passes/restore_volume_params.h"
#include "shaders.h"

namespace vkmesh {
namespace {

Result<void> require_volume(const DeviceMesh& mesh) {
  if (!mesh.passes().restore_volume)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass restore_volume");
  if (!mesh.is_closed()) return fail(ErrorCode::kUnsuitable, "only a closed surface has a volume to restore");
  return {};
}

}  // namespace

Result<void> record_volume(Recorder& recorder, DeviceMesh& mesh) {
  VKMESH_CHECK(require_volume(mesh));
  return detail::record_raw_measures(recorder, mesh, mesh.volume_before());
}

Result<void> record_restore_volume(Recorder& recorder, DeviceMesh& mesh) {
  VKMESH_CHECK(require_volume(mesh));
  VKMESH_CHECK(detail::record_raw_measures(recorder, mesh, mesh.surface_measures()));
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), shaders::restore_volume));
  kernels::RestoreVolumeParams params{};
  params.positions = mesh.positions().address();
  params.before = mesh.volume_before().address();
  params.after = mesh.surface_measures().address();
  return recorder.dispatch(*kernel, params, mesh.vertex_count(),
                           {&mesh.positions(), &mesh.volume_before(), &mesh.surface_measures()},
                           {&mesh.positions()});
}

}  // namespace vkmesh
