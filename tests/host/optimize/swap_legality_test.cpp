#include "optimize/swap_legality.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include "support/shapes.h"

namespace vkmesh {
namespace {

using detail::SwapMesh;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Judges the edge from vertex 0 to vertex 1.
SwapReason judged(const IndexedFaceSet& set, const detail::SwapBounds& bounds = {kNone, kNone}) {
  SwapMesh mesh;
  REQUIRE(mesh.build(test::half_edges(set)));
  REQUIRE(
      detail::tag_kept_edges(mesh, std::vector<DVec3>(set.points.begin(), set.points.end()), {}).has_value());
  const std::vector<DVec3> points(set.points.begin(), set.points.end());
  std::uint32_t h = 0;
  while (h % 4 == 3 || mesh.origin(h) != 0 || mesh.target(h) != 1) ++h;
  return judge_swap(mesh, points, bounds, h);
}

/// Two triangles on the edge from vertex 0, at the origin, to vertex 1.
IndexedFaceSet quad(Vec3 q, Vec3 left, Vec3 right) {
  IndexedFaceSet set;
  set.points = {{0, 0, 0}, q, left, right};
  set.corners = {0, 1, 2, 1, 0, 3};
  return set;
}

}  // namespace

TEST_CASE("a swap is judged by the first condition that it fails", "[optimize]") {
  CHECK(judged(quad({2, 0, 0}, {1, 1, 0}, {1, -1, 0})) == SwapReason::kNone);
  // Boundary: the other edge of one face.
  IndexedFaceSet one = quad({2, 0, 0}, {1, 1, 0}, {1, -1, 0});
  one.corners.resize(3);
  CHECK(judged(one) == SwapReason::kBoundary);
  // Not convex, and just not strictly convex: vertex 1 lies on the new edge.
  CHECK(judged(quad({2, 0, 0}, {3, 1, 0}, {3, -1, 0})) == SwapReason::kNotConvex);
  CHECK(judged(quad({2, 0, 0}, {2, 1, 0}, {2, -1, 0})) == SwapReason::kNotConvex);
  // In the plane it is exact: a last bit decides.
  const float just = std::nextafter(2.0f, 0.0f);
  CHECK(judged(quad({2, 0, 0}, {just, 1, 0}, {just, -1, 0})) == SwapReason::kNone);
  // A steep ridge: one of the new faces turns by more than 90 degrees from one of the old.
  CHECK(judged(quad({2, 0, 0}, {2.5f, 1, -3}, {1, -1, -3})) == SwapReason::kFoldOver);
  CHECK(judged(quad({2, 0, 0}, {1, 1, -3}, {1, -1, -3})) == SwapReason::kNone);
  // A tetrahedron has all edges already.
  CHECK(judged(test::tetrahedron()) == SwapReason::kEdgeExists);
  // Bounds: the diagonals are 1 apart, and bent by a right angle each, one as a ridge and one as a valley.
  const IndexedFaceSet bent = quad({2, 0, 0}, {1, 1, -1}, {1, -1, -1});
  CHECK(judged(bent, {kNone, 1.001}) == SwapReason::kNone);
  CHECK(judged(bent, {kNone, 0.999}) == SwapReason::kDeviation);
  CHECK(judged(bent, {3.2, kNone}) == SwapReason::kNone);
  CHECK(judged(bent, {0.1, kNone}) == SwapReason::kDihedralChange);
}

}  // namespace vkmesh
