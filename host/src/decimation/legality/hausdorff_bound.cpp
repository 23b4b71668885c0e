#include "decimation/legality/hausdorff_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/geometric.hpp>

namespace vkmesh::detail {
namespace {

/// Twice an area, in local units, below which a corner counts as on the line.
constexpr double kOnLine = 1e-15;

}  // namespace

/// Squared: how far a polygon reaches from a triangle.
double Overlay::reach2(const Polygon& polygon, const Triangle& triangle) {
  double most = 0;
  for (std::size_t k = 0; k < polygon.size; ++k)
    most = std::max(most, squared_distance(polygon.corner[k], triangle));
  return most;
}

/// `inside`: what of the polygon lies over the triangle. The rest, in convex parts, comes to rest_.
void Overlay::split(const Polygon& polygon, const Triangle& by, const DVec3& up, Polygon& inside) {
  inside = polygon;
  std::array<double, Polygon::kMaxCorners> side;
  const auto measure = [&](const Polygon& part, std::size_t e) {
    const DVec3 &a = by[e], along = by[(e + 1) % 3] - a, across = glm::cross(up, along);
    double most = -std::numeric_limits<double>::infinity(), least = -most;
    for (std::size_t k = 0; k < part.size; ++k) {
      side[k] = glm::dot(across, part.corner[k] - a);
      most = std::max(most, side[k]);
      least = std::min(least, side[k]);
    }
    return std::array{least, most};
  };
  for (std::size_t e = 0; e < 3; ++e)
    if (measure(polygon, e)[1] <= kOnLine) {
      rest_.push_back(polygon);
      inside.size = 0;
      return;
    }
  for (std::size_t e = 0; e < 3; ++e) {
    const auto [least, most] = measure(inside, e);
    if (least >= -kOnLine) continue;
    if (most <= kOnLine || inside.size + 1 >= Polygon::kMaxCorners) {
      rest_.push_back(inside);
      inside.size = 0;
      return;
    }
    Polygon in, out;
    for (std::size_t k = 0; k < inside.size; ++k) {
      const std::size_t next = k + 1 < inside.size ? k + 1 : 0;
      const DVec3 &p = inside.corner[k], &q = inside.corner[next];
      if (side[k] >= -kOnLine) in.add(p);
      if (side[k] <= kOnLine) out.add(p);
      if ((side[k] > kOnLine && side[next] < -kOnLine) || (side[k] < -kOnLine && side[next] > kOnLine)) {
        const DVec3 crossing = p + (side[k] / (side[k] - side[next])) * (q - p);
        in.add(crossing);
        out.add(crossing);
      }
    }
    rest_.push_back(out);
    inside = in;
  }
}

void Overlay::begin(const Triangle& triangle) {
  Polygon whole;
  for (const DVec3& p : triangle) whole.add(p);
  left_.assign(1, whole);
}

double Overlay::take(const Triangle& triangle, const DVec3& up) {
  rest_.clear();
  double most = -1;
  Polygon inside;
  for (const Polygon& polygon : left_) {
    split(polygon, triangle, up, inside);
    if (inside.size > 0) most = std::max(most, reach2(inside, triangle));
  }
  std::swap(left_, rest_);
  return most < 0 ? -1 : std::sqrt(most);
}

std::pair<std::size_t, double> Overlay::nearest(const Polygon& polygon,
                                                std::span<const LocalChange::Face> to) {
  std::pair<std::size_t, double> best{0, std::numeric_limits<double>::infinity()};
  for (std::size_t j = 0; j < to.size(); ++j)
    if (const double d = reach2(polygon, to[j].corner); d < best.second) best = {j, d};
  return {best.first, std::sqrt(best.second)};
}

}  // namespace vkmesh::detail
