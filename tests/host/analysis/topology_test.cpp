#include <optional>
#include <string>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/repair/consolidate.h>

#include "support/shapes.h"

using namespace vkmesh;

namespace {

SurfaceTopology topology_of(const IndexedFaceSet& mesh) {
  auto topology = surface_topology(mesh);
  if (!topology) FAIL(topology.error().describe());
  return *std::move(topology);
}

/// A triangle apart from everything, beside the mesh.
IndexedFaceSet with_triangle(const IndexedFaceSet& mesh) {
  IndexedFaceSet triangle;
  triangle.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.corners = {0, 1, 2};
  return test::both(mesh, triangle, Vec3(50.0f, 0.0f, 0.0f));
}

struct ExpectedTopology {
  std::string name;
  IndexedFaceSet mesh;
  std::int64_t euler;
  std::size_t loops;
  std::optional<std::int64_t> genus;
  bool closed, orientable;
};

}  // namespace

TEST_CASE("topology: the surfaces of the textbooks", "[topology]") {
  const std::vector<ExpectedTopology> cases = {
      {"sphere", test::icosphere(2), 2, 0, 0, true, true},
      {"torus", test::torus(8, 6), 0, 0, 1, true, true},
      {"double torus", test::double_torus(), -2, 0, 2, true, true},
      {"disk", test::grid(4, 3), 1, 1, 0, false, true},
      {"cylinder", test::cylinder(3, 6), 0, 2, 0, false, true},
      {"Möbius strip", test::mobius(9), 0, 1, std::nullopt, false, false},
      {"Klein bottle", test::klein_bottle(8, 6), 0, 0, std::nullopt, true, false},
  };
  for (const ExpectedTopology& expected : cases) {
    CAPTURE(expected.name);
    // Alone, and as one of two components.
    for (const bool alone : {true, false}) {
      const SurfaceTopology t = topology_of(alone ? expected.mesh : with_triangle(expected.mesh));
      REQUIRE(t.components.size() == (alone ? 1 : 2));
      const Topology& c = t.components[0];
      CHECK(c.euler_characteristic() == expected.euler);
      CHECK(c.boundary_loops == expected.loops);
      CHECK(c.genus == expected.genus);
      CHECK(c.closed() == expected.closed);
      CHECK(c.orientable == expected.orientable);
      CHECK(c.oriented() == expected.orientable);
      CHECK(c.manifold());
      CHECK(c.points == expected.mesh.points.size());
      CHECK(c.faces == expected.mesh.face_count());
      CHECK(t.whole.euler_characteristic() == expected.euler + (alone ? 0 : 1));
      CHECK(t.whole.boundary_loops == expected.loops + (alone ? 0 : 1));
      CHECK(t.whole.genus == expected.genus);
      CHECK(t.whole.closed() == (expected.closed && alone));
      CHECK(t.whole.orientable == expected.orientable);
      CHECK(t.whole.manifold());
    }
  }
}

TEST_CASE("topology: two tori that share a point are two tori, and no manifold", "[topology]") {
  const SurfaceTopology t = topology_of(test::tori_sharing_a_point());
  REQUIRE(t.components.size() == 2);
  for (const Topology& c : t.components) {
    CHECK(c.genus == 1);
    CHECK(c.manifold());
    CHECK(c.points == 48);
    CHECK(c.euler_characteristic() == 0);
  }
  CHECK(t.whole.points == 95);
  CHECK(t.whole.non_manifold_vertices == 1);
  CHECK_FALSE(t.whole.manifold());
  CHECK(t.whole.genus == std::nullopt);
  CHECK(t.whole.euler_characteristic() == -1);
}

TEST_CASE("topology: a surface that touches itself in a point", "[topology]") {
  // A strip of triangles whose two ends share a point: one component, two fans there.
  IndexedFaceSet mesh = test::grid(4, 1);
  const std::uint32_t a = 0, b = 4;  // The ends of the lower side.
  for (std::uint32_t& c : mesh.corners)
    if (c == b) c = a;
  const SurfaceTopology t = topology_of(mesh);
  REQUIRE(t.components.size() == 1);
  CHECK(t.components[0].non_manifold_vertices == 1);
  CHECK(t.components[0].genus == std::nullopt);
  // The boundary passes the point twice, in one loop.
  CHECK(t.components[0].boundary_loops == 1);
  CHECK(t.components[0].points == mesh.points.size() - 1);
}

TEST_CASE("topology: an edge of three faces", "[topology]") {
  const SurfaceTopology t = topology_of(test::fin());
  CHECK(t.components.size() == 1);
  CHECK(t.whole.non_manifold_edges == 1);
  CHECK(t.whole.non_manifold_vertices == 2);
  CHECK(t.whole.edges == 7);
  CHECK(t.whole.boundary_edges == 6);
  // Each face's two free edges are a chain of their own.
  CHECK(t.whole.boundary_loops == 3);
  CHECK_FALSE(t.whole.manifold());
}

TEST_CASE("topology: one flipped face is orientable, and not oriented", "[topology]") {
  IndexedFaceSet mesh = test::icosphere(1);
  std::swap(mesh.corners[0], mesh.corners[1]);
  const SurfaceTopology t = topology_of(mesh);
  CHECK(t.whole.misoriented_edges == 3);
  CHECK_FALSE(t.whole.oriented());
  CHECK(t.whole.orientable);
  CHECK(t.whole.genus == 0);
}

TEST_CASE("topology: degenerate faces and isolated points are no part of the surface", "[topology]") {
  IndexedFaceSet mesh = test::tetrahedron();
  mesh.points.emplace_back(5.0f, 5.0f, 5.0f);
  mesh.corners.insert(mesh.corners.end(), {0, 0, 4});
  mesh.face_offsets = {0, 3, 6, 9, 12, 15};
  const SurfaceTopology t = topology_of(mesh);
  CHECK(t.whole.points == 4);
  CHECK(t.whole.faces == 4);
  CHECK(t.whole.edges == 6);
  CHECK(t.whole.genus == 0);
  CHECK(t.component_of_face == std::vector<std::uint32_t>{0, 0, 0, 0, kInvalid});
}

TEST_CASE("topology agrees with consolidation on meshes in any order", "[topology]") {
  for (const IndexedFaceSet& mesh : {test::torus(9, 7), test::cylinder(5, 8), test::fin(), test::bow_tie(),
                                     test::both(test::grid(3, 3), test::fin(), Vec3(9.0f))}) {
    const SurfaceTopology t = topology_of(mesh);
    const auto report = diagnose(mesh);
    REQUIRE(report);
    CHECK(t.whole.edges == report->edges);
    CHECK(t.whole.boundary_edges == report->boundary_edges);
    CHECK(t.whole.non_manifold_edges == report->non_manifold_edges);
    CHECK(t.whole.misoriented_edges == report->misoriented_edges);
  }
}

TEST_CASE("topology of nothing", "[topology]") {
  const SurfaceTopology t = topology_of({});
  CHECK(t.components.empty());
  CHECK(t.whole.genus == std::nullopt);
  CHECK_FALSE(t.whole.closed());
  IndexedFaceSet bad = test::tetrahedron();
  bad.corners[0] = 99;
  CHECK(surface_topology(bad).error().code == ErrorCode::kUsage);
  CHECK(element_defects(bad).error().code == ErrorCode::kUsage);
}

TEST_CASE("element defects are counted", "[topology]") {
  IndexedFaceSet mesh = test::quad_cube();
  const auto add = [&](std::initializer_list<std::uint32_t> face) {
    mesh.corners.insert(mesh.corners.end(), face);
    mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  };
  add({3, 1, 0, 2});     // Face 0 from another corner.
  add({2, 0, 1, 3});     // Its reverse.
  add({0, 2, 1, 3});     // Its points in another order: no duplicate.
  add({0, 1, 2});        // A part of it.
  add({0, 1, 3, 7, 2});  // Two that agree in three points.
  add({0, 1, 3, 5, 2});
  add({4, 5, 4});  // Degenerate.
  mesh.points.push_back(mesh.points[3]);
  mesh.points.emplace_back(-0.0f, 0.0f, 0.0f);
  mesh.points.emplace_back(7.0f, 0.0f, 0.0f);
  const auto defects = element_defects(mesh);
  REQUIRE(defects);
  CHECK(defects->duplicate_faces == 2);
  CHECK(defects->degenerate_faces == 1);
  CHECK(defects->duplicate_points == 2);
  CHECK(defects->isolated_points == 3);
}
