// Queries and walks on half-edges, against a search through everything.
#include <algorithm>
#include <new>
#include <set>
#include <stdexcept>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/mesh/connected_components.h>
#include <vkmesh/mesh/memory.h>
#include <vkmesh/mesh/mesh_walks.h>
#include <vkmesh/repair/consolidate.h>

#include "support/shapes.h"

using namespace vkmesh;

namespace {

std::vector<IndexedFaceSet> polygon_shapes() {
  IndexedFaceSet mixed = test::quad_cube();  // Quads, triangles and a pentagon.
  mixed.points.insert(mixed.points.end(), {{5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}, {4, 1, 0}, {5, 2, 0}});
  mixed.corners.insert(mixed.corners.end(), {8, 9, 10, 11, 12, 11, 10, 13});
  mixed.face_offsets.insert(mixed.face_offsets.end(), {29, 32});
  return {test::tetrahedron(), test::quad_cube(), mixed,
          test::torus(5, 4),   test::grid(4, 3),  test::cylinder(3, 5)};
}

}  // namespace

TEST_CASE("edges of the mesh, of a vertex and beside an edge", "[walks]") {
  for (const IndexedFaceSet& set : polygon_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    std::vector<HalfEdgeId> edges;
    mesh.for_each_edge([&](HalfEdgeId e) { edges.push_back(e); });
    CHECK(edges.size() == mesh.edge_count());
    CHECK(std::is_sorted(edges.begin(), edges.end()));
    const auto ends = [&](HalfEdgeId e) {
      const auto [a, b] = mesh.vertices_of_edge(e);
      return std::set<std::uint32_t>{a.index, b.index};
    };
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      std::vector<HalfEdgeId> around, expected;
      mesh.for_each_edge_around(VertexId(v), [&](HalfEdgeId e) { around.push_back(e); });
      for (const HalfEdgeId e : edges)
        if (ends(e).contains(v)) expected.push_back(e);
      std::sort(around.begin(), around.end());
      CHECK(around == expected);
    }
    for (const HalfEdgeId e : edges) {
      std::vector<HalfEdgeId> beside, expected;
      mesh.for_each_neighbour_of_edge(e, [&](HalfEdgeId n) { beside.push_back(n); });
      for (const HalfEdgeId n : edges)
        if (n != e && (ends(n).contains(mesh.origin(e).index) || ends(n).contains(mesh.target(e).index)))
          expected.push_back(n);
      std::sort(beside.begin(), beside.end());
      CHECK(beside == expected);
      // The faces that have both ends side by side.
      std::set<std::uint32_t> faces;
      for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (const HalfEdgeId h : mesh.half_edges_around(FaceId(f)))
          if (ends(h) == ends(e)) faces.insert(f);
      std::set<std::uint32_t> ours;
      for (const FaceId f : mesh.faces_of_edge(e))
        if (f.valid()) ours.insert(f.index);
      CHECK(ours == faces);
    }
  }
}

TEST_CASE("a breadth-first walk meets every face of its component at its distance", "[walks]") {
  for (const IndexedFaceSet& set : polygon_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    // Distances by relaxing all edges until nothing changes.
    std::vector<std::size_t> distance(mesh.face_count(), mesh.face_count());
    distance[1] = 0;
    for (bool again = true; again;) {
      again = false;
      mesh.for_each_edge([&](HalfEdgeId e) {
        const auto [f, g] = mesh.faces_of_edge(e);
        if (!g.valid()) return;
        for (const auto& [from, to] : {std::pair{f, g}, std::pair{g, f}})
          if (distance[from.index] + 1 < distance[to.index]) {
            distance[to.index] = distance[from.index] + 1;
            again = true;
          }
      });
    }
    std::size_t last = 0, visited = 0;
    REQUIRE(walk_breadth_first(mesh, FaceId(1), [&](FaceId f, std::size_t steps) {
      CHECK(distance[f.index] == steps);
      CHECK(steps >= last);
      last = steps;
      ++visited;
      return true;
    }));
    const FaceComponents parts = face_components(mesh).value();
    CHECK(visited == parts.faces[parts.of_face[1]]);
    std::size_t few = 0;
    REQUIRE(walk_breadth_first(mesh, FaceId(0), [&](FaceId, std::size_t) { return ++few < 3; }));
    CHECK(few == 3);
    const auto thrown = walk_breadth_first(
        mesh, FaceId(0), [](FaceId, std::size_t) -> bool { throw std::runtime_error("no more"); });
    CHECK(thrown.error().describe() == "unexpected exception: no more");
    const auto full =
        walk_breadth_first(mesh, FaceId(0), [](FaceId, std::size_t) -> bool { throw std::bad_alloc(); });
    CHECK(full.error().code == ErrorCode::kOutOfMemory);
  }
}

TEST_CASE("components are those of the topology", "[walks]") {
  for (const IndexedFaceSet& set : polygon_shapes()) {
    const FaceComponents parts = face_components(test::half_edges(set)).value();
    const SurfaceTopology topology = surface_topology(set).value();
    CHECK(parts.of_face == topology.component_of_face);
    REQUIRE(parts.faces.size() == topology.components.size());
    for (std::size_t i = 0; i < parts.faces.size(); ++i)
      CHECK(parts.faces[i] == topology.components[i].faces);
  }
}

TEST_CASE("faces and half-edges are inverses", "[walks]") {
  for (const IndexedFaceSet& set : polygon_shapes()) {
    const IndexedFaceSet back = to_indexed_face_set(test::half_edges(set), set.points).value();
    CHECK(back.points == set.points);
    CHECK(back.corners == set.corners);
    CHECK(back.face_offsets == set.face_offsets);
  }
  CHECK(to_indexed_face_set(test::half_edges(test::cube()), {}).error().code == ErrorCode::kUsage);
}

TEST_CASE("memory per element is what docs/structures.md says", "[memory]") {
  // A closed triangle mesh of genus 1: 2 triangles and 3 edges for each vertex.
  const IndexedFaceSet set = test::torus(64, 32);
  const std::size_t vertices = set.points.size();
  REQUIRE(set.face_count() == 2 * vertices);
  const HalfEdgeMesh mesh = test::half_edges(set);
  CHECK(bytes_of(set) == 36 * vertices);   // 12 a point, 12 a triangle.
  CHECK(bytes_of(mesh) == 52 * vertices);  // 8 a half-edge, 4 a vertex.
  CHECK(bytes_of(triangle_neighbours(mesh).value()) == 52 * vertices);
  CHECK(bytes_of(node_neighbours(mesh).value()) == 28 * vertices + 4 + vertices / 8);
  CHECK(bytes_of(vertex_corners(mesh).value()) == 28 * vertices + 4);
  PolygonSoup soup;
  soup.corners.resize(set.corners.size());
  CHECK(bytes_of(soup) == 36 * set.face_count());

  // Polygons: 4 more a half-edge, 4 more a face and 4 at the end.
  const IndexedFaceSet quads = test::quad_cube();
  CHECK(bytes_of(test::half_edges(quads)) == 24 * 12 + 8 * 4 + 7 * 4);
  IndexedFaceSet coloured = test::cube();
  coloured.point_channels = {{"color", 3, std::vector<std::uint8_t>(24)}};
  CHECK(bytes_of(coloured) == 8 * 12 + 12 * 12 + 24);
}
