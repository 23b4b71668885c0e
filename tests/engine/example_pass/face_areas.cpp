#include "example_pass/face_areas.h"

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/arithmetic.h>

namespace vkmesh {

Result<std::vector<float>> face_areas(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    if (positions.size() != mesh.vertex_count())
      return fail(ErrorCode::kUsage, "face_areas takes one position for each vertex");
    VKMESH_CHECK(check_positions(positions));
    const std::span<const std::uint32_t> corners = mesh.origins();
    std::vector<float> areas(mesh.face_count());
    for (std::size_t f = 0; f < areas.size(); ++f)
      areas[f] = 0.5f * vector_length(area_vector(positions[corners[3 * f]], positions[corners[3 * f + 1]],
                                                  positions[corners[3 * f + 2]]));
    return areas;
  });
}

}  // namespace vkmesh
