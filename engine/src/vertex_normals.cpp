#include <vkmesh/engine/vertex_normals.h>

#include "shaders.h"

namespace vkmesh {

Result<void> record_vertex_normals(Recorder& recorder, DeviceMesh& mesh) {
  if (!mesh.passes().vertex_normals)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass vertex_normals");
  VKMESH_TRY(const Kernel* areas, Kernel::get(recorder.context(), detail::triangle_areas_kernel()));
  VKMESH_TRY(const Kernel* normals, Kernel::get(recorder.context(), detail::vertex_normals_kernel()));

  kernels::TrianglesParams of_faces{};
  of_faces.positions = mesh.positions().address();
  of_faces.corners = mesh.corners().address();
  of_faces.vectors = mesh.face_vectors().address();
  VKMESH_CHECK(recorder.dispatch(*areas, of_faces, mesh.face_count(), {&mesh.positions(), &mesh.corners()},
                                 {&mesh.face_vectors()}));

  kernels::VertexNormalsParams of_vertices{};
  of_vertices.areas = mesh.face_vectors().address();
  of_vertices.corner_offsets = mesh.corner_offsets().address();
  of_vertices.corner_half_edges = mesh.corner_half_edges().address();
  of_vertices.normals = mesh.vertex_normals().address();
  return recorder.dispatch(*normals, of_vertices, mesh.vertex_count(),
                           {&mesh.face_vectors(), &mesh.corner_offsets(), &mesh.corner_half_edges()},
                           {&mesh.vertex_normals()});
}

}  // namespace vkmesh
