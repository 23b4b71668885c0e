#include <vkmesh/engine/passes/vertex_normals.h>

#include "passes/face_vectors.h"
#include "passes/vertex_normals_params.h"

namespace vkmesh {
namespace {

Result<void> record_sum_by_angle(Recorder& recorder, const DeviceMesh& mesh) {
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), shaders::vertex_normals_by_angle));
  kernels::VertexNormalsByAngleParams params{};
  params.positions = mesh.positions().address();
  params.corners = mesh.corners().address();
  params.face_normals = mesh.face_vectors().address();
  params.corner_offsets = mesh.corner_offsets().address();
  params.corner_half_edges = mesh.corner_half_edges().address();
  params.normals = mesh.vertex_normals().address();
  return recorder.dispatch(*kernel, params, mesh.vertex_count(),
                           {&mesh.positions(), &mesh.corners(), &mesh.face_vectors(), &mesh.corner_offsets(),
                            &mesh.corner_half_edges()},
                           {&mesh.vertex_normals()});
}

Result<void> record_sum(Recorder& recorder, const DeviceMesh& mesh) {
  VKMESH_TRY(const Kernel* kernel, Kernel::get(recorder.context(), shaders::vertex_normals));
  kernels::VertexNormalsParams params{};
  params.areas = mesh.face_vectors().address();
  params.corner_offsets = mesh.corner_offsets().address();
  params.corner_half_edges = mesh.corner_half_edges().address();
  params.normals = mesh.vertex_normals().address();
  return recorder.dispatch(*kernel, params, mesh.vertex_count(),
                           {&mesh.face_vectors(), &mesh.corner_offsets(), &mesh.corner_half_edges()},
                           {&mesh.vertex_normals()});
}

}  // namespace

Result<void> record_vertex_normals(Recorder& recorder, DeviceMesh& mesh,
                                   const VertexNormalsOptions& options) {
  if (!mesh.passes().vertex_normals)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass vertex_normals");
  const bool by_area = options.weights == NormalWeights::kArea;
  VKMESH_CHECK(detail::record_face_vectors(
      recorder, mesh, by_area ? shaders::triangle_areas : shaders::triangle_normals, mesh.face_vectors()));
  return options.weights == NormalWeights::kAngle ? record_sum_by_angle(recorder, mesh)
                                                  : record_sum(recorder, mesh);
}

}  // namespace vkmesh
