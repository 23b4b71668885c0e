#include "mesh/edit/link_condition.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "mesh/edit_mesh_support.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

struct Vertex {
  std::uint32_t leading;
};
using Mesh = detail::EditMesh<Vertex>;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// The closed complex, by definition: the vertices and edges of the link of each vertex.
struct Links {
  std::vector<std::set<std::uint32_t>> vertices;
  std::vector<std::set<Pair>> edges;

  explicit Links(const Mesh& mesh) : vertices(mesh.apex() + 1), edges(mesh.apex() + 1) {
    for (std::uint32_t f = 0; f < mesh.half_edge_bound() / 4; ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& origin = mesh.face(4 * f).origin;
        const auto [a, b] = std::minmax(origin[(i + 1) % 3], origin[(i + 2) % 3]);
        vertices[origin[i]].insert({a, b});
        edges[origin[i]].insert({a, b});
      }
  }

  /// Lk(p) ∩ Lk(q) = Lk(pq), which is two vertices and no edge.
  [[nodiscard]] bool allow(std::uint32_t p, std::uint32_t q) const {
    std::vector<std::uint32_t> shared;
    std::set_intersection(vertices[p].begin(), vertices[p].end(), vertices[q].begin(), vertices[q].end(),
                          std::back_inserter(shared));
    std::vector<Pair> shared_edges;
    std::set_intersection(edges[p].begin(), edges[p].end(), edges[q].begin(), edges[q].end(),
                          std::back_inserter(shared_edges));
    return shared.size() == 2 && shared_edges.empty();
  }
};

/// The neighbours of the origin of h but its target, from beyond it.
std::vector<std::uint32_t> ring_beyond(const Mesh& mesh, std::uint32_t h) {
  std::vector<std::uint32_t> ring;
  for (std::uint32_t out = mesh.around_vertex(h); out != h; out = mesh.around_vertex(out))
    ring.push_back(mesh.target(out));
  return ring;
}

}  // namespace

TEST_CASE("the link condition is that of the closed complex", "[mesh][edit]") {
  std::size_t allowed = 0, forbidden = 0;
  std::vector<std::uint32_t> scratch;
  for (const IndexedFaceSet& shape :
       {test::tetrahedron(), test::icosphere(0), test::icosphere(1), test::torus(3, 3), test::torus(3, 5),
        test::torus(4, 7), test::grid(1, 1), test::grid(1, 4), test::grid(3, 5)}) {
    const Mesh mesh = test::edit_mesh_of<Vertex>(shape);
    const Links links(mesh);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h) {
        const std::vector<std::uint32_t> at_p = ring_beyond(mesh, h), at_q = ring_beyond(mesh, mesh.twin(h));
        const bool expected = links.allow(mesh.origin(h), mesh.target(h));
        CHECK(detail::meets_link_condition(at_p, at_q, scratch) == expected);
        ++(expected ? allowed : forbidden);
      }
  }
  CHECK(allowed > 100);
  CHECK(forbidden > 50);
}

TEST_CASE("edges that are there are found from either end", "[mesh][edit]") {
  for (const IndexedFaceSet& shape : {test::icosphere(0), test::torus(4, 7), test::grid(3, 5)}) {
    const Mesh mesh = test::edit_mesh_of<Vertex>(shape);
    const Links links(mesh);
    for (std::uint32_t p = 0; p < mesh.apex(); ++p)
      for (std::uint32_t q = 0; q < mesh.apex(); ++q)
        if (p != q) CHECK(mesh.has_edge(p, q) == links.vertices[p].contains(q));
  }
}

TEST_CASE("the tip of a tetrahedron is one, and no other vertex of three faces", "[mesh][edit]") {
  const auto is_tip = [](const Mesh& mesh, std::uint32_t v) {
    std::vector<std::uint32_t> edges;
    std::uint32_t h = mesh.vertices[v].leading;
    do {
      edges.push_back(h);
      h = mesh.around_vertex(h);
    } while (h != mesh.vertices[v].leading);
    return detail::is_tip_of_tetrahedron(mesh, edges);
  };
  CHECK(is_tip(test::edit_mesh_of<Vertex>(test::tetrahedron()), 0));
  CHECK(!is_tip(test::edit_mesh_of<Vertex>(test::icosphere(0)), 0));
  // A vertex within a triangle, and one triangle less of a tetrahedron.
  IndexedFaceSet open = test::tetrahedron();
  open.corners.resize(9);
  const Mesh mesh = test::edit_mesh_of<Vertex>(open);
  for (std::uint32_t v = 0; v < 4; ++v) CHECK(!is_tip(mesh, v));
}

}  // namespace vkmesh
