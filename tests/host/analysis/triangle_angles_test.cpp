#include <numbers>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/triangle_angles.h>

#include "support/shapes.h"

namespace vkmesh {

TEST_CASE("least angles of triangles are those of known ones", "[analysis]") {
  constexpr double kDegree = std::numbers::pi / 180;
  IndexedFaceSet set;
  set.points = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {8, 0, 0}, {0, 0, 5}, {10, 0, 5}, {5, 0.4f, 5}};
  set.corners = {0, 1, 2, 4, 5, 6};
  const auto two = triangle_angles(test::half_edges(set), set.points);
  REQUIRE(two.has_value());
  const double right = std::atan2(3.0, 4.0), flat = std::atan2(0.4, 5.0);
  CHECK(two->least == Approx(flat).epsilon(1e-6));
  CHECK(two->mean == Approx((right + flat) / 2).epsilon(1e-6));
  CHECK(two->below_30_degrees == 1);
  CHECK(two->below_5_degrees == 1);
  // Whichever corner comes first.
  for (int turn = 0; turn < 2; ++turn) {
    set.corners = {set.corners[1], set.corners[2], set.corners[0],
                   set.corners[4], set.corners[5], set.corners[3]};
    CHECK(triangle_angles(test::half_edges(set), set.points)->mean == Approx(two->mean).epsilon(1e-12));
  }
  const auto tetrahedron = triangle_angles(test::half_edges(test::tetrahedron()), test::tetrahedron().points);
  REQUIRE(tetrahedron.has_value());
  CHECK(tetrahedron->below_30_degrees == 0);
  CHECK(tetrahedron->mean >= 45 * kDegree);

  set.corners = {0, 1, 3, 4, 5, 6};  // the first without area
  CHECK(triangle_angles(test::half_edges(set), set.points)->least == 0);
  const IndexedFaceSet none, quads = test::quad_cube();
  CHECK(triangle_angles(test::half_edges(none), none.points)->mean == 0);
  CHECK(triangle_angles(test::half_edges(quads), quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(triangle_angles(test::half_edges(set), {}).error().code == ErrorCode::kUsage);
}

}  // namespace vkmesh
