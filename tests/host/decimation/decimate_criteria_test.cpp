#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/repair/consolidate.h>

#include "decimation/decimate_support.h"
#include "support/data.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using test::run, test::ways;

SurfaceDistance between(const IndexedFaceSet& mesh, const Decimated& result) {
  auto distance =
      surface_distance({mesh.points, mesh.corners}, {result.positions, result.mesh.origins()}, {5000, 1, 0});
  if (!distance) FAIL(distance.error().describe());
  return *distance;
}

IndexedFaceSet bumpy_torus() {
  IndexedFaceSet mesh = test::torus(40, 24);
  test::jitter(mesh, 0.01f, 5);
  return mesh;
}

std::map<std::string, IndexedFaceSet> shapes_by_name() {
  std::map<std::string, IndexedFaceSet> all;
  all["sphere"] = test::icosphere(4);
  all["bumpy torus"] = bumpy_torus();
  all["fine cube"] = test::fine_cube(9);
  all["tube with two ends"] = test::cylinder(30, 20);
  IndexedFaceSet sheet = test::grid(30, 30);
  for (Vec3& p : sheet.points) p.z = 0.3f * std::sin(0.5f * p.x) * std::cos(0.4f * p.y);
  test::jitter(sheet, 0.05f, 9);
  all["waves with a boundary"] = std::move(sheet);
  return all;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// The edges and their numbers of vertices, and the shape of faces, of what was left.
struct Measures {
  double longest_edge = 0, worst_aspect = 0, mean_aspect = 0;
  std::size_t most_edges = 0;

  Measures(std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
    std::vector<std::set<std::uint32_t>> neighbours(points.size());
    for (std::size_t c = 0; c < corners.size(); c += 3) {
      double longest = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = corners[c + i], b = corners[c + (i + 1) % 3];
        neighbours[a].insert(b);
        neighbours[b].insert(a);
        longest = std::max(longest, glm::distance(DVec3(points[a]), DVec3(points[b])));
      }
      const DVec3 p(points[corners[c]]), q(points[corners[c + 1]]), r(points[corners[c + 2]]);
      const double height = glm::length(glm::cross(q - p, r - p)) / longest;
      const double aspect = longest / height * std::sqrt(0.75);  // 1: equilateral
      worst_aspect = std::max(worst_aspect, aspect);
      mean_aspect += aspect / static_cast<double>(corners.size() / 3);
      longest_edge = std::max(longest_edge, longest);
    }
    for (const auto& of : neighbours) most_edges = std::max(most_edges, of.size());
  }
  explicit Measures(const Decimated& result) : Measures(result.positions, result.mesh.origins()) {}
};

TEST_CASE("decimation: no point of either surface lies farther from the other than the bound", "[decimate]") {
  for (const auto& [name, mesh] : shapes_by_name())
    for (DecimateOptions options : ways()) {
      options.bounds.report_distance = true;
      options.target.ratio = 0.1;
      const Decimated free = run(mesh, options);
      REQUIRE(free.distance_bound);
      const double reached = between(mesh, free).two_sided().maximum;
      CAPTURE(name, static_cast<int>(options.operation));
      CHECK(*free.distance_bound >= reached * (1 - 1e-5) - 1e-6);
      if (reached < 1e-3) continue;  // flat
      options.bounds.distance = Length::absolute(0.4 * reached);
      const Decimated bound = run(mesh, options);
      REQUIRE(bound.distance_bound);
      CHECK(*bound.distance_bound <= 0.4 * reached * (1 + 1e-6));
      CHECK(between(mesh, bound).two_sided().maximum <= *bound.distance_bound * (1 + 1e-5) + 1e-6);
      CHECK(bound.mesh.face_count() > free.mesh.face_count());
      CHECK(bound.mesh.face_count() < mesh.face_count());
      CHECK(bound.rejected[Reason::kCriterion] > 0);
      CHECK(bound.blocked[Reason::kCriterion] > 0);
      CHECK(bound.stop == DecimateStop::kNoLegalCollapse);
      CHECK(validate(bound.mesh));
    }
}

TEST_CASE("decimation: the distance is bounded in units of the input, wherever it lies", "[decimate]") {
  IndexedFaceSet mesh = bumpy_torus();
  DecimateOptions options;
  options.bounds.distance = Length::relative(0.004);
  const Decimated relative = run(mesh, options);
  double diagonal = 0;
  {
    Vec3 low = mesh.points[0], high = low;
    for (const Vec3& p : mesh.points)
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    diagonal = glm::distance(DVec3(low), DVec3(high));
  }
  CHECK(*relative.distance_bound <= 0.004 * diagonal);
  CHECK(*relative.distance_bound > 0.003 * diagonal);
  for (Vec3& p : mesh.points) p = 64.0f * p + Vec3(1024, 0, 0);
  options.bounds = {};
  options.bounds.distance = Length::absolute(64 * 0.004 * diagonal);
  const Decimated moved = run(mesh, options);
  CHECK(*moved.distance_bound == Approx(64 * *relative.distance_bound).epsilon(0.1));
  CHECK(between(mesh, moved).two_sided().maximum <= *moved.distance_bound * (1 + 1e-5));
}

TEST_CASE("decimation: normals stay near those of the original", "[decimate]") {
  const IndexedFaceSet mesh = test::icosphere(4);
  for (DecimateOptions options : ways()) {
    options.target.faces = 40;
    CHECK(between(mesh, run(mesh, options)).two_sided().maximum_normal_angle > 0.5);
    options.bounds.original_normal_deviation = 0.35;
    const Decimated result = run(mesh, options);
    CAPTURE(static_cast<int>(options.operation));
    // Nearest points are not of faces that stand for each other: what that makes is a facet of the original,
    // 5 degrees.
    CHECK(between(mesh, result).two_sided().maximum_normal_angle < 0.35 + 0.09);
    CHECK(result.mesh.face_count() < mesh.face_count() / 4);
    CHECK(result.blocked[Reason::kCriterion] > 0);
  }
}

TEST_CASE("decimation: aspect ratio, length of edges and valence are bounded", "[decimate]") {
  const IndexedFaceSet mesh = test::icosphere(4);
  const Measures before(mesh.points, mesh.corners);
  for (DecimateOptions options : ways()) {
    options.target.ratio = 0.05;
    CAPTURE(static_cast<int>(options.operation));
    const Measures free(run(mesh, options));

    DecimateOptions by = options;
    by.bounds.aspect_ratio = 0.75 * free.worst_aspect;
    REQUIRE(*by.bounds.aspect_ratio > before.worst_aspect);
    CHECK(Measures(run(mesh, by)).worst_aspect <= *by.bounds.aspect_ratio * (1 + 1e-5));

    by = options;
    by.bounds.edge_length = Length::absolute(0.75 * free.longest_edge);
    const Decimated even = run(mesh, by);
    REQUIRE(by.bounds.edge_length->value > before.longest_edge);
    CHECK(Measures(even).longest_edge <= by.bounds.edge_length->value * (1 + 1e-5));

    // Where each vertex has six edges no collapse makes fewer than eight.
    const IndexedFaceSet bumpy = bumpy_torus();
    options.target.ratio = 0.06;
    REQUIRE(Measures(run(bumpy, options)).most_edges > 8);
    by = options;
    by.bounds.valence = 8;
    const Decimated thin = run(bumpy, by);
    CHECK(Measures(thin).most_edges <= 8);
    CHECK(thin.mesh.face_count() < bumpy.face_count());
  }
}

TEST_CASE("decimation: what was beyond a bound before may go", "[decimate]") {
  // A needle of a fan of many neighbours: worse than every bound, and it gets better.
  const IndexedFaceSet mesh = test::torus(64, 4, 1.0f, 0.05f);
  const Measures before(mesh.points, mesh.corners);
  DecimateOptions options;
  options.target.ratio = 0.5;
  options.bounds.aspect_ratio = 1.0;
  options.bounds.edge_length = Length::absolute(1e-3);
  options.bounds.valence = 3;
  const Decimated result = run(mesh, options);
  const Measures after(result);
  CHECK(after.worst_aspect <= before.worst_aspect * (1 + 1e-5));
  CHECK(after.longest_edge <= before.longest_edge * (1 + 1e-5));
  CHECK(after.most_edges <= before.most_edges);
}

/// A sheet [0, 2] × [0, 1], the left half in points three times as near.
IndexedFaceSet two_densities() {
  IndexedFaceSet mesh = test::grid(60, 30);
  for (Vec3& p : mesh.points) {
    p.x = p.x <= 45 ? p.x / 45 : 1 + (p.x - 45) / 15;
    p.y /= 30;
  }
  return mesh;
}

TEST_CASE("decimation: by density alone, points go where they are dense", "[decimate]") {
  const IndexedFaceSet mesh = two_densities();
  for (DecimateOptions options : ways()) {
    options.target.vertices = 600;
    options.weights.quadric = 0;
    options.weights.density = 1;
    const Decimated result = run(mesh, options);
    std::size_t left = 0;
    for (const Vec3& p : result.positions) left += p.x < 1 ? 1 : 0;
    CAPTURE(static_cast<int>(options.operation), left);
    // From three quarters of all to about a half.
    CHECK(static_cast<double>(left) / static_cast<double>(result.positions.size()) < 0.62);
  }
}

TEST_CASE("decimation: weights make better triangles and truer normals", "[decimate]") {
  const IndexedFaceSet mesh = bumpy_torus();
  for (DecimateOptions options : ways()) {
    options.target.ratio = 0.2;
    CAPTURE(static_cast<int>(options.operation));
    const Decimated plain = run(mesh, options);
    DecimateOptions by = options;
    by.weights.aspect_ratio = 0.3;
    CHECK(Measures(run(mesh, by)).mean_aspect < 0.93 * Measures(plain).mean_aspect);
    by = options;
    by.weights.normals = 1;
    CHECK(between(mesh, run(mesh, by)).two_sided().maximum_normal_angle <
          0.9 * between(mesh, plain).two_sided().maximum_normal_angle);
  }
}

/// Half-edge collapses by density and aspect ratio, done over again: nothing that could be done costs less.
/// Which end is kept is for the quadrics to say.
TEST_CASE("decimation: the order by criteria is the greedy one", "[decimate]") {
  IndexedFaceSet mesh = test::icosphere(2);
  test::jitter(mesh, 0.02f, 21);
  DecimateOptions options;
  options.operation = DecimateOperation::kHalfEdgeCollapse;
  options.weights.quadric = 0;
  options.weights.density = 0.3;
  options.weights.aspect_ratio = 1;
  options.target.ratio = 0.5;
  options.bounds.normal_deviation = 3;
  options.keep_history = true;
  const Decimated result = run(mesh, options);
  REQUIRE(result.rejected[Reason::kLinkCondition] + result.rejected[Reason::kFoldOver] ==
          0);  // or more would have to be known here
  REQUIRE(result.history.size() > 70);

  using Face = std::array<std::uint32_t, 3>;
  std::vector<DVec3> places(mesh.points.begin(), mesh.points.end());
  std::vector<double> weight(places.size(), 0);
  std::set<Face> faces;
  struct Plane {
    DVec3 point, area;
  };
  std::vector<std::vector<Plane>> planes(places.size());
  for (std::size_t c = 0; c < mesh.corners.size(); c += 3) {
    const Face f = {mesh.corners[c], mesh.corners[c + 1], mesh.corners[c + 2]};
    faces.insert(f);
    const DVec3 area = 0.5 * glm::cross(places[f[1]] - places[f[0]], places[f[2]] - places[f[0]]);
    for (const std::uint32_t v : f) {
      weight[v] += glm::length(area);
      planes[v].push_back({places[f[0]], area});
    }
  }
  const auto error_at = [&](const DVec3& x, std::uint32_t a, std::uint32_t b) {
    double sum = 0;
    for (const std::uint32_t v : {a, b})
      for (const Plane& plane : planes[v]) {
        const double flux = glm::dot(x - plane.point, plane.area);
        sum += flux * flux / glm::length(plane.area);
      }
    return sum;
  };
  const auto cost = [&](std::uint32_t a, std::uint32_t b) {
    const DVec3 way = places[a] - places[b];
    const bool keeps_a = error_at(places[a], a, b) < error_at(places[b], a, b);
    const std::uint32_t kept = keeps_a ? a : b, gone = keeps_a ? b : a;
    double worst = 0;
    for (const Face& f : faces) {
      const auto holds = [&](std::uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; };
      if (!holds(gone) || holds(kept)) continue;  // stays as it is, or goes
      std::array<DVec3, 3> p;
      for (std::size_t i = 0; i < 3; ++i) p[i] = places[f[i] == gone ? kept : f[i]];
      double longest = 0;
      for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, glm::distance(p[i], p[(i + 1) % 3]));
      const double height = glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) / longest;
      worst = std::max(worst, std::sqrt(0.75) * longest / height);
    }
    return (weight[a] + weight[b]) * glm::dot(way, way) * (0.09 + 1 - 1 / worst);
  };
  for (const Collapse<Vec3>& step : result.history) {
    double least = std::numeric_limits<double>::infinity();
    for (const Face& f : faces)
      for (std::size_t i = 0; i < 3; ++i) least = std::min(least, cost(f[i], f[(i + 1) % 3]));
    CHECK(cost(step.kept, step.removed) <= least * (1 + 1e-4));
    weight[step.kept] += weight[step.removed];
    planes[step.kept].insert(planes[step.kept].end(), planes[step.removed].begin(),
                             planes[step.removed].end());
    places[step.kept] = DVec3(step.position);
    std::set<Face> left;
    for (Face f : faces) {
      std::replace(f.begin(), f.end(), step.removed, step.kept);
      if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) left.insert(f);
    }
    faces = std::move(left);
  }
}

TEST_CASE("decimation: what holds the edges that are left", "[decimate]") {
  const IndexedFaceSet mesh = test::cylinder(12, 10);
  DecimateOptions options;
  options.curves.boundary = DecimateBoundary::kKept;
  const Decimated kept = run(mesh, options);
  CHECK(kept.blocked[Reason::kBoundary] >= 20);  // those of both ends
  CHECK(kept.blocked[Reason::kLocked] == 0);
  const HalfEdgeMesh left = kept.mesh;
  std::size_t edges = 0;
  for (std::uint32_t h = 0; h < left.origins().size(); ++h)
    edges += left.twins()[h] == kInvalid || h < left.twins()[h] ? 1 : 0;
  CHECK(test::sum(kept.blocked) == edges);

  options.curves.boundary = DecimateBoundary::kFree;
  options.locked.vertices = {0, 1, 2, 3};
  CHECK(run(mesh, options).blocked[Reason::kLocked] >= 3);
  CHECK(run(mesh, options).blocked[Reason::kBoundary] == 0);

  options = {};
  options.bounds.error = Length::relative(1e-6);
  const Decimated error = run(test::icosphere(2), options);
  CHECK(error.blocked[Reason::kErrorBound] > 0);
  CHECK(error.stop == DecimateStop::kErrorBound);
  CHECK(run(test::tetrahedron(), {}).blocked[Reason::kLinkCondition] == 6);
}

TEST_CASE("decimation: ears of the boundary are watched, too", "[decimate]") {
  // A saw: each tooth is a vertex of one face.
  IndexedFaceSet saw;
  for (int i = 0; i <= 8; ++i) saw.points.emplace_back(i, 0, 0);
  for (int i = 0; i < 8; ++i) saw.points.emplace_back(static_cast<float>(i) + 0.5f, 0.2f, 0);
  for (int i = 0; i <= 8; ++i) saw.points.emplace_back(i, -1, 0);
  for (std::uint32_t i = 0; i < 8; ++i)
    saw.corners.insert(saw.corners.end(), {i, i + 1, i + 9, i, i + 17, i + 18, i, i + 18, i + 1});
  for (DecimateOptions options : ways()) {
    options.curves.boundary = DecimateBoundary::kFree;
    options.bounds.distance = Length::absolute(0.19);
    const Decimated held = run(saw, options);
    options.bounds.distance = Length::absolute(0.21);
    const Decimated cut = run(saw, options);
    CAPTURE(static_cast<int>(options.operation));
    CHECK(between(saw, held).two_sided().maximum <= 0.19);
    CHECK(between(saw, cut).two_sided().maximum <= 0.21);
    if (options.operation != DecimateOperation::kEdgeCollapse)
      CHECK(cut.mesh.face_count() < held.mesh.face_count());
  }
}

TEST_CASE("decimation: criteria out of range are refused", "[decimate]") {
  const auto refused = [](auto&& change) {
    DecimateOptions options;
    change(options);
    const IndexedFaceSet mesh = test::icosphere(1);
    const auto result = decimate(test::half_edges(mesh), mesh.points, options);
    return !result && result.error().code == ErrorCode::kUsage;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    CHECK(refused([&](DecimateOptions& o) { o.weights.quadric = bad; }));
    CHECK(refused([&](DecimateOptions& o) { o.weights.density = bad; }));
    CHECK(refused([&](DecimateOptions& o) { o.weights.aspect_ratio = bad; }));
    CHECK(refused([&](DecimateOptions& o) { o.weights.normals = bad; }));
  }
  CHECK(refused([](DecimateOptions& o) { o.weights.quadric = 0; }));
  for (const double bad : {-1.0, nan}) {
    CHECK(refused([&](DecimateOptions& o) { o.bounds.distance = Length::absolute(bad); }));
    CHECK(refused([&](DecimateOptions& o) { o.bounds.distance = Length::relative(bad); }));
    CHECK(refused([&](DecimateOptions& o) { o.bounds.edge_length = Length::absolute(bad); }));
    CHECK(refused([&](DecimateOptions& o) { o.bounds.aspect_ratio = bad; }));
    CHECK(refused([&](DecimateOptions& o) { o.bounds.original_normal_deviation = bad; }));
  }
  CHECK(refused([](DecimateOptions& o) { o.bounds.original_normal_deviation = std::numbers::pi; }));
  CHECK(refused([](DecimateOptions& o) { o.bounds.aspect_ratio = 0.99; }));
  CHECK(refused([](DecimateOptions& o) { o.bounds.edge_length = Length::absolute(0); }));
  CHECK(refused([](DecimateOptions& o) { o.bounds.valence = 2; }));
}

}  // namespace
}  // namespace vkmesh
