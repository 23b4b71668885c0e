#include <vkmesh/engine/passes/vertex_normals.h>

#include "passes/face_vectors.h"
#include "passes/vertex_normals_params.h"

namespace vkmesh {
namespace {

Result<void> record_sum_by_angle(Recorder& recorder, DeviceMesh& mesh, DeviceVertexNormals& result) {
  using P = kernels::VertexNormalsByAngleParams;
  return Dispatch<P>(recorder, shaders::vertex_normals_by_angle, mesh.vertex_count())
      .read(&P::positions, mesh.positions())
      .read(&P::corners, mesh.corners())
      .read(&P::face_normals, result.face_vectors)
      .read(&P::corner_offsets, mesh.corner_offsets())
      .read(&P::corner_half_edges, mesh.corner_half_edges())
      .write(&P::normals, result.normals, mesh.vertex_count())
      .record();
}

Result<void> record_sum(Recorder& recorder, DeviceMesh& mesh, DeviceVertexNormals& result) {
  using P = kernels::VertexNormalsParams;
  return Dispatch<P>(recorder, shaders::vertex_normals, mesh.vertex_count())
      .read(&P::areas, result.face_vectors)
      .read(&P::corner_offsets, mesh.corner_offsets())
      .read(&P::corner_half_edges, mesh.corner_half_edges())
      .write(&P::normals, result.normals, mesh.vertex_count())
      .record();
}

}  // namespace

Result<void> record_vertex_normals(Recorder& recorder, DeviceMesh& mesh, DeviceVertexNormals& result,
                                   const VertexNormalsOptions& options) {
  const bool by_area = options.weights == NormalWeights::kArea;
  VKMESH_CHECK(detail::record_face_vectors(
      recorder, mesh, by_area ? shaders::triangle_areas : shaders::triangle_normals, result.face_vectors));
  return options.weights == NormalWeights::kAngle ? record_sum_by_angle(recorder, mesh, result)
                                                  : record_sum(recorder, mesh, result);
}

}  // namespace vkmesh
