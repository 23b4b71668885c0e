// Points and constraints to triangulate in tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/planar/constrained_delaunay.h>

namespace vkmesh::test {

class PlanarRandom {
 public:
  explicit PlanarRandom(std::uint64_t seed) : random_(seed) {}
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::size_t below(std::size_t n) { return random_() % n; }
  std::uint32_t index(std::size_t n) { return static_cast<std::uint32_t>(below(n)); }
  double whole(std::size_t n) { return static_cast<double>(below(n)); }
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::mt19937_64 random_;
};

struct ConstrainedInput {
  std::vector<DVec2> points;
  std::vector<PointPair> constraints;
};

/// Whether each lies on both sides of the other.
inline bool cross_properly(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
}

/// So many constraints between random points, none of which crosses another; half of them short.
inline void add_constraints(ConstrainedInput& input, std::size_t count, PlanarRandom& random) {
  const auto& p = input.points;
  for (std::size_t tried = 0; input.constraints.size() < count && tried < 20 * count; ++tried) {
    const std::uint32_t a = random.index(p.size());
    std::uint32_t b = random.index(p.size());
    const auto length = [&](std::uint32_t i) { return std::hypot(p[i].x - p[a].x, p[i].y - p[a].y); };
    if (tried % 2 == 0)
      for (int k = 0; k < 20; ++k)
        if (const std::uint32_t c = random.index(p.size()); length(c) > 0 && length(c) < length(b)) b = c;
    if (std::none_of(input.constraints.begin(), input.constraints.end(),
                     [&](PointPair e) { return cross_properly(p[a], p[b], p[e[0]], p[e[1]]); }))
      input.constraints.push_back({a, b});
  }
}

/// By name: random, degenerate and cocircular points, n of each.
inline std::map<std::string, std::vector<DVec2>> planar_points(std::size_t n) {
  std::map<std::string, std::vector<DVec2>> all;
  PlanarRandom random(n);
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  for (std::size_t i = 0; i < n; ++i) {
    const double x = random.unit(), y = random.unit(), a = 6.283185307179586 * x;
    const auto column = static_cast<double>(i % side), row = static_cast<double>(i / side);
    all["uniform"].emplace_back(x, y);
    all["grid"].emplace_back(column, row);
    all["tilted grid"].emplace_back(0.955 * column - 0.2955 * row, 0.2955 * column + 0.955 * row);
    all["circle"].emplace_back(std::cos(a), std::sin(a));
    all["walls"].emplace_back(std::floor(5 * x) / 5, y);
    all["duplicates"].emplace_back(random.whole(6), random.whole(6));
    all["map coordinates"].emplace_back(500000 + random.whole(1000) / 100,
                                        5400000 + random.whole(1000) / 100);
    all["subnormal"].push_back(DVec2(random.whole(20), random.whole(20)) * 0x1p-1074);
    all["spread"].emplace_back(std::ldexp(x, static_cast<int>(random.below(200)) - 100),
                               std::ldexp(y, static_cast<int>(random.below(200)) - 100));
  }
  for (auto& [name, points] : all) random.shuffle(points);
  return all;
}

}  // namespace vkmesh::test
