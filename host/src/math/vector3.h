// Three floats as loops over lanes and records of vertices take them.
#pragma once

#include <array>
#include <cmath>

namespace vkmesh::detail {

using Vector3 = std::array<float, 3>;

[[nodiscard, gnu::always_inline]] inline Vector3 minus(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard, gnu::always_inline]] inline Vector3 plus(const Vector3& a, const Vector3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[nodiscard, gnu::always_inline]] inline Vector3 times(float s, const Vector3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
[[nodiscard, gnu::always_inline]] inline float dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard, gnu::always_inline]] inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The cosine of the angle between two vectors; 1 where one has no length.
[[nodiscard]] inline float cosine(const Vector3& a, const Vector3& b) {
  const float lengths = std::sqrt(dot(a, a)) * std::sqrt(dot(b, b));
  return lengths > 0 ? dot(a, b) / lengths : 1.0f;
}

}  // namespace vkmesh::detail
