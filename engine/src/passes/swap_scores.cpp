#include <vkmesh/engine/passes/swap_scores.h>

#include "passes/swap_scores_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_swap_scores(Recorder& recorder, DeviceMesh& mesh, SwapCriterion criterion) {
  if (!mesh.passes().swap_scores)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass swap_scores");
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), shaders::swap_scores));
  kernels::SwapScoresParams params{};
  params.positions = mesh.positions().address();
  params.corners = mesh.corners().address();
  params.twins = mesh.twins().address();
  params.scores = mesh.swap_scores().address();
  params.criterion = static_cast<std::uint32_t>(criterion);
  return recorder.dispatch(*kernel, params, mesh.half_edge_count(),
                           {&mesh.positions(), &mesh.corners(), &mesh.twins()}, {&mesh.swap_scores()});
}

}  // namespace vkmesh
