// The coordinates that decimation works in.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include <vkmesh/base/result.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/math/vec.h>

#include "base/parallel.h"

namespace vkmesh::detail {

/// Where the mesh was: local = (input - centre) · scale, the scale a power of two.
struct Frame {
  DVec3 centre{0.0};
  double scale = 1;
  double diagonal = 0;  // of the bounding box, in units of the input
};

/// The frame of the points for which is_used(number), called on any threads, is true. All points must be
/// finite: else kUnsuitable.
template <class Point, class IsUsed>
Result<Frame> frame_of(std::span<const Point> points, IsUsed&& is_used) {
  struct Seen {
    DBounds bounds;
    bool finite = true;
    Seen& operator+=(const Seen& other) {
      bounds += other.bounds;
      finite &= other.finite;
      return *this;
    }
  };
  const auto seen = parallel_sum<Seen>(points.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    Seen part;
    for (std::size_t v = begin; v < end; ++v) {
      const Point& p = points[v];
      part.finite &= std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      if (is_used(v)) part.bounds.add(DVec3(p));
    }
    return part;
  });
  if (!seen.finite) return fail(ErrorCode::kUnsuitable, "decimation needs finite positions");
  Frame frame;
  if (seen.bounds.empty()) return frame;  // nothing is used
  const DVec3 &low = seen.bounds.low, size = seen.bounds.extent();
  const double largest = std::max({size.x, size.y, size.z});
  if (!std::isfinite(largest))
    return fail(ErrorCode::kUnsuitable, "decimation needs a mesh of finite extent");
  for (int k = 0; k < 3; ++k) frame.centre[k] = low[k] + 0.5 * size[k];
  if (largest > 0) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    exponent = std::clamp(exponent, -1000, 1000);
    frame.scale = std::ldexp(1.0, -exponent);
    const DVec3 s = size * frame.scale;
    frame.diagonal = std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z) / frame.scale;
  }
  return frame;
}

/// In local coordinates.
template <class Point>
std::array<float, 3> local_of(const Point& point, const Frame& frame) {
  std::array<float, 3> x;
  for (int k = 0; k < 3; ++k)
    x[static_cast<std::size_t>(k)] =
        static_cast<float>((static_cast<double>(point[k]) - frame.centre[k]) * frame.scale);
  return x;
}

template <class Point>
Point point_of(const std::array<float, 3>& local, const Frame& frame) {
  Point point;
  for (int k = 0; k < 3; ++k)
    point[k] = static_cast<typename Point::value_type>(
        frame.centre[k] + static_cast<double>(local[static_cast<std::size_t>(k)]) / frame.scale);
  return point;
}

}  // namespace vkmesh::detail
