#include "mesh/edit/edit_mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "mesh/edit/gather.h"
#include "mesh/edit/link_condition.h"
#include "mesh/edit/one_ring.h"
#include "mesh/edit_mesh_support.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using detail::kVertexGone;
using detail::LongRing;

struct Vertex {
  std::uint32_t leading;
};
using Mesh = detail::EditMesh<Vertex>;
using Face = Mesh::Face;
using Triangle = std::array<std::uint32_t, 3>;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::uint32_t kFaceTags = 0x88888888u;

std::uint32_t face_tags(std::uint32_t source) {
  return (source * 0x9e3779b1u) & kFaceTags;
}

Mesh mesh_of(const IndexedFaceSet& set) {
  return test::edit_mesh_of<Vertex>(set, face_tags);
}

template <class F>
void for_each_half_edge(const Mesh& mesh, F&& f) {
  for (std::uint32_t h = 0; h < mesh.half_edge_bound(); ++h)
    if (h % 4 != 3 && mesh.alive(h)) f(h);
}

/// Random tags of one half-edge of a mesh, as one number.
std::uint32_t tags_of(const Mesh& mesh, std::uint32_t h) {
  std::uint32_t tags = 0;
  for (unsigned k = 0; k < 8; ++k) tags |= (mesh.has_tag(h, k) ? 1u : 0u) << k;
  return tags;
}

/// A surface as a list of triangles, edited by definition, and the tags of its half-edges. `apex` stands for
/// the vertex of the ghosts.
struct Model {
  std::vector<Triangle> triangles;
  std::map<Pair, std::uint32_t> tags;
  std::uint32_t apex = kInvalid;

  [[nodiscard]] std::set<Pair> edges() const {
    std::set<Pair> all;
    for (const auto& [a, b, c] : triangles)
      for (const Pair& edge : {Pair{a, b}, Pair{b, c}, Pair{c, a}}) REQUIRE(all.insert(edge).second);
    return all;
  }
  /// The corner across from the directed edge; `apex` where there is no triangle.
  [[nodiscard]] std::uint32_t across(std::uint32_t p, std::uint32_t q) const {
    for (const Triangle& t : triangles)
      for (std::size_t i = 0; i < 3; ++i)
        if (t[i] == p && t[(i + 1) % 3] == q) return t[(i + 2) % 3];
    return apex;
  }
  [[nodiscard]] bool has_edge(std::uint32_t p, std::uint32_t q) const {
    return std::ranges::any_of(triangles, [&](const Triangle& t) {
      return std::ranges::count(t, p) + std::ranges::count(t, q) == 2;
    });
  }
  /// Neighbours, the apex among them at the boundary.
  [[nodiscard]] std::set<std::uint32_t> neighbours(std::uint32_t v) const {
    std::set<std::uint32_t> all;
    std::size_t faces = 0;
    for (const Triangle& t : triangles) {
      if (std::ranges::count(t, v) == 0) continue;
      ++faces;
      all.insert(t.begin(), t.end());
    }
    all.erase(v);
    if (all.size() != faces) all.insert(apex);
    return all;
  }
  [[nodiscard]] std::set<Triangle> canonical() const {
    std::set<Triangle> all;
    for (Triangle t : triangles) {
      std::rotate(t.begin(), std::ranges::min_element(t), t.end());
      REQUIRE(all.insert(t).second);
    }
    return all;
  }

  struct Counts {
    std::ptrdiff_t characteristic;
    std::size_t boundary_loops;
    bool operator==(const Counts&) const = default;
  };
  [[nodiscard]] Counts counts() const {
    const std::set<Pair> directed = edges();
    std::set<std::uint32_t> used;
    std::map<std::uint32_t, std::uint32_t> boundary;
    std::size_t undirected = 0;
    for (const auto& [p, q] : directed) {
      used.insert(p);
      const bool single = !directed.contains({q, p});
      undirected += single || p < q ? 1 : 0;
      if (single) REQUIRE(boundary.emplace(p, q).second);
    }
    Counts result{
        static_cast<std::ptrdiff_t>(used.size() + triangles.size()) - static_cast<std::ptrdiff_t>(undirected),
        0};
    while (!boundary.empty()) {
      ++result.boundary_loops;
      for (auto at = boundary.begin(); at != boundary.end();) {
        const std::uint32_t next = at->second;
        boundary.erase(at);
        at = boundary.find(next);
      }
    }
    return result;
  }

  static bool has_both(const Triangle& t, std::uint32_t p, std::uint32_t q) {
    return std::ranges::count(t, p) + std::ranges::count(t, q) == 2;
  }
  /// New triangles have the tags of half-edges that were there, if those are kept, and else none.
  template <class Goes>
  void replace(Goes&& goes, const std::vector<Triangle>& made, bool keep_tags) {
    const auto before = tags;
    for (const Triangle& t : triangles)
      for (std::size_t i = 0; i < 3 && goes(t); ++i) tags.erase({t[i], t[(i + 1) % 3]});
    std::erase_if(triangles, goes);
    for (const Triangle& t : made) {
      triangles.push_back(t);
      for (std::size_t i = 0; i < 3; ++i) {
        const Pair edge{t[i], t[(i + 1) % 3]};
        const auto found = before.find(edge);
        tags[edge] = keep_tags && found != before.end() ? found->second : 0;
      }
    }
  }
  void collapse(std::uint32_t p, std::uint32_t q) {
    replace([&](const Triangle& t) { return has_both(t, p, q); }, {}, false);
    for (Triangle& t : triangles) std::ranges::replace(t, p, q);
    std::map<Pair, std::uint32_t> renamed;
    for (const auto& [edge, tag] : tags)
      renamed[{edge.first == p ? q : edge.first, edge.second == p ? q : edge.second}] = tag;
    tags = renamed;
  }
  void flip(std::uint32_t p, std::uint32_t q) {
    const std::uint32_t a = across(p, q), b = across(q, p), to = tags.at({p, q}), back = tags.at({q, p});
    replace([&](const Triangle& t) { return has_both(t, p, q); }, {{b, a, p}, {a, b, q}}, true);
    tags[{b, a}] = to;
    tags[{a, b}] = back;
  }
  void split(std::uint32_t p, std::uint32_t q, std::uint32_t m) {
    for (const Pair& edge : {Pair{p, q}, Pair{q, p}}) {
      const std::uint32_t from = edge.first, to = edge.second;
      const std::uint32_t a = across(from, to);
      if (a == apex) continue;
      const std::uint32_t tag = tags.at({from, to});
      replace([&](const Triangle& t) { return has_both(t, from, to) && std::ranges::count(t, a) > 0; },
              {{from, m, a}, {m, to, a}}, true);
      tags[{from, m}] = tags[{m, to}] = tag;
    }
  }
};

Model model_of(const Mesh& mesh) {
  Model model;
  model.apex = mesh.apex();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.alive(4 * f)) model.triangles.push_back(mesh.face(4 * f).origin);
  for_each_half_edge(mesh, [&](std::uint32_t h) {
    if (!mesh.is_ghost(h)) model.tags[{mesh.origin(h), mesh.target(h)}] = tags_of(mesh, h);
  });
  return model;
}

void check_valid(const Mesh& mesh) {
  if (const auto valid = mesh.validate(); !valid) FAIL(valid.error().describe());
}

void check_same(const Mesh& mesh, const Model& model, const Model::Counts& counts) {
  check_valid(mesh);
  const Model now = model_of(mesh);
  REQUIRE(now.canonical() == model.canonical());
  REQUIRE(now.tags == model.tags);
  REQUIRE(model.counts() == counts);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.alive(4 * f)) REQUIRE((mesh.face(4 * f).tags & kFaceTags) == face_tags(mesh.face(4 * f).source));
}

/// Whether the edge can collapse: the link condition of the closed complex, by definition.
bool can_collapse(const Model& model, std::uint32_t p, std::uint32_t q) {
  const auto at_p = model.neighbours(p), at_q = model.neighbours(q);
  const auto shared = std::ranges::count_if(at_p, [&](std::uint32_t v) { return at_q.contains(v); });
  return shared == 2 && at_p.size() + at_q.size() > 6;
}

bool link_condition(const Mesh& mesh, std::uint32_t h) {
  LongRing p, q;
  p.gather(mesh, h);
  q.gather(mesh, mesh.twin(h));
  std::vector<std::uint32_t> sorted;
  return detail::meets_link_condition(p.ring().vertices, q.ring().vertices, sorted);
}

/// Does one random edit to both if it is legal.
class Editor {
 public:
  Editor(const IndexedFaceSet& shape, std::uint32_t seed) : mesh(mesh_of(shape)), random_(seed) {
    for_each_half_edge(mesh, [&](std::uint32_t h) {
      for (unsigned k = 0; k < 8; ++k)
        if (random_() % 2 == 0) mesh.set_tag(h, k);
    });
    model = model_of(mesh);
  }

  [[nodiscard]] std::uint32_t random_half_edge() {
    while (true) {
      const auto h = static_cast<std::uint32_t>(random_() % mesh.half_edge_bound());
      if (h % 4 != 3 && mesh.alive(h)) return h;
    }
  }

  bool collapse() {
    const std::uint32_t h = random_half_edge(), p = mesh.origin(h), q = mesh.target(h);
    if (p == mesh.apex() || q == mesh.apex()) return false;
    const bool legal = link_condition(mesh, h);
    REQUIRE(legal == can_collapse(model, p, q));
    if (!legal) return false;
    LongRing ring;
    ring.gather(mesh, h);
    const std::vector<std::uint32_t> others(ring.ring().edges.begin(), ring.ring().edges.end());
    const std::size_t faces = model.triangles.size();
    const Mesh::Collapsed collapsed = mesh.collapse(h, others);
    model.collapse(p, q);
    CHECK(faces - model.triangles.size() == collapsed.faces);
    for (const auto& [g, t] : collapsed.joined) {
      CHECK(mesh.twin(g) == t);
      CHECK(mesh.origin(g) == q);
    }
    CHECK(mesh.vertices[p].leading == (kVertexGone | q));
    return true;
  }

  bool flip() {
    const std::uint32_t h = random_half_edge(), p = mesh.origin(h), q = mesh.target(h);
    const std::uint32_t a = model.across(p, q), b = model.across(q, p);
    const bool inner = p != model.apex && q != model.apex && a != model.apex && b != model.apex;
    const bool legal = inner && !model.has_edge(a, b);
    REQUIRE(mesh.can_flip(h) == legal);
    if (!legal) return false;
    mesh.flip(h);
    model.flip(p, q);
    CHECK(mesh.origin(h) == b);
    CHECK(mesh.target(h) == a);
    return true;
  }

  bool split() {
    const std::uint32_t h = random_half_edge();
    if (mesh.is_ghost(h)) return false;
    const std::uint32_t p = mesh.origin(h), q = mesh.target(h);
    const std::size_t bound = mesh.vertex_bound();
    const std::uint32_t m = mesh.split(h);
    REQUIRE(m == bound);
    REQUIRE(mesh.origin(h) == p);
    REQUIRE(mesh.target(h) == m);
    model.split(p, q, m);
    return true;
  }

  bool remove_vertex() {
    const std::uint32_t v = mesh.origin(random_half_edge());
    if (v == mesh.apex()) return false;
    std::vector<std::uint32_t> edges;
    std::uint32_t h = mesh.vertices[v].leading;
    do {
      edges.push_back(h);
      h = mesh.around_vertex(h);
    } while (h != mesh.vertices[v].leading);
    const auto outer = std::ranges::find(edges, mesh.apex(), [&](std::uint32_t e) { return mesh.target(e); });
    const bool closed = outer == edges.end();
    if (!closed) std::rotate(edges.begin(), outer + 1, edges.end());
    const std::size_t neighbours = edges.size() - (closed ? 0 : 1);
    if (edges.size() > Mesh::kMaxHoleEdges || neighbours < (closed ? 3 : 2)) return false;
    const auto at = [&](std::size_t i) { return mesh.target(edges[i]); };
    // A fan of the first neighbour; where nothing closes the hole but a face that is there, or the last
    // triangle of a component goes, there is no other surface.
    const std::size_t last = neighbours - 1;
    std::vector<std::array<std::uint8_t, 3>> fan;
    std::vector<Triangle> made;
    if (!closed) fan.push_back({0, static_cast<std::uint8_t>(last), static_cast<std::uint8_t>(last + 1)});
    for (std::size_t k = last; k > 1; --k) {
      fan.push_back({0, static_cast<std::uint8_t>(k - 1), static_cast<std::uint8_t>(k)});
      made.push_back({at(0), at(k - 1), at(k)});
      if (k < last && model.has_edge(at(0), at(k))) return false;
    }
    if (!closed && last > 1 && model.has_edge(at(0), at(last))) return false;
    if (closed && last == 2 && model.across(at(1), at(0)) == at(2)) return false;
    if (!closed && last == 1 && model.across(at(1), at(0)) == model.apex) return false;
    const std::uint32_t first = at(0);
    std::vector<std::uint32_t> sources;
    for (const std::uint32_t e : edges) sources.push_back(mesh.face(e).source);
    const auto gone = mesh.fill_hole(edges, fan, closed ? random_() % (edges.size() - 1) : 0);
    for (const std::uint32_t source : gone) CHECK(std::ranges::count(sources, source) > 0);
    mesh.vertices[v].leading = kVertexGone | first;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      if (Face& face = mesh.face(4 * f); face.alive() && face.tags == 0) face.tags = face_tags(face.source);
    model.replace([&](const Triangle& t) { return std::ranges::count(t, v) > 0; }, made, false);
    return true;
  }

  Mesh mesh;
  Model model;

 private:
  std::mt19937 random_;
};

/// Records and where fans begin, to compare.
struct Snapshot {
  explicit Snapshot(const Mesh& mesh) {
    for (std::uint32_t f = 0; f < mesh.half_edge_bound() / 4; ++f) {
      const Face& face = mesh.face(4 * f);
      faces.emplace_back(face.origin, face.twin, face.tags, face.source);
    }
  }
  std::vector<std::tuple<Triangle, Triangle, std::uint32_t, std::uint32_t>> faces;
};

std::vector<IndexedFaceSet> shapes() {
  return {test::icosphere(1), test::torus(9, 7), test::grid(7, 6), test::cylinder(4, 7), test::tetrahedron()};
}

}  // namespace

TEST_CASE("edits leave connectivity valid, and do what they do to a list of triangles", "[mesh][edit]") {
  std::array<std::size_t, 4> done{};
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    Editor editor(shapes()[seed % 5], seed);
    const Model::Counts counts = editor.model.counts();
    check_same(editor.mesh, editor.model, counts);
    std::mt19937 random(seed);
    for (int i = 0; i < 250; ++i) {
      const std::size_t edit = random() % 4;
      const bool changed = edit == 0   ? editor.collapse()
                           : edit == 1 ? editor.flip()
                           : edit == 2 ? editor.split()
                                       : editor.remove_vertex();
      if (!changed) continue;
      ++done[edit];
      INFO("seed " << seed << ", edit " << edit);
      check_same(editor.mesh, editor.model, counts);
    }
  }
  for (const std::size_t times : done) CHECK(times > 150);
}

TEST_CASE("a flip undone is as if nothing had been, and two are the same triangles", "[mesh][edit]") {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    Editor editor(shapes()[seed], seed);
    std::size_t flips = 0;
    for (int i = 0; i < 200; ++i) {
      const std::uint32_t h = editor.random_half_edge();
      if (!editor.mesh.can_flip(h)) continue;
      ++flips;
      const Snapshot before(editor.mesh);
      const auto triangles = editor.model.canonical();
      editor.mesh.flip(h);
      check_valid(editor.mesh);
      CHECK(Snapshot(editor.mesh).faces != before.faces);
      editor.mesh.unflip(h);
      check_valid(editor.mesh);
      REQUIRE(Snapshot(editor.mesh).faces == before.faces);
      editor.mesh.flip(h);
      editor.mesh.flip(h);
      check_valid(editor.mesh);
      REQUIRE(model_of(editor.mesh).canonical() == triangles);
      editor.mesh.flip(h);
      editor.mesh.flip(h);
      REQUIRE(Snapshot(editor.mesh).faces == before.faces);
    }
    CHECK(flips > 50);
  }
}

TEST_CASE("no edge flips on the boundary, nor where the other edge exists", "[mesh][edit]") {
  const Mesh tetrahedron = mesh_of(test::tetrahedron());
  for_each_half_edge(tetrahedron, [&](std::uint32_t h) { CHECK(!tetrahedron.can_flip(h)); });
  const Mesh grid = mesh_of(test::grid(4, 3));
  std::size_t boundary = 0, inner = 0;
  for_each_half_edge(grid, [&](std::uint32_t h) {
    if (grid.is_ghost(h) || grid.is_ghost(grid.twin(h))) {
      CHECK(!grid.can_flip(h));
      ++boundary;
    } else {
      CHECK(grid.can_flip(h));
      ++inner;
    }
  });
  CHECK(boundary == 14 * 4);  // with the ghosts' edges to the apex
  CHECK(inner == 2 * 29);
}

TEST_CASE("splits grow a mesh far beyond its size", "[mesh][edit]") {
#ifdef VKMESH_ADDRESS_SANITIZER
  const int splits = 120;  // each is followed by a look at the whole mesh
#else
  const int splits = 1200;
#endif
  for (const IndexedFaceSet& shape : {test::tetrahedron(), test::grid(1, 1)}) {
    Editor editor(shape, 1);
    const Model::Counts counts = editor.model.counts();
    for (int i = 0; i < splits; ++i) editor.split();
    CHECK(editor.mesh.face_count() > static_cast<std::size_t>(splits) * 5 / 6);
    check_same(editor.mesh, editor.model, counts);
  }
}

TEST_CASE("a component is erased face by face with its ghosts", "[mesh][edit]") {
  const IndexedFaceSet grid = test::grid(3, 2), sphere = test::icosphere(1);
  Mesh mesh = mesh_of(test::both(grid, sphere, {5.0f, 0.0f, 0.0f}));
  for (std::uint32_t v = 0; v < grid.points.size(); ++v) mesh.vertices[v].leading = kInvalid;
  for (std::uint32_t f = 0; f < grid.face_count(); ++f) mesh.erase_with_ghosts(f);
  check_valid(mesh);
  std::size_t left = 0;
  for_each_half_edge(mesh, [&](std::uint32_t h) { left += mesh.is_ghost(h) ? 1000 : 1; });
  CHECK(left == sphere.corners.size());
}

TEST_CASE("a mesh comes back from being edited as if it had been built from its faces", "[mesh][edit]") {
  std::vector<IndexedFaceSet> shapes = test::noisy_shapes();
  shapes.push_back(test::both(test::grid(4, 3), test::cylinder(3, 5), {9.0f, 0.0f, 0.0f}));
  for (IndexedFaceSet& shape : shapes) {
    shape.points.emplace_back(7.0f);  // in no face
    const HalfEdgeMesh original = test::half_edges(shape);
    Mesh mesh;
    REQUIRE(mesh.build(original));
    check_valid(mesh);
    const auto same = [](const HalfEdgeMesh& a, const HalfEdgeMesh& b) {
      return std::ranges::equal(a.origins(), b.origins()) && std::ranges::equal(a.twins(), b.twins()) &&
             std::ranges::equal(a.leadings(), b.leadings());
    };
    CHECK(same(detail::gather(mesh).mesh, original));

    std::minstd_rand random(3);
    for (int i = 0; i < 200; ++i) {
      const auto h = static_cast<std::uint32_t>(random() % mesh.half_edge_bound());
      if (h % 4 != 3 && mesh.can_flip(h)) mesh.flip(h);
    }
    for (int i = 0; i < 20; ++i) {
      const auto f = static_cast<std::uint32_t>(random() % mesh.face_count());
      mesh.split(4 * f + 1);
    }
    check_valid(mesh);
    const detail::Gathered gathered = detail::gather(mesh);
    REQUIRE(validate(gathered.mesh).has_value());
    CHECK(gathered.mesh.vertex_count() == original.vertex_count() + 20);
    IndexedFaceSet faces;
    faces.points.resize(gathered.mesh.vertex_count());
    faces.corners.assign(gathered.mesh.origins().begin(), gathered.mesh.origins().end());
    CHECK(same(gathered.mesh, test::half_edges(faces)));
    for (std::uint32_t f = 0; f < gathered.faces.size(); ++f)
      for (std::uint32_t i = 0; i < 3; ++i)
        CHECK(gathered.vertices[faces.corners[3 * f + i]] == mesh.origin(4 * gathered.faces[f] + i));
  }
}

TEST_CASE("validation names what is broken", "[mesh][edit]") {
  const auto error_after = [](auto&& breaks) -> std::string {
    Mesh mesh = mesh_of(test::grid(3, 3));
    check_valid(mesh);
    breaks(mesh);
    const auto valid = mesh.validate();
    return valid ? "nothing" : valid.error().describe();
  };
  const auto names = [](const char* rule) { return Catch::Contains(rule); };
  const auto inner = [](const Mesh& mesh) {
    std::uint32_t h = 0;
    while (mesh.is_ghost(mesh.twin(h))) ++h;
    return h;
  };
  CHECK_THAT(error_after([](Mesh& m) { m.face(0).origin[1] = 4000; }), names("an origin is a vertex"));
  CHECK_THAT(error_after([](Mesh& m) { m.face(0).origin[1] = m.face(0).origin[0]; }),
             names("a face repeats no vertex"));
  CHECK_THAT(error_after([](Mesh& m) { m.face(0).origin[1] = m.apex(); }), names("the apex is the last"));
  CHECK_THAT(error_after([](Mesh& m) { m.face(0).twin[0] = 3; }), names("a twin is a half-edge"));
  CHECK_THAT(error_after([&](Mesh& m) {
               const std::uint32_t h = inner(m);
               m.face(h).twin[h & 3u] = Mesh::next(m.twin(h));
             }),
             names("twins are mutual"));
  CHECK_THAT(error_after([](Mesh& m) { std::swap(m.face(0).origin[0], m.face(0).origin[1]); }),
             names("twins run in opposite directions"));
  CHECK_THAT(error_after([](Mesh& m) { m.vertices[5].leading = m.vertices[6].leading; }),
             names("a leading half-edge leaves its vertex"));
  CHECK_THAT(error_after([](Mesh& m) { m.vertices[5].leading = kInvalid; }),
             names("that is gone has no faces"));
  CHECK_THAT(error_after([](Mesh& m) {
               m.vertices[0].leading = kInvalid;
               m.face(0).origin[0] = kInvalid;
               m.face(0).tags = 1;
             }),
             names("a face that is gone has no tags"));
  // Two fans at one vertex: one vertex takes the place of another that is far away.
  CHECK_THAT(error_after([](Mesh& m) {
               for_each_half_edge(m, [&](std::uint32_t h) {
                 if (m.origin(h) == 15) m.face(h).origin[h & 3u] = 0;
               });
               m.vertices[15].leading = kInvalid;
             }),
             names("a vertex has one fan"));
  CHECK_THAT(error_after([](Mesh& m) {
               for_each_half_edge(m, [&](std::uint32_t h) {
                 if (m.origin(h) == 3) m.face(h).origin[h & 3u] = 0;
               });
               m.vertices[3].leading = kInvalid;
             }),
             names("fan"));
}

}  // namespace vkmesh
