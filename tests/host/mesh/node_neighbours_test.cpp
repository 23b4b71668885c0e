#include <algorithm>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/mesh/vertex_corners.h>

#include "support/shapes.h"

using namespace vkmesh;

namespace {

std::vector<IndexedFaceSet> triangle_shapes() {
  IndexedFaceSet isolated = test::grid(3, 3);
  isolated.points.emplace_back(0.0f, 0.0f, 5.0f);
  return {test::tetrahedron(), test::cube(),     test::icosphere(2),   test::torus(6, 5),
          test::grid(4, 3),    test::grid(1, 1), test::cylinder(3, 5), isolated};
}

NodeNeighbours neighbours_of(const IndexedFaceSet& set) {
  return node_neighbours(test::half_edges(set)).value();
}

}  // namespace

TEST_CASE("node neighbours hold the circulators' neighbours, and know the boundary") {
  for (const IndexedFaceSet& set : triangle_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const NodeNeighbours neighbours = node_neighbours(mesh).value();
    REQUIRE(neighbours.vertex_count() == mesh.vertex_count());
    CHECK(neighbours.ids.size() == 2 * mesh.edge_count());
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      std::vector<std::uint32_t> expected;
      mesh.for_each_neighbour(VertexId(v), [&](VertexId n) { expected.push_back(n.index); });
      const auto actual = neighbours.of(VertexId(v));
      CHECK(std::equal(actual.begin(), actual.end(), expected.begin(), expected.end()));
      CHECK(neighbours.is_boundary(VertexId(v)) == mesh.is_boundary(VertexId(v)));
    }
  }
}

TEST_CASE("half-edges from node neighbours: the same triangles come back") {
  const auto triangles = [](const HalfEdgeMesh& mesh) {
    std::vector<std::array<std::uint32_t, 3>> list;
    for (std::size_t h = 0; h < mesh.half_edge_count(); h += 3) {
      std::array<std::uint32_t, 3> t = {mesh.origins()[h], mesh.origins()[h + 1], mesh.origins()[h + 2]};
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      list.push_back(t);
    }
    std::sort(list.begin(), list.end());
    return list;
  };
  for (const IndexedFaceSet& set : triangle_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const auto back = to_half_edge_mesh(node_neighbours(mesh).value());
    REQUIRE(back);
    CHECK(validate(*back));
    CHECK(triangles(*back) == triangles(mesh));
  }
}

TEST_CASE("neighbour lists of no triangle mesh are refused") {
  const auto refused = [](const NodeNeighbours& n) {
    const auto result = to_half_edge_mesh(n);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kUnsuitable);
  };
  const NodeNeighbours good = neighbours_of(test::icosphere(1));
  NodeNeighbours n = good;
  std::swap(n.ids[0], n.ids[1]);  // not the cyclic order
  refused(n);
  n = good;
  n.ids[3] = 4000;
  refused(n);
  n = good;
  n.boundary_bits[0] ^= 1;
  refused(n);
  n = good;
  n.offsets[1] = n.offsets[2] + 1;
  refused(n);
  refused(neighbours_of(test::quad_cube()));
}

TEST_CASE("vertex corners are the half-edges that leave a vertex, ascending") {
  for (const IndexedFaceSet& set : triangle_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const VertexCorners corners = vertex_corners(mesh).value();
    std::size_t total = 0;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      const auto around = corners.of(VertexId(v));
      total += around.size();
      CHECK(std::is_sorted(around.begin(), around.end()));
      for (const std::uint32_t h : around) CHECK(mesh.origins()[h] == v);
    }
    CHECK(total == mesh.half_edge_count());
  }
}
