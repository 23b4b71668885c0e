#include <string>
#include <utility>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/passes/detail/smoothing_input.h>

#include "passes/laplacian_smoothing_params.h"
#include "shaders.h"

namespace vkmesh {
namespace {

/// The locks that the caller uploaded, or as many bits that are 0.
Result<const DeviceArray<std::uint32_t>*> locks_of(Context& context, const DeviceMesh& mesh,
                                                   DeviceSmoothing& smoothing) {
  const std::size_t words = (std::size_t{mesh.vertex_count()} + 31) / 32;
  if (smoothing.locked.size() != 0) {
    if (smoothing.locked.size() == words) return &smoothing.locked;
    return fail(ErrorCode::kUsage, std::to_string(smoothing.locked.size()) +
                                       " words of locked vertices, not " + std::to_string(words));
  }
  if (!smoothing.none_locked.exists_in(context) || smoothing.none_locked.size() < words)
    VKMESH_CHECK(smoothing.none_locked.upload(context, std::vector<std::uint32_t>(words), "no locks"));
  return &smoothing.none_locked;
}

}  // namespace

Result<void> record_laplacian_smoothing(Recorder& recorder, DeviceMesh& mesh, DeviceSmoothing& smoothing,
                                        const LaplacianSmoothingOptions& options) {
  VKMESH_CHECK(detail::require_smoothing_options(options));
  if (!options.locked.empty())
    return fail(ErrorCode::kUsage, "a device takes locked vertices by DeviceSmoothing::locked");
  Context& context = recorder.context();
  VKMESH_TRY(const auto* locked, detail::catching([&] { return locks_of(context, mesh, smoothing); }));
  VKMESH_CHECK(smoothing.positions.resize(context, mesh.vertex_count(), "smoothed positions"));
  const KernelSource& kernel = options.weights == SmoothingWeights::kUniform ? shaders::laplacian_smoothing
                                                                             : shaders::cotangent_smoothing;
  static_assert(VKMESH_BOUNDARY_FIXED == static_cast<int>(SmoothingBoundary::kFixed) &&
                VKMESH_BOUNDARY_ALONG_ITSELF == static_cast<int>(SmoothingBoundary::kAlongItself));
  const DeviceArray<Vec3>* source = &mesh.positions();
  const DeviceArray<Vec3>* target = &smoothing.positions;
  const auto step = [&](std::uint32_t, float factor) -> Result<void> {
    using P = kernels::LaplacianSmoothingParams;
    VKMESH_CHECK(Dispatch<P>(recorder, kernel, mesh.vertex_count())
                     .read(&P::neighbour_offsets, mesh.neighbour_offsets())
                     .read(&P::neighbour_ids, mesh.neighbour_ids())
                     .read(&P::boundary_bits, mesh.boundary_bits())
                     .read(&P::locked_bits, *locked)
                     .read(&P::source, *source)
                     .write(&P::target, *target)
                     .set(&P::factor, factor)
                     .set(&P::boundary_rule, static_cast<std::uint32_t>(options.boundary))
                     .record());
    std::swap(source, target);
    return {};
  };
  VKMESH_CHECK(detail::for_each_smoothing_step(options, step));
  if (source == &mesh.positions()) return {};
  return recorder.copy(source->buffer(), mesh.positions().buffer(),
                       std::uint64_t{mesh.vertex_count()} * sizeof(Vec3));
}

}  // namespace vkmesh
