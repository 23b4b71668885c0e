#include <utility>

#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/math/arithmetic_constants.h>

#include "passes/raw_measures.h"
#include "passes/surface_measures_params.h"
#include "shaders.h"

namespace vkmesh {
namespace {

std::uint32_t blocks_of(std::uint32_t elements) {
  return elements / VKMESH_SUM_BLOCK + (elements % VKMESH_SUM_BLOCK != 0 ? 1 : 0);
}

Result<void> record_bounds(Recorder& recorder, const DeviceMesh& mesh, const Buffer& measures) {
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), shaders::bounds_blocks));
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
  return recorder.copy(*source, measures, 6 * sizeof(float));
}

Result<void> record_sums(Recorder& recorder, const DeviceMesh& mesh, const Buffer& measures) {
  VKMESH_TRY(const Kernel* per_face, Kernel::get(recorder.context(), shaders::face_measures));
  VKMESH_TRY(const Kernel* sums, Kernel::get(recorder.context(), shaders::sum_blocks));
  const Buffer* source = &mesh.block_sums();
  const Buffer* target = &mesh.more_block_sums();
  kernels::FaceMeasuresParams of_faces{};
  of_faces.positions = mesh.positions().address();
  of_faces.corners = mesh.corners().address();
  of_faces.bounds = measures.address();
  of_faces.sums = source->address();
  of_faces.faces = mesh.face_count();
  std::uint32_t elements = blocks_of(mesh.face_count());
  VKMESH_CHECK(recorder.dispatch(*per_face, of_faces, elements,
                                 {&mesh.positions(), &mesh.corners(), &measures}, {source}));
  while (elements > 1) {
    kernels::SumBlocksParams params{};
    params.elements = elements;
    params.source = source->address();
    params.target = target->address();
    elements = blocks_of(elements);
    VKMESH_CHECK(recorder.dispatch(*sums, params, elements, {source}, {target}));
    std::swap(source, target);
  }
  return recorder.copy(*source, measures, 5 * sizeof(float), 0, 6 * sizeof(float));
}

}  // namespace

Result<void> detail::record_raw_measures(Recorder& recorder, const DeviceMesh& mesh, const Buffer& measures) {
  const RawMeasures nothing{};
  VKMESH_CHECK(recorder.update(measures, std::as_bytes(std::span(nothing))));
  if (mesh.vertex_count() == 0) return {};
  VKMESH_CHECK(record_bounds(recorder, mesh, measures));
  return mesh.face_count() == 0 ? Result<void>{} : record_sums(recorder, mesh, measures);
}

Result<void> record_surface_measures(Recorder& recorder, DeviceMesh& mesh) {
  if (!mesh.passes().surface_measures)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass surface_measures");
  return detail::record_raw_measures(recorder, mesh, mesh.surface_measures());
}

}  // namespace vkmesh
