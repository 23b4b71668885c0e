#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/vertex_corners.h>

#include "base/counting_sort.h"

namespace vkmesh {

Result<VertexCorners> vertex_corners(const HalfEdgeMesh& mesh) {
  return detail::catching([&]() -> Result<VertexCorners> {
    const auto origin = mesh.origins();
    VertexCorners result;
    result.half_edges.resize(origin.size());
    result.offsets = detail::counting_sort(
        mesh.vertex_count(), origin.size(), [&](std::size_t h) { return origin[h]; },
        [&](std::uint32_t slot, std::size_t h) { result.half_edges[slot] = static_cast<std::uint32_t>(h); });
    return result;
  });
}

}  // namespace vkmesh
