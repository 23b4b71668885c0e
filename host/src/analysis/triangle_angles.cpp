#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include <vkmesh/analysis/triangle_angles.h>

namespace vkmesh {
namespace {

double least_angle(const DVec3& a, const DVec3& b, const DVec3& c) {
  const double area = glm::length(glm::cross(b - a, c - a));
  if (!(area > 0)) return 0;
  return std::min({std::atan2(area, glm::dot(b - a, c - a)), std::atan2(area, glm::dot(c - b, a - b)),
                   std::atan2(area, glm::dot(a - c, b - c))});
}

}  // namespace

Result<TriangleAngles> triangle_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  if (!mesh.is_triangles()) return fail(ErrorCode::kUnsuitable, "triangle_angles takes triangles only");
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "triangle_angles takes one position for each vertex");
  TriangleAngles result;
  const auto corners = mesh.origins();
  const std::size_t faces = mesh.face_count();
  if (faces == 0) return result;
  constexpr double kDegree = std::numbers::pi / 180;
  result.least = std::numbers::pi;
  for (std::size_t f = 0; f < faces; ++f) {
    const double angle = least_angle(DVec3(positions[corners[3 * f]]), DVec3(positions[corners[3 * f + 1]]),
                                     DVec3(positions[corners[3 * f + 2]]));
    result.least = std::min(result.least, angle);
    result.mean += angle;
    result.below_5_degrees += angle < 5 * kDegree ? 1 : 0;
    result.below_30_degrees += angle < 30 * kDegree ? 1 : 0;
  }
  result.mean /= static_cast<double>(faces);
  return result;
}

}  // namespace vkmesh
