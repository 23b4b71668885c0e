#include <algorithm>
#include <utility>

#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/math/arithmetic_constants.h>

#include "passes/surface_measures_params.h"
#include "shaders.h"

namespace vkmesh {
namespace {

std::uint32_t blocks_of_sums(std::uint32_t elements) {
  return elements / VKMESH_SUM_BLOCK + (elements % VKMESH_SUM_BLOCK != 0 ? 1 : 0);
}

Result<void> record_bounds(Recorder& recorder, const DeviceMesh& mesh, const DeviceSurfaceMeasures& result) {
  using P = kernels::BoundsBlocksParams;
  const Buffer* source = &mesh.positions().buffer();
  const Buffer* target = &result.block_sums.buffer();
  const Buffer* next = &result.more_block_sums.buffer();
  std::uint32_t vectors = 1;
  for (std::uint32_t elements = mesh.vertex_count(); vectors == 1 || elements > 1; vectors = 2) {
    const std::uint32_t blocks = blocks_of_sums(elements);
    VKMESH_CHECK(Dispatch<P>(recorder, shaders::bounds_blocks, blocks)
                     .read(&P::source, *source)
                     .write(&P::target, *target)
                     .set(&P::elements, elements)
                     .set(&P::vectors, vectors)
                     .record());
    elements = blocks;
    source = target;
    std::swap(target, next);
  }
  return recorder.copy(*source, result.raw.buffer(), 6 * sizeof(float));
}

Result<void> record_sums(Recorder& recorder, DeviceMesh& mesh, const DeviceSurfaceMeasures& result) {
  const Buffer* source = &result.block_sums.buffer();
  const Buffer* target = &result.more_block_sums.buffer();
  std::uint32_t elements = blocks_of_sums(mesh.face_count());
  using F = kernels::FaceMeasuresParams;
  VKMESH_CHECK(Dispatch<F>(recorder, shaders::face_measures, elements)
                   .read(&F::positions, mesh.positions())
                   .read(&F::corners, mesh.corners())
                   .read(&F::bounds, result.raw)
                   .write(&F::sums, *source)
                   .set(&F::faces, mesh.face_count())
                   .record());
  using P = kernels::SumBlocksParams;
  while (elements > 1) {
    const std::uint32_t blocks = blocks_of_sums(elements);
    VKMESH_CHECK(Dispatch<P>(recorder, shaders::sum_blocks, blocks)
                     .read(&P::source, *source)
                     .write(&P::target, *target)
                     .set(&P::elements, elements)
                     .record());
    elements = blocks;
    std::swap(source, target);
  }
  return recorder.copy(*source, result.raw.buffer(), 5 * sizeof(float), 0, 6 * sizeof(float));
}

}  // namespace

Result<void> record_surface_measures(Recorder& recorder, DeviceMesh& mesh, DeviceSurfaceMeasures& result) {
  Context& context = recorder.context();
  // Six floats a block of bounds, five a block of sums; each level takes a 64th of the one before.
  const std::size_t blocks = blocks_of_sums(std::max(mesh.vertex_count(), mesh.face_count()));
  VKMESH_CHECK(result.raw.resize(context, 1, "surface measures"));
  VKMESH_CHECK(result.block_sums.resize(context, 6 * blocks, "block sums"));
  VKMESH_CHECK(
      result.more_block_sums.resize(context, 6 * (blocks / VKMESH_SUM_BLOCK + 1), "more block sums"));
  const RawMeasures nothing{};
  VKMESH_CHECK(recorder.update(result.raw.buffer(), std::as_bytes(std::span(nothing))));
  if (mesh.vertex_count() == 0) return {};
  VKMESH_CHECK(record_bounds(recorder, mesh, result));
  return mesh.face_count() == 0 ? Result<void>{} : record_sums(recorder, mesh, result);
}

Result<SurfaceMeasures> DeviceSurfaceMeasures::download() const {
  VKMESH_TRY(const std::vector<RawMeasures> values, raw.download());
  if (values.empty()) return fail(ErrorCode::kUsage, "no surface measures were recorded");
  return to_surface_measures(values[0]);
}

}  // namespace vkmesh
