// Bilateral smoothing against the formula in double precision, and against what it is for.
#include <algorithm>
#include <array>
#include <cmath>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/bilateral_smoothing.h>
#include <vkmesh/passes/laplacian_smoothing.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::cross;
using test::dot;
using test::length;

namespace {

// The paper's formula over all faces, without a grid.
std::vector<DVec3> textbook(const IndexedFaceSet& set, double spatial, double influence) {
  const std::vector<DVec3> points(set.points.begin(), set.points.end());
  std::vector<DVec3> centroids;
  std::vector<double> areas;
  const auto area_of = [&](const std::vector<DVec3>& p, std::size_t f) {
    const auto c = set.face(f);
    return cross(p[c[1]] - p[c[0]], p[c[2]] - p[c[0]]);
  };
  for (std::size_t f = 0; f < set.face_count(); ++f) {
    const auto c = set.face(f);
    centroids.push_back((points[c[0]] + points[c[1]] + points[c[2]]) / 3.0);
    areas.push_back(length(area_of(points, f)) / 2);
  }
  const auto gaussian = [](double x, double width) { return std::exp(-x * x / (2 * width * width)); };
  std::vector<DVec3> mollified = points, result = points;
  for (std::size_t v = 0; v < points.size(); ++v) {
    DVec3 sum(0.0);
    double total = 0;
    for (std::size_t f = 0; f < centroids.size(); ++f) {
      const double distance = length(centroids[f] - points[v]);
      if (distance >= spatial) continue;
      const double weight = areas[f] * gaussian(distance, spatial / 2);
      sum += weight * centroids[f];
      total += weight;
    }
    if (total > 0) mollified[v] = sum / total;
  }
  for (std::size_t v = 0; v < points.size(); ++v) {
    DVec3 sum(0.0);
    double total = 0;
    for (std::size_t f = 0; f < centroids.size(); ++f) {
      const double distance = length(centroids[f] - points[v]);
      if (distance >= 2 * spatial) continue;
      const DVec3 area = area_of(mollified, f), normal = area / length(area);
      const DVec3 prediction = points[v] - dot(points[v] - centroids[f], normal) * normal;
      const double weight =
          areas[f] * gaussian(distance, spatial) * gaussian(length(prediction - points[v]), influence);
      sum += weight * prediction;
      total += weight;
    }
    if (total > 0) result[v] = sum / total;
  }
  return result;
}

}  // namespace

TEST_CASE("bilateral smoothing agrees with the paper's formula in double precision") {
  std::vector<IndexedFaceSet> shapes = {test::icosphere(3), test::torus(30, 16), test::grid(14, 9),
                                        test::fine_cube(6)};
  std::uint32_t seed = 0;
  for (IndexedFaceSet& set : shapes) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    test::jitter(set, 0.05f * static_cast<float>(mean_edge_length(mesh, set.points)), ++seed);
    double shortest = 1e9, largest = 0;
    mesh.for_each_edge([&](HalfEdgeId h) {
      const auto [a, b] = mesh.vertices_of_edge(h);
      shortest = std::min(shortest, length(DVec3(set.points[a.index]) - DVec3(set.points[b.index])));
    });
    for (const Vec3& p : set.points) largest = std::max(largest, length(DVec3(p)));
    const double edge = mean_edge_length(mesh, set.points);
    for (const auto& [spatial, influence] : {std::pair{1.5, 0.4}, std::pair{3.0, 1.0}, std::pair{4.0, 8.0}}) {
      const BilateralSmoothingOptions options{static_cast<float>(spatial * edge),
                                              static_cast<float>(influence * edge)};
      const auto smoothed = bilateral_smoothing(mesh, set.points, options);
      REQUIRE(smoothed);
      const auto expected = textbook(set, options.spatial, options.influence);
      // Mollified positions are rounded a few times, which turns normals by their share of an edge (shorter
      // still once mollified) and moves predictions by that times 2 σ_f; the influence weighs that by σ_f /
      // σ_g.
      const double tolerance =
          64 * 0x1p-23 * (largest / shortest) * 2 * options.spatial * (1 + spatial / influence);
      REQUIRE(tolerance < 0.02 * edge);
      double worst = 0, moved = 0;
      for (std::size_t v = 0; v < expected.size(); ++v) {
        worst = std::max(worst, length(DVec3((*smoothed)[v]) - expected[v]));
        moved = std::max(moved, length(DVec3(set.points[v]) - expected[v]));
      }
      INFO("shape " << seed << ": " << worst / edge << " of " << moved / edge << " edges");
      CHECK(worst < tolerance);
      CHECK(moved > 4 * tolerance);
    }
  }
}

TEST_CASE("bilateral smoothing of a noisy cube keeps its edges, where Laplacian smoothing rounds them") {
  const int n = 24;
  IndexedFaceSet set = test::fine_cube(n);
  const std::vector<Vec3> clean = set.points;
  const HalfEdgeMesh mesh = test::half_edges(set);
  const float edge = 1.0f / n;
  test::jitter(set, 0.15f * edge, 5);
  // How far from the surface of the cube, as root mean squares: near its edges, and on its sides.
  struct Deviation {
    double edges = 0, sides = 0;
  };
  const auto deviation = [&](const std::vector<Vec3>& points) {
    Deviation sum;
    double edges = 0, sides = 0;
    for (std::size_t v = 0; v < points.size(); ++v) {
      // To each side's plane, positive inside; the middle one tells how near an edge is.
      std::array<double, 3> inside{}, was{};
      for (int k = 0; k < 3; ++k) {
        inside[static_cast<std::size_t>(k)] = 0.5 - std::fabs(double{points[v][k]} - 0.5);
        was[static_cast<std::size_t>(k)] = 0.5 - std::fabs(double{clean[v][k]} - 0.5);
      }
      std::sort(inside.begin(), inside.end());
      std::sort(was.begin(), was.end());
      const bool near_edge = was[1] < 1.5 * double{edge};
      (near_edge ? sum.edges : sum.sides) += inside[0] * inside[0];
      (near_edge ? edges : sides) += 1;
    }
    return Deviation{std::sqrt(sum.edges / edges) / double{edge},
                     std::sqrt(sum.sides / sides) / double{edge}};
  };
  const auto bilateral = bilateral_smoothing(mesh, set.points, {2.0f * edge, 0.25f * edge});
  REQUIRE(bilateral);
  const auto laplacian = laplacian_smoothing(node_neighbours(mesh).value(), set.points, {.iterations = 10});
  REQUIRE(laplacian);
  const Deviation noise = deviation(set.points), kept = deviation(*bilateral),
                  rounded = deviation(*laplacian);
  INFO("edges: noise " << noise.edges << ", bilateral " << kept.edges << ", Laplacian " << rounded.edges
                       << "; sides: " << noise.sides << ", " << kept.sides << ", " << rounded.sides);
  CHECK(kept.sides < noise.sides / 2);
  CHECK(kept.edges < noise.edges);
  CHECK(rounded.edges > 3 * kept.edges);
}

TEST_CASE("bilateral smoothing with a large influence smooths features too") {
  const IndexedFaceSet set = test::fine_cube(12);
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto corner = [&](float influence) {
    const auto smoothed = bilateral_smoothing(mesh, set.points, {0.25f, influence});
    REQUIRE(smoothed);
    return length(DVec3((*smoothed)[0]) - DVec3(set.points[0]));
  };
  REQUIRE(set.points[0] == Vec3(0.0f));
  CHECK(corner(0.5f) > 2 * corner(0.01f));
}

TEST_CASE("bilateral smoothing leaves planes alone, does not depend on the unit, and is the same each time") {
  const IndexedFaceSet plane = test::grid(9, 9);
  CHECK(bilateral_smoothing(test::half_edges(plane), plane.points, {3.0f, 1.0f}).value() == plane.points);
  IndexedFaceSet set = test::icosphere(4);
  test::jitter(set, 0.01f, 2);
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto smoothed = bilateral_smoothing(mesh, set.points, {0.25f, 0.125f}).value();
  CHECK(bilateral_smoothing(mesh, set.points, {0.25f, 0.125f}).value() == smoothed);
  for (const float unit : {0x1p-20f, 0x1p35f}) {
    std::vector<Vec3> scaled = set.points, expected = smoothed;
    for (Vec3& p : scaled) p *= unit;
    for (Vec3& p : expected) p *= unit;
    CHECK(bilateral_smoothing(mesh, scaled, {0.25f * unit, 0.125f * unit}).value() == expected);
  }
}

TEST_CASE("bilateral smoothing: degenerate triangles, isolated vertices, meshes without faces") {
  IndexedFaceSet set = test::icosphere(3);
  set.points.emplace_back(0.5f, 0.5f, 0.7f);
  set.points[0] = set.points[1];
  set.points[7] = set.points[8];
  const auto smoothed = bilateral_smoothing(test::half_edges(set), set.points, {0.4f, 0.2f}).value();
  CHECK(smoothed.back() == set.points.back());
  for (const Vec3& p : smoothed) CHECK(length(DVec3(p)) < 1.1);
  // Nothing is near enough: all stay.
  CHECK(bilateral_smoothing(test::half_edges(set), set.points, {0.001f, 0.001f}).value() == set.points);
  // No triangle has an area.
  for (Vec3& p : set.points) p = Vec3(p.x, p.x, p.x);
  CHECK(bilateral_smoothing(test::half_edges(set), set.points, {0.4f, 0.2f}).value() == set.points);
  set.corners.clear();
  CHECK(bilateral_smoothing(test::half_edges(set), set.points, {0.4f, 0.2f}).value() == set.points);
}

TEST_CASE("bilateral smoothing: errors") {
  const IndexedFaceSet set = test::cube(), quads = test::quad_cube();
  const HalfEdgeMesh mesh = test::half_edges(set);
  for (const float bad : {0.0f, -1.0f, 0x1p41f, NAN}) {
    CHECK(bilateral_smoothing(mesh, set.points, {bad, 1.0f}).error().code == ErrorCode::kUsage);
    CHECK(bilateral_smoothing(mesh, set.points, {1.0f, bad}).error().code == ErrorCode::kUsage);
  }
  CHECK(bilateral_smoothing(mesh, set.points, {0x1p-25f, 1.0f}).error().code == ErrorCode::kUnsuitable);
  CHECK(bilateral_smoothing(mesh, std::span(set.points).first(7), {1.0f, 1.0f}).error().code ==
        ErrorCode::kUsage);
  CHECK(bilateral_smoothing(test::half_edges(quads), quads.points, {1.0f, 1.0f}).error().code ==
        ErrorCode::kUnsuitable);
  CHECK(bilateral_smoothing(mesh, set.points, {1.0f, 1.0f}, [](double) { return false; }).error().code ==
        ErrorCode::kInterrupted);
  CHECK(mean_edge_length(test::half_edges(test::grid(1, 1)), test::grid(1, 1).points) ==
        Approx((4 + std::sqrt(2.0)) / 5).epsilon(1e-12));
  CHECK(mean_edge_length(HalfEdgeMesh{}, {}) == 0.0);
}
