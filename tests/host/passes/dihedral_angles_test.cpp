// Dihedral angles against known solids and double precision.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/passes/dihedral_angles.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::area_of;
using test::cross;
using test::dot;
using test::length;

TEST_CASE("dihedral angles of known solids") {
  const double pi = std::numbers::pi;
  SECTION("cube: right angles at its edges, flat across each side") {
    const IndexedFaceSet set = test::cube();
    const HalfEdgeMesh mesh = test::half_edges(set);
    const DihedralAngles angles = dihedral_angles(mesh, set.points).value();
    int right = 0, flat = 0;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      CHECK(angles.half_edge[h] == angles.half_edge[mesh.twins()[h]]);
      right += std::fabs(angles.half_edge[h] - pi / 2) < 1e-6;
      flat += angles.half_edge[h] == 0.0f;
    }
    CHECK(right == 24);
    CHECK(flat == 12);
    for (const float m : angles.vertex_maximum) CHECK(std::fabs(m - pi / 2) < 1e-6);
  }
  SECTION("regular tetrahedron: its normals are π − arccos(1/3) apart") {
    const IndexedFaceSet set = test::tetrahedron();  // coordinates of six digits
    const DihedralAngles angles = dihedral_angles(test::half_edges(set), set.points).value();
    for (const float a : angles.half_edge) CHECK(std::fabs(a - (pi - std::acos(1.0 / 3.0))) < 1e-5);
  }
  SECTION("grid: flat inside and on the boundary") {
    const IndexedFaceSet set = test::grid(3, 2);
    const DihedralAngles angles = dihedral_angles(test::half_edges(set), set.points).value();
    for (const float a : angles.half_edge) CHECK(a == 0.0f);
    for (const float m : angles.vertex_maximum) CHECK(m == 0.0f);
  }
}

TEST_CASE("dihedral angles agree with double precision") {
  for (const IndexedFaceSet& set : test::noisy_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const DihedralAngles angles = dihedral_angles(mesh, set.points).value();
    std::vector<double> maximum(set.points.size(), 0.0);
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      if (mesh.twins()[h] == kInvalid) {
        CHECK(angles.half_edge[h] == 0.0f);
        continue;
      }
      const DVec3 a = area_of(set, h / 3), b = area_of(set, mesh.twins()[h] / 3);
      const double angle = std::atan2(length(cross(a, b)), dot(a, b));
      // Concave: the other face's far corner lies above this one's plane.
      const std::uint32_t t = mesh.twins()[h];
      const auto far = mesh.origins()[3 * (t / 3) + (t + 2) % 3];
      const DVec3 here(set.points[mesh.origins()[h]]);
      const double expected = dot(a, DVec3(set.points[far]) - here) > 0 ? -angle : angle;
      // The direction of each normal is good to 16 · 2^-21 (see above).
      CHECK(std::fabs(angles.half_edge[h] - expected) < 32 * 0x1p-21);
      for (const VertexId v : {mesh.origin(HalfEdgeId(h)), mesh.target(HalfEdgeId(h))})
        maximum[v.index] = std::max(maximum[v.index], angle);
    }
    for (std::size_t v = 0; v < maximum.size(); ++v)
      CHECK(std::fabs(angles.vertex_maximum[v] - maximum[v]) < 32 * 0x1p-21);
  }
}
