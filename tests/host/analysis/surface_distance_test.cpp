#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <vkmesh/analysis/surface_distance.h>

#include "support/shapes.h"

namespace vkmesh {
namespace {

using test::icosphere;

TriangleSurface surface(const IndexedFaceSet& mesh) {
  return {mesh.points, mesh.corners};
}

SurfaceDistance distance(const IndexedFaceSet& a, const IndexedFaceSet& b, std::size_t samples = 20000) {
  SurfaceDistanceOptions options;
  options.samples = samples;
  const auto result = surface_distance(surface(a), surface(b), options);
  if (!result) FAIL(result.error().describe());
  return *result;
}

/// Nearest point on a triangle by projected gradient: minimises over barycentric coordinates on a fine
/// lattice, then on finer ones around the best. Shares nothing with the library's case analysis.
double brute_force(const DVec3& p, const DVec3& a, const DVec3& b, const DVec3& c) {
  double best = std::numeric_limits<double>::infinity(), best_u = 0, best_v = 0, step = 0.125;
  const auto visit = [&](double u, double v) {
    u = std::clamp(u, 0.0, 1.0);
    v = std::clamp(v, 0.0, 1.0 - u);
    const DVec3 d = a + u * (b - a) + v * (c - a) - p;
    const double d2 = d.x * d.x + d.y * d.y + d.z * d.z;
    if (d2 < best) {
      best = d2;
      best_u = u;
      best_v = v;
    }
  };
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j + i <= 8; ++j) visit(i * step, j * step);
  for (int round = 0; round < 40; ++round) {
    const double u = best_u, v = best_v;
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j) visit(u + i * step / 2, v + j * step / 2);
    step *= 0.6;
  }
  return std::sqrt(best);
}

}  // namespace

TEST_CASE("a surface has no distance from itself", "[distance]") {
  const IndexedFaceSet mesh = icosphere(3);
  const DistanceSummary both = distance(mesh, mesh).two_sided();
  // Samples are rounded to within a few units of 2^-53 of the radius 1.
  CHECK(both.maximum < 1e-15);
}

TEST_CASE("parallel planes lie apart by their distance", "[distance]") {
  const IndexedFaceSet low = test::grid(4, 3);
  IndexedFaceSet high = test::grid(7, 5);
  for (Vec3& p : high.points) p = Vec3(p.x * 4.0f / 7.0f, p.y * 3.0f / 5.0f, 0.25f);
  const SurfaceDistance d = distance(low, high);
  for (const DistanceSummary& side : {d.a_to_b, d.b_to_a, d.two_sided()}) {
    CHECK(side.mean == Approx(0.25).epsilon(1e-6));
    CHECK(side.root_mean_square == Approx(0.25).epsilon(1e-6));
    CHECK(side.maximum == Approx(0.25).epsilon(1e-6));
  }
  CHECK(d.diagonal == Approx(5.0));
}

TEST_CASE("a small surface beside a large one: the two directions differ as they should", "[distance]") {
  // The unit square against [0, 2] × [0, 1] in the same plane: 0 one way; the other way half the area lies at
  // x - 1, uniform in [0, 1]: mean 1/4, mean square 1/6, maximum 1.
  const IndexedFaceSet small = test::grid(1, 1), large = test::grid(2, 1);
  const SurfaceDistance d = distance(small, large, 100000);
  CHECK(d.a_to_b.maximum == 0);
  // Strata of equal area in the order of the faces leave an error of O(1 / sqrt(samples)) at worst: 0.003.
  CHECK(d.b_to_a.mean == Approx(0.25).margin(0.003));
  CHECK(d.b_to_a.root_mean_square == Approx(std::sqrt(1.0 / 6.0)).margin(0.003));
  CHECK(d.b_to_a.maximum <= 1.0);
  CHECK(d.b_to_a.maximum > 0.99);
  CHECK(d.two_sided().mean == Approx(d.b_to_a.mean / 2));
  CHECK(d.two_sided().maximum == d.b_to_a.maximum);
}

TEST_CASE("concentric spheres lie apart by the difference of their radii", "[distance]") {
  // Every icosphere point lies between (1 - sagitta) r and r. At level 4 the longest edge is < 0.085 r, the
  // longest circumradius < 0.05 r, the sagitta < 0.05² / 2 = 0.00125 r.
  const SurfaceDistance d = distance(icosphere(4, 1.0f), icosphere(4, 1.5f));
  for (const DistanceSummary& side : {d.a_to_b, d.b_to_a}) {
    CHECK(side.mean == Approx(0.5).margin(0.002));
    CHECK(side.maximum < 0.5 + 0.002);
    CHECK(side.maximum >= side.root_mean_square);
    CHECK(side.root_mean_square >= side.mean);
  }
}

TEST_CASE("surface distance agrees with a search over all triangles", "[distance]") {
  // A is one tiny triangle at a random place, so that its samples lie where we know.
  IndexedFaceSet b = icosphere(1);
  test::jitter(b, 0.3f, 5);
  // Triangles without area: a repeated point and three points on a line.
  b.points.insert(b.points.end(), {{2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {0, 3, 0}});
  const auto extra = static_cast<std::uint32_t>(b.points.size());
  b.corners.insert(b.corners.end(), {extra - 4, extra - 3, extra - 2, extra - 1, extra - 1, extra - 1});
  std::mt19937 random(9);
  const auto coordinate = [&] { return static_cast<float>(random() % 8192) / 1024.0f - 4.0f; };
  constexpr float kTiny = 1.0f / 1048576.0f;
  for (int i = 0; i < 300; ++i) {
    const Vec3 p(coordinate(), coordinate(), coordinate());
    IndexedFaceSet a;
    a.points = {p, {p.x + kTiny, p.y, p.z}, {p.x, p.y + kTiny, p.z}};
    a.corners = {0, 1, 2};
    double expected = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < b.face_count(); ++f) {
      const DVec3 q(b.points[b.face(f)[0]]), r(b.points[b.face(f)[1]]), s(b.points[b.face(f)[2]]);
      // No point of a triangle lies farther from a corner than another corner does.
      if (glm::distance(DVec3(p), q) - std::max(glm::distance(q, r), glm::distance(q, s)) > expected)
        continue;
      expected = std::min(expected, brute_force(DVec3(p), q, r, s));
    }
    // Samples lie within 2 kTiny of p, and the search ends with steps of 0.125 · 0.6^40 < 1e-9.
    CHECK(distance(a, b, 3).a_to_b.mean == Approx(expected).epsilon(0).margin(2.5 * kTiny));
  }
}

TEST_CASE("samples fall on a surface by area, whatever its triangles", "[distance]") {
  // [0, 1] × [0, 1] of 2 faces beside [1, 2] × [0, 1] of 5000, against the plane through the origin at 45
  // degrees: mean distance = mean of x / sqrt 2 = 1 / sqrt 2.
  IndexedFaceSet a = test::grid(1, 1);
  IndexedFaceSet fine = test::grid(50, 50);
  for (const Vec3& p : fine.points) a.points.emplace_back(1.0f + p.x / 50.0f, p.y / 50.0f, 0.0f);
  for (const std::uint32_t corner : fine.corners) a.corners.push_back(corner + 4);
  IndexedFaceSet b;
  b.points = {{-9, -20, -9}, {9, -20, 9}, {9, 20, 9}, {-9, 20, -9}};
  b.corners = {0, 1, 2, 0, 2, 3};
  CHECK(distance(a, b, 50000).a_to_b.mean == Approx(std::sqrt(0.5)).epsilon(0.003));
}

TEST_CASE("the same seed gives the same distances, another seed others", "[distance]") {
  IndexedFaceSet a = icosphere(2), b = icosphere(2);
  test::jitter(b, 0.05f, 2);
  const auto first = surface_distance(surface(a), surface(b), {1000, 1});
  const auto again = surface_distance(surface(a), surface(b), {1000, 1});
  const auto other = surface_distance(surface(a), surface(b), {1000, 2});
  REQUIRE((first && again && other));
  CHECK(first->a_to_b.mean == again->a_to_b.mean);
  CHECK(first->b_to_a.maximum == again->b_to_a.maximum);
  CHECK(first->a_to_b.mean != other->a_to_b.mean);
}

TEST_CASE("surface distance refuses what it cannot compare", "[distance]") {
  const IndexedFaceSet good = test::tetrahedron();
  const auto code = [&](const IndexedFaceSet& a, const IndexedFaceSet& b, std::size_t samples = 10) {
    const auto result = surface_distance(surface(a), surface(b), {samples, 1});
    REQUIRE(!result);
    return result.error().code;
  };
  CHECK(code(IndexedFaceSet{}, good) == ErrorCode::kUnsuitable);
  CHECK(code(good, IndexedFaceSet{}) == ErrorCode::kUnsuitable);
  CHECK(code(good, good, 0) == ErrorCode::kUsage);
  IndexedFaceSet bad = good;
  bad.corners[4] = 4;
  CHECK(code(bad, good) == ErrorCode::kUsage);
  bad = good;
  bad.corners.pop_back();
  CHECK(code(good, bad) == ErrorCode::kUsage);
  IndexedFaceSet flat = good;
  for (Vec3& p : flat.points) p = Vec3(1.0f);
  CHECK(code(flat, good) == ErrorCode::kUnsuitable);
}

TEST_CASE("surface distance can be cancelled at any report", "[distance]") {
  const IndexedFaceSet mesh = icosphere(2);
  SurfaceDistanceOptions options;
  options.samples = 30000;
  int reports = 0;
  double last = 0;
  REQUIRE(surface_distance(surface(mesh), surface(mesh), options, [&](double fraction) {
    CHECK(fraction >= last);
    CHECK(fraction <= 1);
    last = fraction;
    ++reports;
    return true;
  }));
  REQUIRE(reports > 2);
  for (int stop = 1; stop <= reports; ++stop) {
    int seen = 0;
    const auto result =
        surface_distance(surface(mesh), surface(mesh), options, [&](double) { return ++seen < stop; });
    REQUIRE(!result);
    CHECK(result.error().code == ErrorCode::kInterrupted);
  }
}

TEST_CASE("the Hausdorff distance lies between its bounds, and these as near as was asked", "[distance]") {
  // Few samples, so that they miss the farthest point: the bounds must not.
  SurfaceDistanceOptions options;
  options.samples = 10;
  for (const double tolerance : {0.5, 0.05, 0.001}) {
    CAPTURE(tolerance);
    options.hausdorff_tolerance = tolerance;
    const auto check = [&](const IndexedFaceSet& a, const IndexedFaceSet& b, double there, double back) {
      const SurfaceDistance d = surface_distance(surface(a), surface(b), options).value();
      const double slack = 1e-6 * (there + back);  // The coordinates are floats.
      CHECK(d.a_to_b.hausdorff_low <= there + slack);
      CHECK(d.a_to_b.hausdorff_high >= there - slack);
      CHECK(d.a_to_b.hausdorff_high <= d.a_to_b.hausdorff_low * (1 + tolerance) * (1 + 1e-12));
      CHECK(d.b_to_a.hausdorff_low <= back + slack);
      CHECK(d.b_to_a.hausdorff_high >= back - slack);
      CHECK(d.two_sided().hausdorff_high == std::max(d.a_to_b.hausdorff_high, d.b_to_a.hausdorff_high));
    };
    // A grid, one inner vertex pulled up by 1/2: from it straight down. Back it is at least the distance of
    // the point below that vertex.
    IndexedFaceSet flat = test::grid(6, 6), peak = flat;
    peak.points[7 * 3 + 3].z = 0.5f;
    DVec3 below(peak.points[7 * 3 + 3]);
    below.z = 0;
    double back = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < peak.face_count(); ++f) {
      const auto c = peak.face(f);
      back = std::min(back, brute_force(below, DVec3(peak.points[c[0]]), DVec3(peak.points[c[1]]),
                                        DVec3(peak.points[c[2]])));
    }
    const SurfaceDistance d = surface_distance(surface(peak), surface(flat), options).value();
    CHECK(d.b_to_a.hausdorff_high >= back * (1 - 1e-6));
    check(peak, flat, 0.5, d.b_to_a.hausdorff_low);
    // One sphere inside another: the vertices of the outer one over the faces of the inner.
    const SurfaceDistance spheres =
        surface_distance(surface(icosphere(2, 2.0f)), surface(icosphere(2)), options).value();
    CHECK(spheres.a_to_b.hausdorff_low <= 1.0 + 1e-6);
    CHECK(spheres.a_to_b.hausdorff_high >= 1.0 - 1e-6);
    CHECK(spheres.a_to_b.hausdorff_high <= (1 + tolerance) * (1 + 1e-6));
  }
  options.hausdorff_tolerance = 0;
  const SurfaceDistance of_samples =
      surface_distance(surface(icosphere(1)), surface(icosphere(2)), options).value();
  CHECK(of_samples.a_to_b.hausdorff_low == Approx(of_samples.a_to_b.maximum));
  CHECK(std::isinf(of_samples.two_sided().hausdorff_high));
  options.hausdorff_tolerance = -1;
  CHECK(surface_distance(surface(icosphere(1)), surface(icosphere(2)), options).error().code ==
        ErrorCode::kUsage);
}

TEST_CASE("a surface and itself have a Hausdorff distance of nothing", "[distance]") {
  SurfaceDistanceOptions options;
  options.hausdorff_tolerance = 0.01;
  const SurfaceDistance d = surface_distance(surface(icosphere(3)), surface(icosphere(3)), options).value();
  CHECK(d.two_sided().hausdorff_high < 1e-9);  // Rounding alone.
}

namespace {

/// Turned about an axis that is none of the coordinates'.
void turn(IndexedFaceSet& mesh) {
  for (Vec3& p : mesh.points) {
    const Vec3 q(0.6f * p.x - 0.8f * p.y, 0.8f * p.x + 0.6f * p.y, p.z);
    p = {q.x, 0.28f * q.y - 0.96f * q.z, 0.96f * q.y + 0.28f * q.z};
  }
}

}  // namespace

TEST_CASE("surfaces that coincide have a Hausdorff distance of nothing at once, however they are cut",
          "[distance]") {
  IndexedFaceSet one_diagonal = test::grid(1, 1), other_diagonal = one_diagonal;
  other_diagonal.corners = {0, 1, 2, 1, 3, 2};
  REQUIRE(one_diagonal.corners != other_diagonal.corners);
  IndexedFaceSet plate = test::grid(40, 25), whole = test::grid(1, 1);
  for (Vec3& p : whole.points) p *= Vec3(40.0f, 25.0f, 1.0f);
  // Moved within the plane, so that no edge of the one lies along edges of the other.
  IndexedFaceSet moved = plate;
  test::jitter(moved, 0.2f, 3);
  for (std::size_t v = 0; v < plate.points.size(); ++v) {
    moved.points[v].z = 0;
    for (int k = 0; k < 2; ++k)
      if (const float end = k == 0 ? 40.0f : 25.0f; plate.points[v][k] == 0.0f || plate.points[v][k] == end)
        moved.points[v][k] = plate.points[v][k];
  }
  const struct {
    IndexedFaceSet a, b;
  } pairs[] = {{one_diagonal, other_diagonal},
               {plate, whole},
               {plate, moved},
               {moved, whole},
               {test::cube(), test::fine_cube(20)},
               {test::fine_cube(7), test::fine_cube(9)}};
  for (const auto& pair : pairs)
    for (const bool turned : {false, true}) {
      IndexedFaceSet a = pair.a, b = pair.b;
      if (turned) turn(a), turn(b);
      CAPTURE(a.face_count(), b.face_count(), turned);
      SurfaceDistanceOptions options;
      options.samples = 1;
      options.hausdorff_tolerance = 0.01;
      int reports = 0;
      const SurfaceDistance d =
          surface_distance(surface(a), surface(b), options, [&](double) { return ++reports > 0; }).value();
      for (const DistanceSummary& side : {d.a_to_b, d.b_to_a}) {
        if (turned) {
          // Rounding to floats makes them differ by some 1e-7 of their size, which is bounded like any other.
          CHECK(side.hausdorff_high <= 1e-6 * d.diagonal);
          CHECK(side.hausdorff_high <= std::max(side.hausdorff_low * 1.0101, 1e-9 * d.diagonal));
        } else {
          CHECK(side.hausdorff_low == 0);
          CHECK(side.hausdorff_high <= 1e-12 * d.diagonal);
        }
      }
      // One report in 8192 splits.
      CHECK(reports <= 12);
    }
}

TEST_CASE("bounds of the Hausdorff distance hold what a search over all triangles finds", "[distance]") {
  SurfaceDistanceOptions options;
  options.samples = 5;
  std::mt19937 random(4);
  for (int i = 0; i < (test::kSanitized ? 2 : 6); ++i) {
    CAPTURE(i);
    // Over the same square: flat in part, with other triangles, and some points off the plane.
    IndexedFaceSet a = test::grid(3, 3), b = test::grid(4, 4);
    for (Vec3& p : b.points) p *= Vec3(0.75f, 0.75f, 1.0f);
    for (IndexedFaceSet* mesh : {&a, &b}) {
      test::jitter(*mesh, 0.1f, static_cast<std::uint32_t>(random()));
      for (Vec3& p : mesh->points) p.z = random() % 4 == 0 ? 0.25f * p.z * static_cast<float>(i) : 0.0f;
      if (i % 2 == 1) turn(*mesh);
    }
    options.hausdorff_tolerance = i % 3 == 0 ? 0.001 : 0.1;
    const SurfaceDistance d = surface_distance(surface(a), surface(b), options).value();
    const auto check = [&](const IndexedFaceSet& from, const IndexedFaceSet& to,
                           const DistanceSummary& side) {
      constexpr int kSteps = test::kSanitized ? 2 : 8;
      double most = 0, spacing = 0;
      for (std::size_t f = 0; f < from.face_count(); ++f) {
        const DVec3 p(from.points[from.face(f)[0]]), q(from.points[from.face(f)[1]]),
            r(from.points[from.face(f)[2]]);
        spacing = std::max({spacing, glm::distance(p, q) / kSteps, glm::distance(p, r) / kSteps});
        for (int u = 0; u <= kSteps; ++u)
          for (int v = 0; u + v <= kSteps; ++v) {
            const DVec3 at = p + (u / double{kSteps}) * (q - p) + (v / double{kSteps}) * (r - p);
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t g = 0; g < to.face_count() && nearest > most; ++g) {
              const DVec3 x(to.points[to.face(g)[0]]), y(to.points[to.face(g)[1]]),
                  z(to.points[to.face(g)[2]]);
              // No point of a triangle lies farther from a corner than another corner does.
              if (glm::distance(at, x) - std::max(glm::distance(x, y), glm::distance(x, z)) < nearest)
                nearest = std::min(nearest, brute_force(at, x, y, z));
            }
            most = std::max(most, nearest);
          }
      }
      // The search ends within 1e-8 of a triangle, and a point lies within `spacing` of one that was tried.
      CHECK(side.hausdorff_high >= most - 1e-8);
      CHECK(side.hausdorff_low <= most + spacing);
      CHECK(side.hausdorff_low <= side.hausdorff_high);
      CHECK(side.hausdorff_high <=
            std::max(side.hausdorff_low * (1 + options.hausdorff_tolerance) + 1e-12, 1e-9 * d.diagonal));
    };
    check(a, b, d.a_to_b);
    check(b, a, d.b_to_a);
  }
}

TEST_CASE("a small bump is found below a large triangle, wherever it lies", "[distance]") {
  IndexedFaceSet whole = test::grid(1, 1);
  for (Vec3& p : whole.points) p *= Vec3(40.0f, 25.0f, 1.0f);
  SurfaceDistanceOptions options;
  options.samples = 1;
  options.hausdorff_tolerance = 0.01;
  std::mt19937 random(9);
  for (int i = 0; i < 40; ++i) {
    IndexedFaceSet plate = test::grid(40, 25);
    for (Vec3& p : plate.points) p.z = 0;
    const std::uint32_t x = 1 + static_cast<std::uint32_t>(random() % 39),
                        y = 1 + static_cast<std::uint32_t>(random() % 24);
    const auto at = static_cast<std::size_t>(
        std::ranges::find(plate.points, Vec3(static_cast<float>(x), static_cast<float>(y), 0.0f)) -
        plate.points.begin());
    REQUIRE(at < plate.points.size());
    plate.points[at].z = 0.25f;
    const DVec3 below(x, y, 0);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < plate.face_count(); ++f) {
      const auto c = plate.face(f);
      if (glm::distance(DVec3(plate.points[c[0]]), below) < 3)
        nearest = std::min(nearest, brute_force(below, DVec3(plate.points[c[0]]), DVec3(plate.points[c[1]]),
                                                DVec3(plate.points[c[2]])));
    }
    REQUIRE(nearest > 0.1);
    const SurfaceDistance d = surface_distance(surface(whole), surface(plate), options).value();
    CHECK(d.a_to_b.hausdorff_high >= nearest - 1e-8);
    CHECK(d.a_to_b.hausdorff_low >= nearest / 1.011);
    CHECK(d.b_to_a.hausdorff_low == Approx(0.25));
  }
}

TEST_CASE("normals differ by the angle between the surfaces", "[distance]") {
  const IndexedFaceSet flat = test::grid(4, 4);
  IndexedFaceSet tilted = flat;
  for (Vec3& p : tilted.points) p = {p.x, p.y * 0.8f, p.y * 0.6f};
  const SurfaceDistance d = distance(flat, tilted);
  CHECK(d.a_to_b.mean_normal_angle == Approx(std::atan2(0.6, 0.8)));
  CHECK(d.b_to_a.maximum_normal_angle == Approx(std::atan2(0.6, 0.8)));
  IndexedFaceSet turned = flat;
  for (std::size_t c = 0; c < turned.corners.size(); c += 3)
    std::swap(turned.corners[c], turned.corners[c + 1]);
  CHECK(distance(flat, turned).two_sided().mean_normal_angle == Approx(3.14159265358979));
  CHECK(distance(flat, flat).two_sided().maximum_normal_angle == 0);
}

}  // namespace vkmesh
