// How far points lie from a triangle.
#pragma once

#include <algorithm>
#include <array>

#include <glm/geometric.hpp>

#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

using Triangle = std::array<DVec3, 3>;

inline double squared_distance_to_segment(const DVec3& p, const DVec3& a, const DVec3& b) {
  const DVec3 along = b - a, from_a = p - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? std::clamp(glm::dot(from_a, along) / length2, 0.0, 1.0) : 0.0;
  const DVec3 rest = from_a - t * along;
  return glm::dot(rest, rest);
}

/// To the plane where p lies over the triangle, else to the nearest edge: a triangle without area is its
/// edges.
inline double squared_distance(const DVec3& p, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const DVec3 normal = glm::cross(b - a, c - a);
  const double area2 = glm::dot(normal, normal);
  if (area2 > 0 && glm::dot(glm::cross(b - a, p - a), normal) >= 0 &&
      glm::dot(glm::cross(c - b, p - b), normal) >= 0 && glm::dot(glm::cross(a - c, p - c), normal) >= 0) {
    const double height = glm::dot(p - a, normal);
    return height * height / area2;
  }
  return std::min({squared_distance_to_segment(p, a, b), squared_distance_to_segment(p, b, c),
                   squared_distance_to_segment(p, c, a)});
}

}  // namespace vkmesh::detail
