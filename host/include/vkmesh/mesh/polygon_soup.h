// Polygons that carry their own corners, as STL files do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/channel.h>

namespace vkmesh {

/// A polygon soup: no notion of whether two corners are one point. `weld` gives it one.
struct VKMESH_API PolygonSoup {
  std::vector<Vec3> corners;                ///< Position of every corner, face after face.
  std::vector<std::uint32_t> face_offsets;  ///< As in IndexedFaceSet: empty means triangles.
  std::vector<Channel> face_channels;       ///< One element per face (STL: "normal", "attribute").

  [[nodiscard]] std::size_t face_count() const {
    return face_offsets.empty() ? corners.size() / 3 : face_offsets.size() - 1;
  }
};

}  // namespace vkmesh
