// Volumes before and after in double precision.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/restore_volume.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::area_of;
using test::dot;
using test::length;

namespace {

struct Solid {
  double area = 0, volume = 0, extent = 0, farthest = 0;
  DVec3 centroid{0.0};  // The surface's.
};

Solid solid_of(IndexedFaceSet set, const std::vector<Vec3>& points) {
  set.points = points;
  Solid solid;
  DVec3 low(points[0]), high = low;
  for (const Vec3& p : points) {
    solid.farthest = std::max(solid.farthest, length(DVec3(p)));
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], double{p[k]});
      high[k] = std::max(high[k], double{p[k]});
    }
  }
  solid.extent = length(high - low);
  for (std::size_t f = 0; f < set.face_count(); ++f) {
    const auto c = set.face(f);
    const DVec3 twice = area_of(set, f), p(points[c[0]]), q(points[c[1]]), r(points[c[2]]);
    solid.area += length(twice) / 2;
    // About the middle: farther away the sum would cancel.
    solid.volume += dot(p - 0.5 * (low + high), twice) / 6;
    solid.centroid += length(twice) / 6 * (p + q + r);
  }
  solid.centroid /= solid.area;
  return solid;
}

// By how much the reference's sums may be off, each from 64 roundings a level of parts as large as the area
// times the extent: see the test of surface_measures().
constexpr double kSums = 64 * 0x1p-23;

std::vector<Vec3> smoothed(const HalfEdgeMesh& mesh, const std::vector<Vec3>& points) {
  return laplacian_smoothing(node_neighbours(mesh).value(), points, {.iterations = 5}).value();
}

}  // namespace

TEST_CASE("restored volume is the one before, about the centroid, wherever the mesh lies") {
  IndexedFaceSet shapes[] = {test::icosphere(4), test::torus(40, 20), test::double_torus(),
                             test::fine_cube(12)};
  std::uint32_t seed = 0;
  for (IndexedFaceSet& shape : shapes) {
    test::jitter(shape, 0.02f, ++seed);
    const HalfEdgeMesh mesh = test::half_edges(shape);
    for (const Vec3 offset : {Vec3(0.0f), Vec3(-3, 5, 20), Vec3(512, -300, 700)}) {
      std::vector<Vec3> points = shape.points;
      for (Vec3& p : points) p += offset;
      const std::vector<Vec3> shrunk = smoothed(mesh, points);
      const auto restored = restore_volume(mesh, points, shrunk);
      REQUIRE(restored);
      const Solid before = solid_of(shape, points), after = solid_of(shape, shrunk),
                  now = solid_of(shape, *restored);
      // Both sums, as shares of their volumes; then each coordinate of the result is rounded three times,
      // which moves the surface by as much.
      const double roundings = 3 * 0x1p-24 * (now.farthest + now.extent);
      const double share =
          kSums * (before.area * before.extent / before.volume + after.area * after.extent / after.volume);
      const double tolerance = before.volume * share + now.area * roundings;
      INFO("shape " << seed << ": volumes " << before.volume << ", " << after.volume << ", " << now.volume
                    << "; tolerance " << tolerance);
      CHECK(std::fabs(now.volume - before.volume) < tolerance);
      CHECK(std::fabs(after.volume - before.volume) > 20 * tolerance);
      // The centroid in use is off by the sums' share of the extent, and stays where it is.
      const double factor = std::cbrt(before.volume / after.volume);
      const double off_centre = kSums * after.extent * std::fabs(factor - 1) + roundings;
      CHECK(length(now.centroid - after.centroid) < 2 * off_centre);
      double worst = 0;
      for (std::size_t v = 0; v < points.size(); ++v) {
        const DVec3 expected = after.centroid + factor * (DVec3(shrunk[v]) - after.centroid);
        worst = std::max(worst, length(DVec3((*restored)[v]) - expected));
      }
      CHECK(worst < factor * share / 3 * after.extent + 2 * off_centre);
    }
  }
}

TEST_CASE("restored volume does not depend on the unit of length") {
  IndexedFaceSet set = test::torus(30, 16);
  test::jitter(set, 0.03f, 3);
  const HalfEdgeMesh mesh = test::half_edges(set);
  const std::vector<Vec3> shrunk = smoothed(mesh, set.points);
  const std::vector<Vec3> restored = restore_volume(mesh, set.points, shrunk).value();
  CHECK(restored != shrunk);
  const auto times = [](std::vector<Vec3> points, float unit) {
    for (Vec3& p : points) p *= unit;
    return points;
  };
  for (const float unit : {0x1p-50f, 0x1p-20f, 0x1p57f})
    CHECK(restore_volume(mesh, times(set.points, unit), times(shrunk, unit)).value() ==
          times(restored, unit));
  // Units that differ between before and after, up to the ratio that is documented.
  for (const float unit : {0x1p-8f, 0x1p8f}) {
    const std::vector<Vec3> large = restore_volume(mesh, times(set.points, unit), shrunk).value();
    const double share = solid_of(set, large).volume / solid_of(set, set.points).volume /
                         (double{unit} * double{unit} * double{unit});
    CHECK(std::fabs(share - 1) < 1e-3);
  }
  for (const float unit : {0x1p-12f, 0x1p12f})
    CHECK(restore_volume(mesh, times(set.points, unit), shrunk).value() == shrunk);
}

TEST_CASE("restored volume: nothing moves where there is no volume, or one inside out") {
  const IndexedFaceSet set = test::icosphere(3);
  const HalfEdgeMesh mesh = test::half_edges(set);
  std::vector<Vec3> flat = set.points, mirrored = set.points, point(set.points.size(), Vec3(3.0f));
  for (Vec3& p : flat) p.z = 0.25f;
  for (Vec3& p : mirrored) p = Vec3(-0.75f * p.x, p.y, p.z);
  for (const auto& nothing : {flat, point, mirrored}) {
    CHECK(restore_volume(mesh, set.points, nothing).value() == nothing);
    CHECK(restore_volume(mesh, nothing, set.points).value() == set.points);
  }
  CHECK(restore_volume(mesh, flat, flat).value() == flat);
  // Inside out both, it is a volume like any other.
  std::vector<Vec3> half = mirrored;
  for (Vec3& p : half) p *= 0.75f;
  const auto restored = restore_volume(mesh, mirrored, half).value();
  for (std::size_t v = 0; v < restored.size(); ++v)
    CHECK(length(DVec3(restored[v]) - DVec3(mirrored[v])) < 64 * 0x1p-23);
  CHECK(restore_volume(HalfEdgeMesh{}, {}, {}).value().empty());
}

TEST_CASE("restored volume: isolated points move along, degenerate triangles do no harm") {
  IndexedFaceSet set = test::icosphere(3);
  set.points.emplace_back(0.5f, 0.25f, -0.5f);
  set.points[3] = set.points[4];
  const HalfEdgeMesh mesh = test::half_edges(set);
  std::vector<Vec3> half = set.points;
  for (Vec3& p : half) p *= 0.5f;
  const auto restored = restore_volume(mesh, set.points, half).value();
  const DVec3 centroid = solid_of(set, half).centroid;
  for (std::size_t v = 0; v < restored.size(); ++v)
    CHECK(length(DVec3(restored[v]) - (centroid + 2.0 * (DVec3(half[v]) - centroid))) < 64 * 0x1p-23);
}

TEST_CASE("restored volume: errors") {
  const IndexedFaceSet open = test::cylinder(3, 8), quads = test::quad_cube(), cube = test::cube();
  CHECK(restore_volume(test::half_edges(open), open.points, open.points).error().code ==
        ErrorCode::kUnsuitable);
  CHECK(restore_volume(test::half_edges(quads), quads.points, quads.points).error().code ==
        ErrorCode::kUnsuitable);
  const HalfEdgeMesh mesh = test::half_edges(cube);
  const auto few = std::span(cube.points).first(7);
  CHECK(restore_volume(mesh, few, cube.points).error().code == ErrorCode::kUsage);
  CHECK(restore_volume(mesh, cube.points, few).error().code == ErrorCode::kUsage);
  std::vector<Vec3> bad = cube.points;
  bad[2].y = NAN;
  CHECK(restore_volume(mesh, bad, cube.points).error().code == ErrorCode::kUnsuitable);
  CHECK(restore_volume(mesh, cube.points, bad).error().code == ErrorCode::kUnsuitable);
}
