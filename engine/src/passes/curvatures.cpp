#include <vkmesh/engine/passes/curvatures.h>

#include "passes/curvatures_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_curvatures(Recorder& recorder, DeviceMesh& mesh) {
  if (!mesh.passes().curvatures)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass curvatures");
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), shaders::curvatures));
  kernels::CurvaturesParams params{};
  params.positions = mesh.positions().address();
  params.neighbour_offsets = mesh.neighbour_offsets().address();
  params.neighbour_ids = mesh.neighbour_ids().address();
  params.boundary_bits = mesh.boundary_bits().address();
  params.curvatures = mesh.curvatures().address();
  return recorder.dispatch(
      *kernel, params, mesh.vertex_count(),
      {&mesh.positions(), &mesh.neighbour_offsets(), &mesh.neighbour_ids(), &mesh.boundary_bits()},
      {&mesh.curvatures()});
}

}  // namespace vkmesh
