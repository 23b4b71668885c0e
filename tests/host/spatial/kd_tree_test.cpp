// Nearest neighbours against a look at every point.
#include "spatial/kd_tree.h"

#include <algorithm>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

using namespace vkmesh;

namespace {

float by_definition(const std::vector<Vec3>& points, std::uint32_t point, std::size_t k) {
  std::vector<float> distances;
  for (std::uint32_t q = 0; q < points.size(); ++q) {
    const Vec3 d = points[point] - points[q];
    if (q != point) distances.push_back(d.x * d.x + d.y * d.y + d.z * d.z);
  }
  std::sort(distances.begin(), distances.end());
  return distances.empty() ? 0.0f : distances[std::min(k, distances.size()) - 1];
}

}  // namespace

TEST_CASE("k-d tree: the k-th nearest neighbour is that of a search through all points", "[spatial]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-1, 1);
  for (const std::size_t count : {1u, 2u, 5u, 200u}) {
    std::vector<Vec3> points(count);
    // Flat in z, and some points in one place.
    for (Vec3& p : points) p = {place(random), place(random), 0.01f * place(random)};
    for (std::size_t i = 0; i < count / 4; ++i) points[2 * i] = points[2 * i + 1];
    const detail::KdTree<Vec3> tree(points);
    std::vector<float> heap;
    for (std::uint32_t p = 0; p < count; ++p)
      for (const std::size_t k : {1u, 3u, 8u})
        CHECK(tree.kth_squared_distance(p, k, heap) == by_definition(points, p, k));
  }
}

TEST_CASE("k-d tree: the points of a region are those that a look at each finds", "[spatial]") {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-1, 1);
  detail::KdTree<DVec3> tree;  // built anew for each
  for (const std::size_t count : {0u, 1u, 9u, 500u}) {
    std::vector<DVec3> points(count);
    for (DVec3& p : points) p = {place(random), place(random), 0};
    tree.build(points);
    for (int i = 0; i < 100; ++i) {
      const double least = place(random), most = least + 0.2;
      const auto is_inside = [&](const DVec3& p) { return p.x >= least && p.x <= most && p.y >= least; };
      std::size_t asked = 0, found = 0;
      const bool any = tree.any(
          [&](std::size_t, const DBounds& box) {
            return box.high.x < least || box.low.x > most || box.high.y < least;
          },
          [&](std::uint32_t p) {
            ++asked;
            found += is_inside(points[p]) ? 1 : 0;
            return false;
          });
      CHECK(!any);
      CHECK(found == static_cast<std::size_t>(std::count_if(points.begin(), points.end(), is_inside)));
      CHECK(asked <= found + count / 2 + 8);
      CHECK(tree.any([](std::size_t, const DBounds&) { return false; },
                     [&](std::uint32_t p) { return is_inside(points[p]); }) == (found > 0));
    }
  }
}
