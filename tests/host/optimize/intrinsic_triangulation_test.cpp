#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <vkmesh/optimize/intrinsic_triangulation.h>
#include <vkmesh/optimize/swap_edges.h>

#include "mesh/triangle_half_edges.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using detail::next_in_triangle;
using detail::previous_in_triangle;

IntrinsicTriangulation intrinsic(const IndexedFaceSet& set, double slack = 1e-6) {
  auto result = IntrinsicTriangulation::create(test::half_edges(set), set.points, slack);
  if (!result) FAIL(result.error().describe());
  return std::move(*result);
}

double area_of(const IntrinsicTriangulation& t) {
  double sum = 0;
  for (std::size_t f = 0; f < t.face_count(); ++f) {
    const double a = t.lengths()[3 * f], b = t.lengths()[3 * f + 1], c = t.lengths()[3 * f + 2],
                 s = (a + b + c) / 2;
    sum += std::sqrt(std::max(0.0, s * (s - a) * (s - b) * (s - c)));
  }
  return sum;
}

/// What holds for every triangulation of the surface that `first` triangulates.
void check(const IntrinsicTriangulation& t, const IntrinsicTriangulation& first) {
  REQUIRE(t.half_edge_count() == first.half_edge_count());
  std::vector<double> sums(t.vertex_count(), 0);
  for (std::uint32_t h = 0; h < t.half_edge_count(); ++h) {
    const std::uint32_t twin = t.twins()[h];
    REQUIRE(t.lengths()[h] < t.lengths()[next_in_triangle(h)] + t.lengths()[previous_in_triangle(h)]);
    sums[t.origins()[h]] += t.corner_angle(h);
    if (twin == kInvalid) continue;
    REQUIRE(t.twins()[twin] == h);
    REQUIRE(t.origins()[twin] == t.origins()[next_in_triangle(h)]);
    REQUIRE(t.lengths()[twin] == t.lengths()[h]);
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    CHECK(t.angle_sums()[v] == first.angle_sums()[v]);
    CHECK(sums[v] == Approx(first.angle_sums()[v]).margin(1e-7));
  }
  CHECK(area_of(t) == Approx(area_of(first)).epsilon(1e-9));
  // Signposts: around a vertex, each half-edge leaves by the angle between after the one before.
  for (std::uint32_t h = 0; h < t.half_edge_count(); ++h) {
    const std::uint32_t after = t.twins()[previous_in_triangle(h)];
    if (after == kInvalid) continue;
    const double sum = t.angle_sums()[t.origins()[h]];
    const double turn = std::remainder(t.directions()[after] - t.directions()[h] - t.corner_angle(h), sum);
    REQUIRE(std::fabs(turn) < 1e-7);
  }
}

void check_delaunay(const IntrinsicTriangulation& t) {
  for (std::uint32_t h = 0; h < t.half_edge_count(); ++h)
    if (t.twins()[h] != kInvalid && t.twins()[h] / 3 != h / 3) CHECK(t.cotangent_sum(h) >= -1e-8);
}

}  // namespace

TEST_CASE("intrinsic flips keep the surface, and end with Delaunay edges", "[optimize]") {
  std::vector<IndexedFaceSet> shapes = test::noisy_shapes();
  for (IndexedFaceSet& shape : shapes) test::jitter(shape, 0.04f, 3);
  shapes.push_back(test::cube());
  shapes.push_back(test::tetrahedron());
  shapes.push_back(test::double_torus());
  std::size_t flips = 0;
  for (const IndexedFaceSet& shape : shapes) {
    const IntrinsicTriangulation first = intrinsic(shape);
    IntrinsicTriangulation t = first;
    check(t, first);
    const auto done = t.flip_to_delaunay();
    REQUIRE(done.has_value());
    CHECK(done->finished);
    flips += done->flips;
    check(t, first);
    check_delaunay(t);
    CHECK(t.flip_to_delaunay()->flips == 0);

    // Whatever it starts from, it ends alike: random flips first. Lengths come back, but for cocircular
    // points.
    IntrinsicTriangulation other = first;
    std::minstd_rand random(5);
    for (std::size_t i = 0; i < other.half_edge_count(); ++i) {
      const auto h = static_cast<std::uint32_t>(random() % other.half_edge_count());
      if (other.can_flip(h)) other.flip(h);
    }
    check(other, first);
    REQUIRE(other.flip_to_delaunay()->finished);
    check_delaunay(other);
    std::vector<double> a(t.lengths().begin(), t.lengths().end()),
        b(other.lengths().begin(), other.lengths().end());
    std::ranges::sort(a);
    std::ranges::sort(b);
    double sum_a = 0, sum_b = 0;
    for (const double x : a) sum_a += x;
    for (const double x : b) sum_b += x;
    CHECK(sum_a == Approx(sum_b).epsilon(1e-3));
  }
  CHECK(flips > 100);
}

TEST_CASE("a flat mesh has the Delaunay triangulation of the plane inside", "[optimize]") {
  IndexedFaceSet grid = test::grid(12, 9);
  test::jitter(grid, 0.3f, 7);
  for (Vec3& p : grid.points) p.z = 0.0f;
  IntrinsicTriangulation t = intrinsic(grid);
  REQUIRE(t.flip_to_delaunay()->flips > 20);
  SwapEdgesOptions options;
  options.costs = {{SwapCost::kDelaunay}};
  const auto plane = swap_edges(test::half_edges(grid), grid.points, options);
  REQUIRE(plane.has_value());
  const auto edges = [](std::span<const std::uint32_t> origins) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> all;
    for (std::uint32_t h = 0; h < origins.size(); ++h)
      all.emplace(std::min(origins[h], origins[next_in_triangle(h)]),
                  std::max(origins[h], origins[next_in_triangle(h)]));
    return all;
  };
  CHECK(edges(t.origins()) == edges(plane->mesh.origins()));
  for (std::uint32_t h = 0; h < t.half_edge_count(); ++h) {
    const Vec3 p = grid.points[t.origins()[h]], q = grid.points[t.origins()[next_in_triangle(h)]];
    CHECK(t.lengths()[h] == Approx(glm::length(DVec3(q) - DVec3(p))).epsilon(1e-9));
  }
}

TEST_CASE("flips across the edge of a box have the lengths of its unfolding", "[optimize]") {
  // Two faces of a cube: the path between far corners over the edge has length sqrt(1 + 4).
  IndexedFaceSet set;
  set.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 1, 1}, {0, 1, 1}};
  set.corners = {0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 4, 5};
  IntrinsicTriangulation t = intrinsic(set);
  std::uint32_t edge = 0;
  while (!(t.origins()[edge] == 2 && t.origins()[next_in_triangle(edge)] == 3)) ++edge;
  REQUIRE(t.can_flip(edge));
  t.flip(edge);
  CHECK(t.lengths()[edge] == Approx(std::sqrt(5.0)));
  CHECK(std::set{t.origins()[edge], t.origins()[next_in_triangle(edge)]} == std::set<std::uint32_t>{0, 4});
}

TEST_CASE("intrinsic triangulations of degenerate surfaces are defined", "[optimize]") {
  for (const auto& [name, shape] : test::degenerate_shapes()) {
    CAPTURE(name);
    IntrinsicTriangulation t = intrinsic(shape);
    const auto done = t.flip_to_delaunay();
    REQUIRE(done.has_value());
    CHECK(done->finished);
    for (const double length : t.lengths()) CHECK(std::isfinite(length));
    for (const double direction : t.directions()) CHECK(std::isfinite(direction));
  }
  const IndexedFaceSet cube = test::cube(), quads = test::quad_cube(), none;
  CHECK(intrinsic(none).flip_to_delaunay()->flips == 0);
  const HalfEdgeMesh mesh = test::half_edges(cube);
  CHECK(IntrinsicTriangulation::create(mesh, {}).error().code == ErrorCode::kUsage);
  CHECK(IntrinsicTriangulation::create(mesh, cube.points, -1).error().code == ErrorCode::kUsage);
  CHECK(IntrinsicTriangulation::create(mesh, cube.points, std::numeric_limits<double>::quiet_NaN())
            .error()
            .code == ErrorCode::kUsage);
  CHECK(IntrinsicTriangulation::create(test::half_edges(quads), quads.points).error().code ==
        ErrorCode::kUnsuitable);
  IndexedFaceSet noisy = test::torus(30, 20);
  test::jitter(noisy, 0.05f, 1);
  IntrinsicTriangulation t = intrinsic(noisy);
  CHECK(t.flip_to_delaunay([](double) { return false; }).error().code == ErrorCode::kInterrupted);
  // A sliver of no area gets some.
  IndexedFaceSet sliver;
  sliver.points = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  sliver.corners = {0, 1, 2, 1, 0, 3};
  IntrinsicTriangulation mended = intrinsic(sliver);
  CHECK(mended.added_length() > 0);
  CHECK(mended.flip_to_delaunay()->flips == 1);
}

}  // namespace vkmesh
