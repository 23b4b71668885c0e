// Angles in double precision, the same on every machine.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>

#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// The angle in [0, π/2] of the vector (x, y) for x, y ≥ 0, within 2 ULP; 0 for (0, 0). It takes + − × ÷
/// alone, so that it is the same on every machine: arctan t = arctan c + arctan((t − c) / (1 + t c)) for the
/// nearest c = k/16, and a series.
[[nodiscard]] inline double angle_in_first_quadrant(double y, double x) {
  constexpr std::array<double, 17> kArctan = {0x0.0p+0,
                                              0x1.ff55bb72cfdeap-5,
                                              0x1.fd5ba9aac2f6ep-4,
                                              0x1.7b97b4bce5b02p-3,
                                              0x1.f5b75f92c80ddp-3,
                                              0x1.362773707ebccp-2,
                                              0x1.6f61941e4def1p-2,
                                              0x1.a64eec3cc23fdp-2,
                                              0x1.dac670561bb4fp-2,
                                              0x1.0657e94db30d0p-1,
                                              0x1.1e00babdefeb4p-1,
                                              0x1.345f01cce37bbp-1,
                                              0x1.4978fa3269ee1p-1,
                                              0x1.5d58987169b18p-1,
                                              0x1.700a7c5784634p-1,
                                              0x1.819d0b7158a4dp-1,
                                              0x1.921fb54442d18p-1};
  const bool steep = y > x;
  const double high = steep ? y : x, low = steep ? x : y;
  if (!(high > 0)) return 0;
  const double t = low / high;
  const auto k = static_cast<std::size_t>(t * 16 + 0.5);
  const double c = static_cast<double>(k) / 16, r = (t - c) / (1 + t * c), s = r * r;
  // |r| ≤ 1/32: the first term left out is below 2^-60 of r.
  const double series = r * (1 + s * (-1.0 / 3 + s * (1.0 / 5 + s * (-1.0 / 7 + s * (1.0 / 9 - s / 11)))));
  const double angle = kArctan[k] + series;
  return steep ? std::numbers::pi / 2 - angle : angle;
}

/// The angle in [0, π] of the vector (x, y) for y ≥ 0.
[[nodiscard]] inline double angle_of(double y, double x) {
  return x < 0 ? std::numbers::pi - angle_in_first_quadrant(y, -x) : angle_in_first_quadrant(y, x);
}

/// v / |v|; zero where v has no length.
[[nodiscard]] inline DVec3 unit_or_zero(const DVec3& v) {
  const double length2 = glm::dot(v, v);
  return length2 > 0 ? v * (1 / std::sqrt(length2)) : DVec3(0.0);
}

/// The angle between the normals of two faces, unit or zero, in [0, π]; π where one is zero, so that a face
/// without area never looks flat. W. Kahan's 2 atan2(|a − b|, |a + b|).
[[nodiscard]] inline double angle_between_normals(const DVec3& a, const DVec3& b) {
  if (a == DVec3(0.0) || b == DVec3(0.0)) return std::numbers::pi;
  const DVec3 apart = a - b, along = a + b;
  return 2 * angle_in_first_quadrant(std::sqrt(glm::dot(apart, apart)), std::sqrt(glm::dot(along, along)));
}

}  // namespace vkmesh::detail
