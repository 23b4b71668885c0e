#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/connected_components.h>

#include "base/disjoint_sets.h"

namespace vkmesh {

Result<FaceComponents> face_components(const HalfEdgeMesh& mesh) {
  return detail::catching([&]() -> Result<FaceComponents> {
    detail::DisjointSets sets(mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (const FaceId g : mesh.faces_around(FaceId(f)))
        if (g.valid() && g.index < f) sets.unite(f, g.index);
    detail::NumberedSets numbered = detail::number_sets(sets);
    return FaceComponents{std::move(numbered.of), std::move(numbered.sizes)};
  });
}

}  // namespace vkmesh
