#include <utility>

#include <vkmesh/engine/surface_measures.h>
#include <vkmesh/passes/arithmetic_constants.h>

#include "shaders.h"

namespace vkmesh {
namespace {

std::uint32_t blocks_of(std::uint32_t elements) {
  return elements / VKMESH_SUM_BLOCK + (elements % VKMESH_SUM_BLOCK != 0 ? 1 : 0);
}

Result<void> record_bounds(Recorder& recorder, const DeviceMesh& mesh) {
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), detail::bounds_blocks_kernel()));
  const Buffer* source = &mesh.positions();
  const Buffer* target = &mesh.block_sums();
  const Buffer* next = &mesh.more_block_sums();
  kernels::BoundsBlocksParams params{};
  params.vectors = 1;
  for (std::uint32_t elements = mesh.vertex_count(); params.vectors == 1 || elements > 1;) {
    params.elements = elements;
    params.source = source->address();
    params.target = target->address();
    elements = blocks_of(elements);
    VKMESH_CHECK(recorder.dispatch(*kernel, params, elements, {source}, {target}));
    params.vectors = 2;
    source = target;
    std::swap(target, next);
  }
  return recorder.copy(*source, mesh.surface_measures(), 6 * sizeof(float));
}

Result<void> record_sums(Recorder& recorder, const DeviceMesh& mesh) {
  VKMESH_TRY(const Kernel* measures, Kernel::get(recorder.context(), detail::face_measures_kernel()));
  VKMESH_TRY(const Kernel* sums, Kernel::get(recorder.context(), detail::sum_blocks_kernel()));
  const Buffer* source = &mesh.block_sums();
  const Buffer* target = &mesh.more_block_sums();
  kernels::FaceMeasuresParams of_faces{};
  of_faces.positions = mesh.positions().address();
  of_faces.corners = mesh.corners().address();
  of_faces.bounds = mesh.surface_measures().address();
  of_faces.sums = source->address();
  of_faces.faces = mesh.face_count();
  std::uint32_t elements = blocks_of(mesh.face_count());
  VKMESH_CHECK(recorder.dispatch(*measures, of_faces, elements,
                                 {&mesh.positions(), &mesh.corners(), &mesh.surface_measures()}, {source}));
  while (elements > 1) {
    kernels::SumBlocksParams params{};
    params.elements = elements;
    params.source = source->address();
    params.target = target->address();
    elements = blocks_of(elements);
    VKMESH_CHECK(recorder.dispatch(*sums, params, elements, {source}, {target}));
    std::swap(source, target);
  }
  return recorder.copy(*source, mesh.surface_measures(), 5 * sizeof(float), 0, 6 * sizeof(float));
}

}  // namespace

Result<void> record_surface_measures(Recorder& recorder, DeviceMesh& mesh) {
  if (!mesh.passes().surface_measures)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass surface_measures");
  const RawMeasures nothing{};
  VKMESH_CHECK(recorder.update(mesh.surface_measures(), std::as_bytes(std::span(nothing))));
  if (mesh.vertex_count() == 0) return {};
  VKMESH_CHECK(record_bounds(recorder, mesh));
  return mesh.face_count() == 0 ? Result<void>{} : record_sums(recorder, mesh);
}

}  // namespace vkmesh
