// Connected components of the faces of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// The edge-connected components of a mesh, in ascending order of their first faces.
struct FaceComponents {
  std::vector<std::uint32_t> of_face;  ///< The number of each face's component.
  std::vector<std::size_t> faces;      ///< The number of faces of each component.
};
/// O(half-edges). Errors: kOutOfMemory.
[[nodiscard]] VKMESH_API Result<FaceComponents> face_components(const HalfEdgeMesh& mesh);

}  // namespace vkmesh
