// Creases of shapes whose edges are known, and of real ones against a slow search.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/creases.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/passes/dihedral_angles.h>

#include "support/data.h"
#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::dot;
using test::length;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // The smaller vertex first.

Edge edge_of(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

// Every edge in one chain only; fails the test otherwise.
std::set<Edge> edges_of(const std::vector<Crease>& creases) {
  std::set<Edge> edges;
  for (const Crease& crease : creases)
    for (std::size_t i = 0; i < crease.half_edges.size(); ++i) {
      const bool added =
          edges.insert(edge_of(crease.vertices[i], crease.vertices[(i + 1) % crease.vertices.size()])).second;
      CHECK(added);
    }
  return edges;
}

// What holds for creases of any mesh.
void check_chains(const HalfEdgeMesh& mesh, const std::vector<Vec3>& points,
                  const std::vector<Crease>& creases) {
  std::map<std::uint32_t, int> degree;
  for (const auto& [a, b] : edges_of(creases)) {
    ++degree[a];
    ++degree[b];
  }
  std::pair<bool, std::uint32_t> before{false, 0};
  for (const Crease& crease : creases) {
    const std::size_t n = crease.half_edges.size();
    REQUIRE(n > 0);
    REQUIRE(crease.vertices.size() == (crease.closed ? n : n + 1));
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const HalfEdgeId h(crease.half_edges[i]);
      CHECK(mesh.edge(h) == h);
      const std::uint32_t from = crease.vertices[i], to = crease.vertices[(i + 1) % crease.vertices.size()];
      CHECK(edge_of(mesh.origin(h).index, mesh.target(h).index) == edge_of(from, to));
      sum += length(DVec3(points[from]) - DVec3(points[to]));
      if (i > 0) CHECK(degree.at(from) == 2);
    }
    CHECK(crease.length == Approx(sum).epsilon(1e-12));
    const bool loop = crease.closed && degree.at(crease.vertices[0]) == 2;
    if (loop)
      CHECK(crease.vertices[0] == *std::min_element(crease.vertices.begin(), crease.vertices.end()));
    else
      CHECK((degree.at(crease.vertices.front()) != 2 &&
             (crease.closed || degree.at(crease.vertices.back()) != 2)));
    const std::pair<bool, std::uint32_t> now{loop, crease.vertices[0]};
    CHECK(before <= now);
    before = now;
  }
}

std::vector<Crease> creases_of(const IndexedFaceSet& set, const CreaseOptions& options = {}) {
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto found =
      find_creases(mesh, set.points, dihedral_angles(mesh, set.points).value().half_edge, options);
  REQUIRE(found);
  check_chains(mesh, set.points, *found);
  return *found;
}

IndexedFaceSet turned_inside_out(IndexedFaceSet set) {
  for (std::size_t f = 0; f < set.face_count(); ++f) std::swap(set.corners[3 * f], set.corners[3 * f + 1]);
  return set;
}

IndexedFaceSet capped_cylinder(std::uint32_t rings, std::uint32_t sides) {
  IndexedFaceSet set = test::cylinder(rings, sides);
  const auto bottom = static_cast<std::uint32_t>(set.points.size()), top = bottom + 1, last = rings * sides;
  set.points.emplace_back(0.0f, 0.0f, 0.0f);
  set.points.emplace_back(0.0f, 0.0f, static_cast<float>(rings));
  for (std::uint32_t j = 0; j < sides; ++j) {
    const std::uint32_t next = (j + 1) % sides;
    set.corners.insert(set.corners.end(), {bottom, next, j, top, last + j, last + next});
  }
  return set;
}

// The grid of 8 × 8 squares, bent by a right angle at the given edges and flat elsewhere, as far as the
// angles tell.
class MarkedGrid {
 public:
  static std::uint32_t at(std::uint32_t x, std::uint32_t y) { return 9 * y + x; }

  /// Edges between each of the vertices and the next.
  void mark(const std::vector<std::uint32_t>& path) {
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      HalfEdgeId h = mesh_.find_half_edge(VertexId(path[i]), VertexId(path[i + 1]));
      if (!h.valid()) h = mesh_.find_half_edge(VertexId(path[i + 1]), VertexId(path[i]));
      REQUIRE(h.valid());
      REQUIRE(mesh_.twin(h).valid());
      angles_[h.index] = angles_[mesh_.twin(h).index] = 1.5f;
    }
  }

  [[nodiscard]] std::vector<Crease> creases(double min_length) const {
    const auto found = find_creases(mesh_, set_.points, angles_, {.min_length = min_length});
    REQUIRE(found);
    check_chains(mesh_, set_.points, *found);
    return *found;
  }

 private:
  IndexedFaceSet set_ = test::grid(8, 8);
  HalfEdgeMesh mesh_ = test::half_edges(set_);
  std::vector<float> angles_ = std::vector<float>(mesh_.half_edge_count(), 0.0f);
};

std::vector<std::uint32_t> row(std::uint32_t y, std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint32_t> path;
  for (std::uint32_t x = from; x <= to; ++x) path.push_back(MarkedGrid::at(x, y));
  return path;
}

}  // namespace

TEST_CASE("creases of a cube are its twelve edges, ridges from outside and valleys from inside") {
  for (const bool inside : {false, true}) {
    const IndexedFaceSet set = inside ? turned_inside_out(test::cube()) : test::cube();
    const auto all = creases_of(set);
    CHECK(all.size() == 12);
    for (const Crease& crease : all) {
      CHECK((crease.half_edges.size() == 1 && !crease.closed && crease.length == 1.0));
      const Vec3 along = set.points[crease.vertices[0]] - set.points[crease.vertices[1]];
      CHECK(std::fabs(along.x) + std::fabs(along.y) + std::fabs(along.z) == 1.0f);
    }
    CHECK(creases_of(set, {.kind = CreaseKind::kConvex}).size() == (inside ? 0 : 12));
    CHECK(creases_of(set, {.kind = CreaseKind::kConcave}).size() == (inside ? 12 : 0));
  }
}

TEST_CASE("creases of a cube of many triangles are twelve chains of length 1") {
  const auto creases = creases_of(test::fine_cube(5));
  CHECK(creases.size() == 12);
  for (const Crease& crease : creases) {
    CHECK((crease.half_edges.size() == 5 && !crease.closed));
    // Along an axis differences of floats are exact in double precision, and their sum is that of the ends.
    CHECK(crease.length == Approx(1.0).epsilon(1e-14));
  }
}

TEST_CASE("creases of a closed cylinder are its two rims") {
  const std::uint32_t sides = 24;  // Bent by 15 degrees each.
  const IndexedFaceSet set = capped_cylinder(4, sides);
  const auto creases = creases_of(set);
  REQUIRE(creases.size() == 2);
  for (const Crease& crease : creases) {
    CHECK(crease.closed);
    CHECK(crease.half_edges.size() == sides);
    // Each of the edges of length 0.26 has ends rounded to 2^-24, and angles to as much.
    CHECK(crease.length == Approx(sides * 2 * std::sin(std::numbers::pi / sides)).epsilon(4e-6));
  }
  CHECK((creases[0].vertices[0] == 0 && creases[1].vertices[0] == 4 * sides));
  CHECK(creases_of(set, {.kind = CreaseKind::kConcave}).empty());
  // From 15 degrees on, every edge along the axis carries the rims on.
  CHECK(edges_of(creases_of(set, {.soft_angle = 14 * kDegree})).size() == (2 + 4) * sides);
}

TEST_CASE(
    "creases end where edges bend by less than the soft angle, and start where they bend by the sharp") {
  // A fold along y = 1 that flattens out from 60 degrees to 10, and then bends again, by up to 30 degrees.
  const std::uint32_t n = 40;
  const auto bend = [](double x) {
    return (x < 25 ? 60 - 2 * x : 10 + 20 * std::sin((x - 25) / 15 * std::numbers::pi)) * kDegree;
  };
  for (const float side : {1.0f, -1.0f}) {
    IndexedFaceSet set = test::grid(n, 2);
    for (Vec3& p : set.points)
      if (p.y != 1) p.z = -side * static_cast<float>(std::tan(bend(static_cast<double>(p.x)) / 2));
    const HalfEdgeMesh mesh = test::half_edges(set);
    // The angles of the fold's edges, in double precision.
    std::vector<double> angles;
    for (std::uint32_t i = 0; i < n; ++i) {
      const HalfEdgeId h = mesh.find_half_edge(VertexId(n + 1 + i), VertexId(n + 2 + i));
      const DVec3 a = test::area_of(set, mesh.face(h).index),
                  b = test::area_of(set, mesh.face(mesh.twin(h)).index);
      angles.push_back(std::acos(dot(a, b) / (length(a) * length(b))));
      for (const double threshold : {5.0, 20.0, 40.0, 70.0})
        REQUIRE(std::fabs(angles.back() / kDegree - threshold) > 0.001);
    }
    const auto edges_from = [&](double least) {  // Counts those that the sharp ones are joined to.
      return static_cast<std::size_t>(
          std::find_if(angles.begin(), angles.end(), [&](double a) { return a < least * kDegree; }) -
          angles.begin());
    };
    const CreaseKind kind = side > 0 ? CreaseKind::kConvex : CreaseKind::kConcave;
    const CreaseKind other = side > 0 ? CreaseKind::kConcave : CreaseKind::kConvex;
    const auto creases = creases_of(set, {.kind = kind});
    REQUIRE(creases.size() == 1);
    CHECK(creases[0].half_edges.size() == edges_from(20));
    CHECK((edges_from(20) > edges_from(40) + 5 && edges_from(20) < 25));
    CHECK(creases[0].vertices.front() == n + 1);
    CHECK(creases_of(set).size() == 1);
    CHECK(creases_of(set, {.kind = other}).empty());
    // The second fold is soft everywhere, and not joined to the first.
    CHECK(*std::max_element(angles.begin() + 25, angles.end()) > 29 * kDegree);
    const auto sharp = creases_of(set, {.soft_angle = 40 * kDegree});
    REQUIRE(sharp.size() == 1);
    CHECK(sharp[0].half_edges.size() == edges_from(40));
    const auto two = creases_of(set, {.sharp_angle = 28 * kDegree});
    REQUIRE(two.size() == 2);
    CHECK(two[0].half_edges.size() == edges_from(20));
    const auto whole = creases_of(set, {.soft_angle = 5 * kDegree, .kind = kind});
    REQUIRE(!whole.empty());
    CHECK(whole[0].half_edges.size() >= n);
    CHECK(creases_of(set, {.sharp_angle = 70 * kDegree}).empty());
  }
}

TEST_CASE("creases: short ends go, and the chain they hung on is one again") {
  const auto at = MarkedGrid::at;
  MarkedGrid grid;
  grid.mark(row(4, 0, 8));
  grid.mark({at(3, 4), at(3, 5)});
  CHECK(grid.creases(0).size() == 3);
  CHECK(grid.creases(1).size() == 3);  // It is not shorter.
  const auto one = grid.creases(1.5);
  REQUIRE(one.size() == 1);
  CHECK(one[0].vertices == row(4, 0, 8));
  CHECK(one[0].length == 8.0);
}

TEST_CASE("creases: short chains between junctions stay, loose pieces go") {
  const auto at = MarkedGrid::at;
  MarkedGrid grid;
  grid.mark(row(2, 0, 8));
  grid.mark(row(3, 0, 8));
  grid.mark({at(4, 2), at(4, 3)});
  CHECK(grid.creases(1.5).size() == 5);
  // A piece of two edges, and a loop of three, each on its own.
  grid.mark(row(5, 2, 4));
  grid.mark({at(2, 6), at(3, 7), at(2, 7), at(2, 6)});
  CHECK(grid.creases(2).size() == 7);
  CHECK(grid.creases(2.5).size() == 6);
  CHECK(grid.creases(3.5).size() == 5);
  CHECK(grid.creases(3.5).back().closed == false);
  // A loop on a chain has no loose end.
  grid.mark({at(4, 3), at(5, 4), at(4, 4), at(4, 3)});
  const auto hung = grid.creases(3.5);
  CHECK(hung.size() == 6);
  CHECK(std::count_if(hung.begin(), hung.end(), [](const Crease& c) { return c.closed; }) == 1);
}

TEST_CASE("creases: of short ends at one vertex the shortest goes first") {
  const auto at = MarkedGrid::at;
  MarkedGrid grid;
  grid.mark(row(4, 0, 4));
  grid.mark({at(4, 4), at(4, 5)});
  grid.mark({at(4, 4), at(5, 5)});
  const auto fork = grid.creases(1.5);
  REQUIRE(fork.size() == 1);
  CHECK(fork[0].length == Approx(4 + std::sqrt(2.0)).epsilon(1e-14));
  CHECK(fork[0].vertices.back() == at(5, 5));
  // Three short ends and nothing else: what is left once the shortest has gone may be long enough.
  MarkedGrid star;
  star.mark({at(3, 3), at(4, 3)});
  star.mark({at(3, 3), at(4, 4)});
  star.mark({at(2, 2), at(3, 3)});
  CHECK(star.creases(0).size() == 3);
  const auto rest = star.creases(2.5);
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].vertices == std::vector<std::uint32_t>{at(2, 2), at(3, 3), at(4, 4)});
  CHECK(star.creases(3).empty());
}

TEST_CASE("creases: boundary edges count as sharp where asked for") {
  const IndexedFaceSet set = test::grid(3, 3);
  CHECK(creases_of(set).empty());
  for (const CreaseKind kind : {CreaseKind::kBoth, CreaseKind::kConvex, CreaseKind::kConcave}) {
    const auto creases = creases_of(set, {.kind = kind, .boundary = true});
    REQUIRE(creases.size() == 1);
    CHECK((creases[0].closed && creases[0].half_edges.size() == 12 && creases[0].length == 12.0));
  }
  CHECK(creases_of(test::cylinder(3, 24), {.boundary = true}).size() == 2);
  CHECK(creases_of(test::cylinder(3, 24)).empty());
}

TEST_CASE("creases: errors, and meshes without edges") {
  const IndexedFaceSet set = test::cube();
  const HalfEdgeMesh mesh = test::half_edges(set);
  const std::vector<float> angles(mesh.half_edge_count(), 0.0f);
  const auto code = [&](const CreaseOptions& options) {
    return find_creases(mesh, set.points, angles, options).error().code;
  };
  CHECK(code({.sharp_angle = 0.2, .soft_angle = 0.3}) == ErrorCode::kUsage);
  CHECK(code({.soft_angle = -0.1}) == ErrorCode::kUsage);
  CHECK(code({.sharp_angle = 3.2}) == ErrorCode::kUsage);
  CHECK(code({.sharp_angle = NAN}) == ErrorCode::kUsage);
  CHECK(code({.soft_angle = NAN}) == ErrorCode::kUsage);
  CHECK(code({.min_length = -1.0}) == ErrorCode::kUsage);
  CHECK(code({.min_length = NAN}) == ErrorCode::kUsage);
  CHECK(find_creases(mesh, set.points, angles, {.sharp_angle = std::numbers::pi, .soft_angle = 0}));
  CHECK(find_creases(mesh, std::span(set.points).first(7), angles).error().code == ErrorCode::kUsage);
  CHECK(find_creases(mesh, set.points, std::span(angles).first(35)).error().code == ErrorCode::kUsage);
  CHECK(find_creases(HalfEdgeMesh{}, {}, {}).value().empty());
  IndexedFaceSet lonely;
  lonely.points.emplace_back(1.0f, 2.0f, 3.0f);
  CHECK(creases_of(lonely, {.boundary = true}).empty());
}

namespace {

// The edges that a search finds that goes over all of them until it finds no more.
std::set<Edge> slow_creases(const HalfEdgeMesh& mesh, std::span<const float> angles,
                            const CreaseOptions& options) {
  std::set<Edge> kept, soft;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    const Edge edge = edge_of(mesh.origin(HalfEdgeId(h)).index, mesh.target(HalfEdgeId(h)).index);
    double bend = std::fabs(static_cast<double>(angles[h]));
    if (options.kind == CreaseKind::kConvex && angles[h] < 0) bend = -1;
    if (options.kind == CreaseKind::kConcave && angles[h] > 0) bend = -1;
    if (mesh.is_boundary(HalfEdgeId(h))) bend = options.boundary ? 4 : -1;
    if (bend >= options.sharp_angle) kept.insert(edge);
    if (bend >= options.soft_angle) soft.insert(edge);
  }
  for (std::size_t before = 0; before != kept.size();) {
    before = kept.size();
    std::set<std::uint32_t> reached;
    for (const auto& [a, b] : kept) reached.insert({a, b});
    for (const Edge& edge : soft)
      if (reached.contains(edge.first) || reached.contains(edge.second)) kept.insert(edge);
  }
  return kept;
}

}  // namespace

TEST_CASE("creases of a machine part are those that a slow search finds, each in one chain") {
  std::filesystem::path path;
  for (const auto& mesh : test::cgal_meshes())
    if (mesh.filename() == "fandisk.off") path = mesh;
  REQUIRE(!path.empty());
  IndexedFaceSet set = to_indexed_face_set(read_mesh(path).value()).value();
  for (const bool noisy : {false, true}) {
    if (noisy) test::jitter(set, 0.0005f, 6);
    const HalfEdgeMesh mesh = test::half_edges(set);
    const std::vector<float> angles = dihedral_angles(mesh, set.points).value().half_edge;
    for (const CreaseOptions& options :
         {CreaseOptions{}, CreaseOptions{.sharp_angle = 0.8, .soft_angle = 0.1},
          CreaseOptions{.kind = CreaseKind::kConvex}, CreaseOptions{.kind = CreaseKind::kConcave},
          CreaseOptions{.sharp_angle = 1.2, .soft_angle = 0.15, .boundary = true}}) {
      const auto creases = creases_of(set, options);
      const std::set<Edge> expected = slow_creases(mesh, angles, options);
      CHECK(expected.size() > 10);
      CHECK(edges_of(creases) == expected);
    }
    // No end that is left is short, and no edge is new.
    const auto pruned = creases_of(set, {.soft_angle = 0.2, .min_length = 0.1});
    const std::set<Edge> all = slow_creases(mesh, angles, {.soft_angle = 0.2});
    const std::set<Edge> left = edges_of(pruned);
    CHECK(std::includes(all.begin(), all.end(), left.begin(), left.end()));
    std::map<std::uint32_t, int> degree;
    for (const auto& [a, b] : left) {
      ++degree[a];
      ++degree[b];
    }
    for (const Crease& crease : pruned)
      if (degree[crease.vertices.front()] == 1 || degree[crease.vertices.back()] == 1)
        CHECK(crease.length >= 0.1);
  }
}
