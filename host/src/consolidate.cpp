#include <utility>

#include <vkmesh/consolidate.h>

#include "catching.h"
#include "edge_matching.h"

namespace vkmesh {

Result<Consolidated> consolidate(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<Consolidated> {
    VKMESH_TRY(detail::Matching matching,
               detail::match_edges(mesh.points.size(), mesh.corners, mesh.face_offsets));
    if (!matching.report.manifold())
      return fail(ErrorCode::kUnsuitable, "not an oriented manifold mesh: " + matching.report.defects);
    return Consolidated{HalfEdgeMesh::from_arrays(mesh.corners, std::move(matching.twin),
                                                  std::move(matching.leading), mesh.face_offsets),
                        std::move(matching.report)};
  });
}

Result<ConsolidateReport> survey(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<ConsolidateReport> {
    VKMESH_TRY(detail::Matching matching,
               detail::match_edges(mesh.points.size(), mesh.corners, mesh.face_offsets));
    return std::move(matching.report);
  });
}

}  // namespace vkmesh
