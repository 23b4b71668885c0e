// Curvatures against surfaces that are known, and against Gauss and Bonnet.
#include <cmath>
#include <functional>
#include <numbers>

#include <catch2/catch.hpp>

#include <vkmesh/io/mesh_io.h>
#include <vkmesh/passes/curvatures.h>
#include <vkmesh/repair/consolidate.h>

#include "support/data.h"
#include "support/shapes.h"

using namespace vkmesh;

namespace {

constexpr double kPi = std::numbers::pi;

std::vector<VertexCurvature> curvatures_of(const IndexedFaceSet& set) {
  auto result = curvatures(node_neighbours(test::half_edges(set)).value(), set.points);
  REQUIRE(result);
  return *std::move(result);
}

struct Errors {
  double mean = 0, gaussian = 0;  // The largest over the vertices.
};
Errors errors(const IndexedFaceSet& set, const std::function<double(DVec3)>& mean,
              const std::function<double(DVec3)>& gaussian) {
  const auto found = curvatures_of(set);
  const HalfEdgeMesh mesh = test::half_edges(set);
  Errors worst;
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (mesh.is_boundary(VertexId(static_cast<std::uint32_t>(v)))) continue;
    worst.mean = std::max(worst.mean, std::fabs(found[v].mean - mean(DVec3(set.points[v]))));
    worst.gaussian = std::max(worst.gaussian, std::fabs(found[v].gaussian - gaussian(DVec3(set.points[v]))));
  }
  return worst;
}

}  // namespace

TEST_CASE("curvatures of spheres are 1/r and 1/r², to second order in the edge length") {
  for (const float radius : {0.25f, 1.0f, 8.0f}) {
    const double r = radius;
    double before = 0;
    for (const unsigned level : {1u, 2u, 3u, 4u}) {
      const Errors now = errors(
          test::icosphere(level, radius), [&](DVec3) { return 1 / r; }, [&](DVec3) { return 1 / (r * r); });
      INFO("radius " << r << ", level " << level << ": " << now.mean * r << " " << now.gaussian * r * r);
      // Halving the edges quarters the error; three leaves room for the shapes of the triangles.
      if (level > 1) CHECK(now.gaussian < before / 3);
      before = now.gaussian;
      // Where all vertices lie on the sphere, its centre is the centre of each Voronoi region's prism, and
      // the formula gains two orders.
      CHECK(now.mean * r < 0.0005);
    }
    CHECK(before * r * r < 0.002);
  }
}

TEST_CASE("curvatures of a torus converge to those of the surface, to second order") {
  Errors before;
  for (const std::uint32_t n : {12u, 24u, 48u}) {
    // At the point at angle v of the tube, where R = 1 and r = 0.4.
    const auto cosine = [](DVec3 p) { return (std::sqrt(p.x * p.x + p.y * p.y) - 1) / 0.4; };
    const Errors now = errors(
        test::torus(2 * n, n), [&](DVec3 p) { return (1 + 0.8 * cosine(p)) / (0.8 * (1 + 0.4 * cosine(p))); },
        [&](DVec3 p) { return cosine(p) / (0.4 * (1 + 0.4 * cosine(p))); });
    INFO(n << ": " << now.mean << " " << now.gaussian);
    if (n > 12) {
      CHECK(now.mean < before.mean / 3);
      CHECK(now.gaussian < before.gaussian / 3);
    }
    before = now;
  }
}

TEST_CASE("curvatures of a plane are 0, and of a tube 1/2r and 0") {
  IndexedFaceSet plane = test::grid(9, 7);
  for (Vec3& p : plane.points) p = Vec3(p.x + 0.2f * std::sin(p.y), p.y + 0.3f * std::cos(p.x), p.x);
  for (Vec3& p : plane.points) p.z = 0.5f * p.x - 0.25f * p.y;
  const auto nothing = [](DVec3) { return 0.0; };
  // Coordinates up to 10 are rounded to 2^-21 each, on edges of length 1 and areas of 0.5 at least.
  const Errors flat = errors(plane, nothing, nothing);
  CHECK(flat.mean < 16 * 0x1p-21);
  CHECK(flat.gaussian < 64 * 0x1p-21);
  // A tube whose rows of vertices lie on straight lines is exact but for rounding, as above; areas 0.1.
  const Errors tube = errors(
      test::cylinder(20, 40), [](DVec3) { return 0.5; }, nothing);
  CHECK(tube.mean < 64 * 0x1p-21);
  CHECK(tube.gaussian < 64 * 0x1p-21);
}

TEST_CASE("mean curvature has the sign of the normal, Gaussian curvature that of the surface") {
  IndexedFaceSet set = test::icosphere(2);
  for (std::size_t f = 0; f < set.face_count(); ++f) std::swap(set.corners[3 * f], set.corners[3 * f + 1]);
  for (const VertexCurvature& c : curvatures_of(set)) {
    CHECK(std::fabs(c.mean + 1) < 0.001);
    CHECK(c.gaussian > 0.9);
  }
  IndexedFaceSet saddle = test::grid(2, 2);
  for (Vec3& p : saddle.points) p.z = 0.5f * (p.x - 1) * (p.y - 1);
  CHECK(curvatures_of(saddle)[4].gaussian < -0.1);
}

namespace {

// Gauss and Bonnet, and the area.
void check_sums(const IndexedFaceSet& set, const HalfEdgeMesh& mesh) {
  const auto found = curvatures(node_neighbours(mesh).value(), set.points);
  REQUIRE(found);
  double defects = 0, areas = 0, area = 0;
  std::size_t used = 0;
  for (std::size_t v = 0; v < found->size(); ++v) {
    defects += (*found)[v].angle_defect;
    areas += (*found)[v].area;
    used += !mesh.is_isolated(VertexId(static_cast<std::uint32_t>(v)));
  }
  for (std::size_t f = 0; f < set.face_count(); ++f) {
    const auto c = set.face(f);
    const DVec3 p(set.points[c[0]]), a = DVec3(set.points[c[1]]) - p, b = DVec3(set.points[c[2]]) - p;
    const DVec3 n(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    area += 0.5 * std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  }
  const double characteristic = static_cast<double>(used) - static_cast<double>(mesh.edge_count()) +
                                static_cast<double>(mesh.face_count());
  // Angles are good to 4 · 2^-23 each (tests of the arithmetic), and sums around a vertex lose as much again;
  // the nearest wrong answer is 2π away.
  const double tolerance = 8 * 0x1p-23 * static_cast<double>(mesh.half_edge_count());
  REQUIRE(tolerance < 3.0);
  CHECK(std::fabs(defects - 2 * kPi * characteristic) < tolerance);
  // Each region's products carry a few roundings; cotangents of slivers are bounded.
  CHECK(std::fabs(areas / area - 1) < 1e-4);
}

}  // namespace

TEST_CASE("angle defects add up to 2π times the Euler characteristic, regions to the area") {
  for (IndexedFaceSet set : {test::icosphere(3), test::torus(30, 20), test::double_torus(), test::grid(9, 5),
                             test::cylinder(7, 9), test::cube(), test::tetrahedron()}) {
    check_sums(set, test::half_edges(set));
    test::jitter(set, 0.02f, 8);
    check_sums(set, test::half_edges(set));
  }
}

TEST_CASE("angle defects of real meshes add up to 2π times the Euler characteristic") {
  std::size_t checked = 0, closed = 0;
  for (const auto& path : test::cgal_meshes()) {
    const auto soup = read_mesh(path);
    if (!soup) continue;
    const auto set = to_indexed_face_set(*soup);
    if (!set) continue;
    const auto mesh = to_half_edge_mesh(*set);
    if (!mesh || !mesh->is_triangles() || mesh->face_count() == 0 || mesh->face_count() > 100000) continue;
    INFO(path);
    check_sums(*set, *mesh);
    ++checked;
    closed += mesh->boundary_half_edge_count() == 0;
  }
  CHECK(checked >= 20);
  CHECK(closed >= 10);
}

TEST_CASE("curvatures are defined everywhere: degenerate triangles, slivers, isolated vertices") {
  IndexedFaceSet set = test::icosphere(2);
  set.points.emplace_back(3.0f, 3.0f, 3.0f);
  set.points[0] = set.points[1];
  set.points[5] = set.points[6] + Vec3(1e-7f, 0, 0);
  for (const float unit : {1.0f, 0x1p-55f, 0x1p55f, 0.0f}) {
    IndexedFaceSet scaled = set;
    for (Vec3& p : scaled.points) p *= unit;
    const auto found = curvatures_of(scaled);
    for (const VertexCurvature& c : found)
      for (const float x : {c.mean, c.gaussian, c.angle_defect, c.area}) CHECK(std::fabs(x) <= 0x1p120f);
    CHECK((found.back().mean == 0 && found.back().gaussian == 0 && found.back().angle_defect == 0 &&
           found.back().area == 0));
  }
  const NodeNeighbours neighbours = node_neighbours(test::half_edges(test::cube())).value();
  CHECK(curvatures(neighbours, set.points).error().code == ErrorCode::kUsage);
}
