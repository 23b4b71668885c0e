#include <cstddef>

#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh {

void IndexedFaceSet::normalize_offsets() {
  for (std::size_t f = 0; f < face_offsets.size(); ++f)
    if (face_offsets[f] != 3 * f) return;
  face_offsets = {};
}

}  // namespace vkmesh
