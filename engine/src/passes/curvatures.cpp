#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/curvatures.h>

#include "passes/curvatures_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_curvatures(Recorder& recorder, DeviceMesh& mesh,
                               DeviceArray<VertexCurvature>& curvatures) {
  using P = kernels::CurvaturesParams;
  return Dispatch<P>(recorder, shaders::curvatures, mesh.vertex_count())
      .read(&P::positions, mesh.positions())
      .read(&P::neighbour_offsets, mesh.neighbour_offsets())
      .read(&P::neighbour_ids, mesh.neighbour_ids())
      .read(&P::boundary_bits, mesh.boundary_bits())
      .write(&P::curvatures, curvatures, mesh.vertex_count())
      .record();
}

}  // namespace vkmesh
