#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/math/bounds.h>

using namespace vkmesh;

TEST_CASE("bounds: a box holds what was added, and nothing more", "[bounds]") {
  Bounds bounds;
  CHECK(bounds.empty());
  CHECK(bounds.diagonal() == 0);
  const std::vector<Vec3> points = {{1, 5, -2}, {3, 4, -2}, {2, 7, -8}};
  for (const Vec3& p : points) bounds.add(p);
  CHECK_FALSE(bounds.empty());
  CHECK(bounds.low == Vec3(1, 4, -8));
  CHECK(bounds.high == Vec3(3, 7, -2));
  CHECK(bounds.extent() == Vec3(2, 3, 6));
  CHECK(bounds.longest_axis() == 2);
  CHECK(bounds.diagonal() == 7);
  const Bounds same = bounds_of(points);
  CHECK((same.low == bounds.low && same.high == bounds.high));

  Bounds joined = bounds_of(std::vector{points[0]});
  CHECK(joined.diagonal() == 0);
  CHECK(joined.longest_axis() == 0);
  joined += Bounds{};
  CHECK((joined.low == points[0] && joined.high == points[0]));
  joined += bounds_of(std::vector{points[1], points[2]});
  CHECK((joined.low == bounds.low && joined.high == bounds.high));
}

TEST_CASE("bounds: the distance of a point to a box is that to its nearest point", "[bounds]") {
  const DBounds box{{0, 0, 0}, {1, 2, 3}};
  CHECK(box.squared_distance({0.5, 1, 3}) == 0);
  CHECK(box.squared_distance({-2, 1, 1}) == 4);
  CHECK(box.squared_distance({2, 4, 1}) == 5);
  CHECK(box.squared_distance({2, 4, -2}) == 9);
}
