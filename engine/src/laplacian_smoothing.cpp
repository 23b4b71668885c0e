#include <string>
#include <utility>

#include <vkmesh/engine/laplacian_smoothing.h>

#include "shaders.h"

namespace vkmesh {

Result<void> record_laplacian_smoothing(Recorder& recorder, DeviceMesh& mesh,
                                        const LaplacianSmoothingOptions& options) {
  if (!mesh.passes().laplacian_smoothing)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass laplacian_smoothing");
  if (!(options.lambda >= 0.0f && options.lambda <= 1.0f))
    return fail(ErrorCode::kUsage, "lambda must lie in [0, 1], not " + std::to_string(options.lambda));
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), detail::laplacian_smoothing_kernel()));

  kernels::LaplacianSmoothingParams params{};
  params.neighbour_offsets = mesh.neighbour_offsets().address();
  params.neighbour_ids = mesh.neighbour_ids().address();
  params.fixed_bits = mesh.boundary_bits().address();
  params.lambda = options.lambda;
  params.use_fixed = options.fix_boundary ? 1 : 0;
  const Buffer* source = &mesh.positions();
  const Buffer* target = &mesh.smoothed_positions();
  for (std::uint32_t step = 0; step < options.iterations; ++step) {
    params.source = source->address();
    params.target = target->address();
    VKMESH_CHECK(recorder.dispatch(
        *kernel, params, mesh.vertex_count(),
        {source, &mesh.neighbour_offsets(), &mesh.neighbour_ids(), &mesh.boundary_bits()}, {target}));
    std::swap(source, target);
  }
  if (source == &mesh.positions()) return {};
  return recorder.copy(*source, mesh.positions(), source->size());
}

}  // namespace vkmesh
