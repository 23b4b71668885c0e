#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/mesh_walks.h>

namespace vkmesh {

Result<FaceComponents> face_components(const HalfEdgeMesh& mesh) {
  return detail::catching([&]() -> Result<FaceComponents> {
    FaceComponents result;
    result.of_face.assign(mesh.face_count(), kInvalid);
    std::vector<FaceId> open;
    for (std::uint32_t seed = 0; seed < mesh.face_count(); ++seed) {
      if (result.of_face[seed] != kInvalid) continue;
      const auto number = static_cast<std::uint32_t>(result.faces.size());
      std::size_t faces = 0;
      result.of_face[seed] = number;
      open.assign(1, FaceId(seed));
      while (!open.empty()) {
        const FaceId f = open.back();
        open.pop_back();
        ++faces;
        for (const FaceId g : mesh.faces_around(f))
          if (g.valid() && result.of_face[g.index] == kInvalid) {
            result.of_face[g.index] = number;
            open.push_back(g);
          }
      }
      result.faces.push_back(faces);
    }
    return result;
  });
}

}  // namespace vkmesh
