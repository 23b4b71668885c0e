#include <vkmesh/engine/passes/dihedral_angles.h>

#include "passes/dihedral_angles_params.h"
#include "passes/face_vectors.h"

namespace vkmesh {

Result<void> record_dihedral_angles(Recorder& recorder, DeviceMesh& mesh) {
  if (!mesh.passes().dihedral_angles)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass dihedral_angles");
  VKMESH_TRY(const Kernel* angles, Kernel::get(recorder.context(), shaders::dihedral_angles));
  VKMESH_TRY(const Kernel* maxima, Kernel::get(recorder.context(), shaders::vertex_maxima));

  VKMESH_CHECK(detail::record_face_vectors(recorder, mesh, shaders::triangle_normals, mesh.face_vectors()));

  kernels::DihedralAnglesParams of_half_edges{};
  of_half_edges.positions = mesh.positions().address();
  of_half_edges.corners = mesh.corners().address();
  of_half_edges.normals = mesh.face_vectors().address();
  of_half_edges.twins = mesh.twins().address();
  of_half_edges.angles = mesh.half_edge_angles().address();
  VKMESH_CHECK(recorder.dispatch(*angles, of_half_edges, mesh.half_edge_count(),
                                 {&mesh.positions(), &mesh.corners(), &mesh.face_vectors(), &mesh.twins()},
                                 {&mesh.half_edge_angles()}));

  kernels::VertexMaximaParams of_vertices{};
  of_vertices.angles = mesh.half_edge_angles().address();
  of_vertices.corner_offsets = mesh.corner_offsets().address();
  of_vertices.corner_half_edges = mesh.corner_half_edges().address();
  of_vertices.maxima = mesh.vertex_maxima().address();
  return recorder.dispatch(*maxima, of_vertices, mesh.vertex_count(),
                           {&mesh.half_edge_angles(), &mesh.corner_offsets(), &mesh.corner_half_edges()},
                           {&mesh.vertex_maxima()});
}

}  // namespace vkmesh
