#include <string>
#include <utility>

#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/passes/detail/smoothing_input.h>

#include "passes/laplacian_smoothing_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_laplacian_smoothing(Recorder& recorder, DeviceMesh& mesh,
                                        const LaplacianSmoothingOptions& options) {
  if (!mesh.passes().laplacian_smoothing)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass laplacian_smoothing");
  VKMESH_CHECK(detail::require_smoothing_options(options));
  if (!options.locked.empty())
    return fail(ErrorCode::kUsage, "a device takes locked vertices by DeviceMesh::upload_locks()");
  const bool uniform = options.weights == SmoothingWeights::kUniform;
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), uniform ? shaders::laplacian_smoothing
                                                                           : shaders::cotangent_smoothing));

  kernels::LaplacianSmoothingParams params{};
  params.neighbour_offsets = mesh.neighbour_offsets().address();
  params.neighbour_ids = mesh.neighbour_ids().address();
  params.boundary_bits = mesh.boundary_bits().address();
  params.locked_bits = mesh.locked_bits().address();
  static_assert(VKMESH_BOUNDARY_FIXED == static_cast<int>(SmoothingBoundary::kFixed) &&
                VKMESH_BOUNDARY_ALONG_ITSELF == static_cast<int>(SmoothingBoundary::kAlongItself));
  params.boundary_rule = static_cast<std::uint32_t>(options.boundary);
  const Buffer* source = &mesh.positions();
  const Buffer* target = &mesh.smoothed_positions();
  const auto step = [&](std::uint32_t, float factor) -> Result<void> {
    params.factor = factor;
    params.source = source->address();
    params.target = target->address();
    VKMESH_CHECK(recorder.dispatch(*kernel, params, mesh.vertex_count(),
                                   {source, &mesh.neighbour_offsets(), &mesh.neighbour_ids(),
                                    &mesh.boundary_bits(), &mesh.locked_bits()},
                                   {target}));
    std::swap(source, target);
    return {};
  };
  VKMESH_CHECK(detail::for_each_smoothing_step(options, step));
  if (source == &mesh.positions()) return {};
  return recorder.copy(*source, mesh.positions(), source->size());
}

}  // namespace vkmesh
