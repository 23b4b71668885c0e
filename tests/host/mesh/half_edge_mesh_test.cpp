#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/repair/consolidate.h>

#include "support/shapes.h"

using namespace vkmesh;

namespace {

struct Expected {
  const char* name;
  IndexedFaceSet mesh;
  std::size_t vertices, edges, faces, loops;
  int euler;
};

std::vector<Expected> shapes() {
  return {{"tetrahedron", test::tetrahedron(), 4, 6, 4, 0, 2},
          {"cube", test::cube(), 8, 18, 12, 0, 2},
          {"quad cube", test::quad_cube(), 8, 12, 6, 0, 2},
          {"icosphere", test::icosphere(3), 642, 1920, 1280, 0, 2},
          {"torus", test::torus(12, 8), 96, 288, 192, 0, 0},
          {"grid", test::grid(5, 3), 24, 53, 30, 1, 1},
          {"cylinder", test::cylinder(4, 7), 35, 91, 56, 2, 0}};
}

// The arrays of a mesh, to break one at a time.
struct Arrays {
  std::vector<std::uint32_t> origin, twin, leading, offsets;

  explicit Arrays(const HalfEdgeMesh& m)
      : origin(m.origins().begin(), m.origins().end()),
        twin(m.twins().begin(), m.twins().end()),
        leading(m.leadings().begin(), m.leadings().end()),
        offsets(m.face_offsets().begin(), m.face_offsets().end()) {}
  HalfEdgeMesh mesh() const { return HalfEdgeMesh::from_arrays(origin, twin, leading, offsets); }
};

void check_broken(const Arrays& arrays, const std::string& invariant) {
  const auto result = validate(arrays.mesh());
  REQUIRE_FALSE(result);
  CHECK_THAT(result.error().message, Catch::Contains(invariant));
}

}  // namespace

TEST_CASE("half-edge mesh: counts, Euler characteristic and boundary loops of known shapes") {
  for (const Expected& e : shapes()) {
    INFO(e.name);
    const HalfEdgeMesh mesh = test::half_edges(e.mesh);
    CHECK(validate(mesh));
    CHECK(mesh.vertex_count() == e.vertices);
    CHECK(mesh.edge_count() == e.edges);
    CHECK(mesh.face_count() == e.faces);
    CHECK(mesh.boundary_loops().size() == e.loops);
    CHECK(static_cast<int>(e.vertices) - static_cast<int>(e.edges) + static_cast<int>(e.faces) == e.euler);
  }
}

TEST_CASE("half-edge mesh: next, previous, twin and face agree with the corners of the faces") {
  for (const Expected& e : shapes()) {
    INFO(e.name);
    const HalfEdgeMesh mesh = test::half_edges(e.mesh);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = e.mesh.face(f);
      REQUIRE(mesh.face_size(FaceId(f)) == corners.size());
      std::size_t i = 0;
      for (const HalfEdgeId h : mesh.half_edges_around(FaceId(f))) {
        REQUIRE(i < corners.size());
        CHECK(mesh.face(h) == FaceId(f));
        CHECK(mesh.origin(h).index == corners[i]);
        CHECK(mesh.target(h).index == corners[(i + 1) % corners.size()]);
        CHECK(mesh.previous(mesh.next(h)) == h);
        CHECK(mesh.next(mesh.previous(h)) == h);
        if (!mesh.is_boundary(h)) CHECK(mesh.twin(mesh.twin(h)) == h);
        ++i;
      }
      CHECK(i == corners.size());
    }
  }
}

TEST_CASE("half-edge mesh: circulators around a vertex yield every face and neighbour once") {
  for (const Expected& e : shapes()) {
    INFO(e.name);
    const HalfEdgeMesh mesh = test::half_edges(e.mesh);
    std::size_t neighbours = 0, faces = 0;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      std::vector<std::uint32_t> seen;
      mesh.for_each_neighbour(VertexId(v), [&](VertexId n) { seen.push_back(n.index); });
      neighbours += seen.size();
      std::size_t around = 0;
      for (const FaceId f : mesh.faces_around(VertexId(v))) {
        std::size_t holds = 0;
        for (const VertexId c : mesh.vertices_around(f)) holds += c.index == v;
        CHECK(holds == 1);
        ++around;
      }
      faces += around;
      CHECK(seen.size() == around + (mesh.is_boundary(VertexId(v)) ? 1 : 0));
      std::sort(seen.begin(), seen.end());
      CHECK(std::adjacent_find(seen.begin(), seen.end()) == seen.end());
      for (const std::uint32_t n : seen) {
        const bool joined = mesh.find_half_edge(VertexId(v), VertexId(n)).valid() ||
                            mesh.find_half_edge(VertexId(n), VertexId(v)).valid();
        CHECK(joined);
      }
    }
    CHECK(neighbours == 2 * mesh.edge_count());
    CHECK(faces == mesh.half_edge_count());
  }
}

TEST_CASE("half-edge mesh: neighbours run counter-clockwise seen from outside") {
  const HalfEdgeMesh mesh = test::half_edges(test::grid(2, 2));
  std::vector<std::uint32_t> middle, corner;
  mesh.for_each_neighbour(VertexId(4), [&](VertexId n) { middle.push_back(n.index); });
  std::rotate(middle.begin(), std::find(middle.begin(), middle.end(), 5u), middle.end());
  CHECK(middle == std::vector<std::uint32_t>{5, 8, 7, 3, 0, 1});
  // The fan of a corner runs from one boundary edge to the other.
  mesh.for_each_neighbour(VertexId(0), [&](VertexId n) { corner.push_back(n.index); });
  CHECK(corner == std::vector<std::uint32_t>{1, 4, 3});
}

TEST_CASE("half-edge mesh: faces across the edges of a face") {
  const HalfEdgeMesh mesh = test::half_edges(test::grid(1, 1));
  std::vector<FaceId> across;
  for (const FaceId f : mesh.faces_around(FaceId(0))) across.push_back(f);
  CHECK(across == std::vector<FaceId>{FaceId{}, FaceId{}, FaceId(1)});
}

TEST_CASE("half-edge mesh: a boundary loop runs along the around") {
  const HalfEdgeMesh mesh = test::half_edges(test::grid(2, 1));
  const auto loops = mesh.boundary_loops();
  REQUIRE(loops.size() == 1);
  std::vector<std::uint32_t> around;
  for (const HalfEdgeId h : loops[0]) around.push_back(mesh.origin(h).index);
  CHECK(around == std::vector<std::uint32_t>{0, 1, 2, 5, 4, 3});
}

TEST_CASE("half-edge mesh: an isolated vertex has no half-edge and circulates over nothing") {
  IndexedFaceSet set = test::tetrahedron();
  set.points.emplace_back(9.0f, 9.0f, 9.0f);
  const HalfEdgeMesh mesh = test::half_edges(set);
  CHECK(validate(mesh));
  CHECK(mesh.is_isolated(VertexId(4)));
  CHECK_FALSE(mesh.is_boundary(VertexId(4)));
  std::size_t met = 0;
  for ([[maybe_unused]] const HalfEdgeId h : mesh.half_edges_around(VertexId(4))) ++met;
  mesh.for_each_neighbour(VertexId(4), [&](VertexId) { ++met; });
  CHECK(met == 0);
}

TEST_CASE("validate names the broken invariant") {
  const Arrays sphere(test::half_edges(test::icosphere(1)));
  const Arrays sheet(test::half_edges(test::grid(2, 2)));
  const Arrays quads(test::half_edges(test::quad_cube()));
  CHECK(validate(sphere.mesh()));

  Arrays a = sphere;
  a.origin[7] = 1000;
  check_broken(a, "an origin is a vertex");
  a = sphere;
  a.twin.pop_back();
  check_broken(a, "one twin for each half-edge");
  a = sphere;
  a.origin.pop_back();
  a.twin.pop_back();
  check_broken(a, "three half-edges for each triangle");
  a = sphere;
  a.twin[3] = 5000;
  check_broken(a, "a twin is a half-edge");
  a = sphere;
  a.twin[3] = a.twin[4];
  check_broken(a, "twins are mutual");
  a = sphere;
  std::swap(a.origin[0], a.origin[1]);
  check_broken(a, "twins run in opposite directions");
  a = sphere;
  a.origin[1] = a.origin[0];
  check_broken(a, "a face repeats no vertex");
  a = sphere;
  a.leading[5] = a.leading[6];
  check_broken(a, "a leading half-edge leaves its vertex");
  a = sphere;
  a.leading[5] = kInvalid;
  check_broken(a, "a vertex with faces has a leading half-edge");
  a = sheet;
  a.leading[0] = 3;  // leaves vertex 0, but not along the boundary
  check_broken(a, "a leading half-edge starts its fan");
  a = quads;
  a.offsets[2] = 6;
  check_broken(a, "a face has three or more half-edges");
  a = quads;
  a.offsets.back() = 23;
  check_broken(a, "face offsets run from 0");

  // Two tetrahedra that share vertex 0: every edge is in order, the vertex is not.
  const IndexedFaceSet tie = test::bow_tie();
  Arrays one(test::half_edges(test::tetrahedron()));
  Arrays both = one;
  both.origin.assign(tie.corners.begin(), tie.corners.end());
  both.twin.resize(24, kInvalid);
  for (std::uint32_t h = 0; h < 24; ++h)
    for (std::uint32_t g = 0; g < 24; ++g)
      if (tie.corners[h] == tie.corners[g % 3 == 2 ? g - 2 : g + 1] &&
          tie.corners[g] == tie.corners[h % 3 == 2 ? h - 2 : h + 1])
        both.twin[h] = g;
  both.leading.assign(7, kInvalid);
  for (std::uint32_t h = 24; h-- > 0;) both.leading[tie.corners[h]] = h;
  check_broken(both, "the faces of a vertex form one fan");

  // Two triangles back to back, open along one of their three edges: the fan of 0 ends at the neighbour it
  // began with.
  Arrays pillow = one;
  pillow.origin = {0, 1, 2, 0, 2, 1};
  pillow.twin = {kInvalid, 4, 3, 2, 1, kInvalid};
  pillow.leading = {0, 5, 2};
  check_broken(pillow, "no edge is used twice");
}
