#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/triangle_neighbours.h>

#include "support/shapes.h"

using namespace vkmesh;

namespace {

std::vector<IndexedFaceSet> closed_and_open_triangles() {
  IndexedFaceSet isolated = test::grid(3, 3);
  isolated.points.emplace_back(0.0f, 0.0f, 5.0f);
  return {test::tetrahedron(), test::icosphere(2),   test::torus(6, 5),    test::grid(4, 3),
          test::grid(1, 1),    test::cylinder(3, 5), test::double_torus(), isolated};
}

}  // namespace

TEST_CASE("the neighbour opposite a corner shares the edge opposite it", "[triangle_neighbours]") {
  for (const IndexedFaceSet& set : closed_and_open_triangles()) {
    const TriangleNeighbours triangles = triangle_neighbours(test::half_edges(set)).value();
    REQUIRE(triangles.corners == set.corners);
    for (std::uint32_t t = 0; t < triangles.triangle_count(); ++t)
      for (unsigned i = 0; i < 3; ++i) {
        const std::array<VertexId, 3> v = triangles.vertices_of(FaceId(t));
        const FaceId n = triangles.neighbours_of(FaceId(t))[i];
        // Found by looking at every other triangle.
        std::uint32_t expected = kInvalid;
        for (std::uint32_t other = 0; other < triangles.triangle_count(); ++other)
          if (other != t && triangles.place(FaceId(other), v[(i + 1) % 3]) < 3 &&
              triangles.place(FaceId(other), v[(i + 2) % 3]) < 3)
            expected = other;
        REQUIRE(n.index == expected);
      }
  }
}

TEST_CASE("triangles, neighbours and edges around a vertex are those of the half-edges",
          "[triangle_neighbours]") {
  for (const IndexedFaceSet& set : closed_and_open_triangles()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const TriangleNeighbours triangles = triangle_neighbours(mesh).value();
    for (std::uint32_t i = 0; i < mesh.vertex_count(); ++i) {
      const VertexId v(i);
      std::vector<FaceId> faces, theirs;
      if (!mesh.is_isolated(v))
        for (const FaceId f : mesh.faces_around(v)) faces.push_back(f);
      triangles.for_each_triangle(v, [&](FaceId t) { theirs.push_back(t); });
      CHECK(faces == theirs);
      std::vector<VertexId> nodes, their_nodes;
      mesh.for_each_neighbour(v, [&](VertexId n) { nodes.push_back(n); });
      triangles.for_each_neighbour(v, [&](VertexId n) { their_nodes.push_back(n); });
      CHECK(nodes == their_nodes);
      CHECK(triangles.is_boundary(v) == mesh.is_boundary(v));
      CHECK(triangles.is_isolated(v) == mesh.is_isolated(v));
      for (const VertexId n : nodes) {
        const std::array<FaceId, 2> pair = triangles.triangles_of_edge(v, n);
        const HalfEdgeId out = mesh.find_half_edge(v, n), in = mesh.find_half_edge(n, v);
        CHECK(pair[0] == (out.valid() ? mesh.face(out) : FaceId{}));
        CHECK(pair[1] == (in.valid() ? mesh.face(in) : FaceId{}));
      }
    }
  }
}

TEST_CASE("half-edges come back from triangle neighbours", "[triangle_neighbours]") {
  for (const IndexedFaceSet& set : closed_and_open_triangles()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const auto back = to_half_edge_mesh(triangle_neighbours(mesh).value());
    REQUIRE(back);
    CHECK(std::equal(mesh.origins().begin(), mesh.origins().end(), back->origins().begin()));
    CHECK(std::equal(mesh.twins().begin(), mesh.twins().end(), back->twins().begin()));
    CHECK(std::equal(mesh.leadings().begin(), mesh.leadings().end(), back->leadings().begin()));
  }
}

TEST_CASE("arrays that are no triangle mesh are refused", "[triangle_neighbours]") {
  const TriangleNeighbours good = triangle_neighbours(test::half_edges(test::grid(3, 3))).value();
  const auto refused = [&](auto&& spoil) {
    TriangleNeighbours bad = good;
    spoil(bad);
    const auto result = to_half_edge_mesh(bad);
    return !result && result.error().code == ErrorCode::kUnsuitable;
  };
  CHECK(refused([](TriangleNeighbours& t) { t.corners[4] = 99; }));
  CHECK(refused([](TriangleNeighbours& t) { t.neighbours.pop_back(); }));
  CHECK(refused([](TriangleNeighbours& t) { t.neighbours[0] = 99; }));
  CHECK(refused([](TriangleNeighbours& t) {
    for (std::uint32_t& n : t.neighbours)
      if (n != kInvalid) {
        n = n == 17 ? 0 : 17;  // Some triangle that is not across.
        break;
      }
  }));
  CHECK(refused([](TriangleNeighbours& t) { t.leading[5] = 99; }));
  CHECK(refused([](TriangleNeighbours& t) { t.leading[15] = 0; }));
  CHECK(refused([](TriangleNeighbours& t) { std::swap(t.corners[0], t.corners[1]); }));
  CHECK(triangle_neighbours(test::half_edges(test::quad_cube())).error().code == ErrorCode::kUnsuitable);
}
