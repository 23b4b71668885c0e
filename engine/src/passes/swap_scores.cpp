#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/swap_scores.h>

#include "passes/swap_scores_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_swap_scores(Recorder& recorder, DeviceMesh& mesh, DeviceArray<float>& scores,
                                SwapCriterion criterion) {
  using P = kernels::SwapScoresParams;
  return Dispatch<P>(recorder, shaders::swap_scores, mesh.half_edge_count())
      .read(&P::positions, mesh.positions())
      .read(&P::corners, mesh.corners())
      .read(&P::twins, mesh.twins())
      .write(&P::scores, scores, mesh.half_edge_count())
      .set(&P::criterion, static_cast<std::uint32_t>(criterion))
      .record();
}

}  // namespace vkmesh
