#include <cstddef>
#include <cstdint>
#include <string>

#include <vkmesh/handles.h>
#include <vkmesh/polygon_soup.h>

#include "catching.h"
#include "distinct_rows.h"

namespace vkmesh {

Result<IndexedFaceSet> weld(const PolygonSoup& soup) {
  return detail::catching([&]() -> Result<IndexedFaceSet> {
    if (soup.corners.size() >= kInvalid)
      return fail(ErrorCode::kUnsuitable,
                  std::to_string(soup.corners.size()) + " corners are more than 32-bit indices can number");
    IndexedFaceSet mesh;
    mesh.corners.resize(soup.corners.size());
    detail::DistinctRows<3> distinct;
    for (std::size_t c = 0; c < soup.corners.size(); ++c)
      mesh.corners[c] = distinct.number(&soup.corners[c][0], mesh.points);
    mesh.points.shrink_to_fit();
    mesh.face_offsets = soup.face_offsets;
    mesh.face_channels = soup.face_channels;
    mesh.normalize_offsets();
    return mesh;
  });
}

}  // namespace vkmesh
