#include <vkmesh/engine/passes/dihedral_angles.h>

#include "passes/dihedral_angles_params.h"
#include "passes/face_vectors.h"

namespace vkmesh {

Result<void> record_dihedral_angles(Recorder& recorder, DeviceMesh& mesh, DeviceDihedralAngles& result) {
  VKMESH_CHECK(detail::record_face_vectors(recorder, mesh, shaders::triangle_normals, result.normals));
  using P = kernels::DihedralAnglesParams;
  VKMESH_CHECK(Dispatch<P>(recorder, shaders::dihedral_angles, mesh.half_edge_count())
                   .read(&P::positions, mesh.positions())
                   .read(&P::corners, mesh.corners())
                   .read(&P::normals, result.normals)
                   .read(&P::twins, mesh.twins())
                   .write(&P::angles, result.half_edge, mesh.half_edge_count())
                   .record());
  using Maxima = kernels::VertexMaximaParams;
  return Dispatch<Maxima>(recorder, shaders::vertex_maxima, mesh.vertex_count())
      .read(&Maxima::angles, result.half_edge)
      .read(&Maxima::corner_offsets, mesh.corner_offsets())
      .read(&Maxima::corner_half_edges, mesh.corner_half_edges())
      .write(&Maxima::maxima, result.vertex_maximum, mesh.vertex_count())
      .record();
}

}  // namespace vkmesh
