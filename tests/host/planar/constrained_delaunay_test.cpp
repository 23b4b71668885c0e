#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/planar/constrained_delaunay.h>
#include <vkmesh/planar/delaunay.h>

#include "fuzz/near_segment.h"
#include "host/planar/constrained_input.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

ConstrainedTriangulation constrained(const ConstrainedInput& input,
                                     const ConstrainedDelaunayOptions& options = {}) {
  auto made = constrained_delaunay(input.points, input.constraints, options);
  if (!made) FAIL(made.error().describe());
  REQUIRE(validate(made->mesh));
  REQUIRE(made->positions.size() == made->mesh.vertex_count());
  return std::move(*made);
}

std::string refused(const ConstrainedInput& input, const ConstrainedDelaunayOptions& options = {},
                    ErrorCode code = ErrorCode::kUnsuitable) {
  const auto made = constrained_delaunay(input.points, input.constraints, options);
  REQUIRE(!made);
  CHECK(made.error().code == code);
  return made.error().message;
}

using Edges = std::set<std::array<std::uint32_t, 2>>;

/// Edges of constraints, by their vertices, the lesser first.
Edges constrained_edges(const ConstrainedTriangulation& of) {
  Edges edges;
  for (const HalfEdgeId h : of.constrained_edges) {
    const std::uint32_t a = of.mesh.origin(h).index, b = of.mesh.target(h).index;
    edges.insert({std::min(a, b), std::max(a, b)});
  }
  return edges;
}

/// Every edge is of a constraint or locally Delaunay, triangles turn left, and faces are in their order.
void check_triangles(const ConstrainedTriangulation& of) {
  const auto& p = of.positions;
  const HalfEdgeMesh& mesh = of.mesh;
  const Edges kept = constrained_edges(of);
  CHECK(kept.size() == of.constrained_edges.size());
  CHECK(std::is_sorted(of.constrained_edges.begin(), of.constrained_edges.end()));
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    const HalfEdgeId e(h);
    const auto at = [&](VertexId v) { return p[v.index]; };
    const DVec2 a = at(mesh.origin(e)), b = at(mesh.target(e)), c = at(mesh.origin(mesh.previous(e)));
    if (orientation(a, b, c) <= 0) FAIL("face " << h / 3 << " does not turn left");
    const std::uint32_t u = mesh.origin(e).index, v = mesh.target(e).index;
    if (mesh.is_boundary(e) || kept.contains({std::min(u, v), std::max(u, v)})) continue;
    if (in_circle_perturbed(a, b, c, at(mesh.origin(mesh.previous(mesh.twin(e))))) >= 0)
      FAIL("edge " << h << " is not Delaunay");
  }
}

bool is_less(DVec2 p, DVec2 q) {
  return p.x != q.x ? p.x < q.x : p.y < q.y;
}

/// Edges that follow each other exactly on the segment from a to b, and are those of a constraint.
bool is_covered(const ConstrainedTriangulation& of, const Edges& kept, std::uint32_t a, std::uint32_t b) {
  const auto& p = of.positions;
  while (a != b) {
    std::uint32_t next = kInvalid;
    of.mesh.for_each_neighbour(VertexId(a), [&](VertexId v) {
      const DVec2 q = p[v.index];
      const bool ahead = is_less(p[a], q) == is_less(p[a], p[b]);
      if (orientation(p[a], p[b], q) == 0 && ahead) next = v.index;
    });
    if (next == kInvalid || !kept.contains({std::min(a, next), std::max(a, next)})) return false;
    a = next;
  }
  return true;
}

/// Edges of constraints from a to b, along the segment.
bool has_chain(const ConstrainedTriangulation& of, const Edges& kept, std::uint32_t a, std::uint32_t b) {
  const auto& p = of.positions;
  std::set<std::uint32_t> reached = {a};
  std::vector<std::uint32_t> waiting = {a};
  while (!waiting.empty()) {
    const std::uint32_t v = waiting.back();
    waiting.pop_back();
    if (v == b) return true;
    for (const auto& [q, r] : kept) {
      if (q != v && r != v) continue;
      const std::uint32_t w = q == v ? r : q;
      if (fuzz::is_near_segment(p[w], p[a], p[b]) && reached.insert(w).second) waiting.push_back(w);
    }
  }
  return false;
}

double area_of(const ConstrainedTriangulation& of) {
  double area = 0;
  for (std::size_t f = 0; f < of.mesh.face_count(); ++f) {
    const auto at = [&](std::size_t i) { return of.positions[of.mesh.origins()[3 * f + i]]; };
    const DVec2 u = at(1) - at(0), v = at(2) - at(0);
    area += (u.x * v.y - u.y * v.x) / 2;
  }
  return area;
}

bool same(const ConstrainedTriangulation& a, const ConstrainedTriangulation& b) {
  return a.positions == b.positions && a.constrained_edges == b.constrained_edges &&
         std::ranges::equal(a.mesh.origins(), b.mesh.origins()) &&
         std::ranges::equal(a.mesh.twins(), b.mesh.twins());
}

/// The same points and constraints in another order, constraints turned at random, some given twice.
ConstrainedInput shuffled(const ConstrainedInput& input, PlanarRandom& random) {
  std::vector<std::uint32_t> order(input.points.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  random.shuffle(order);
  ConstrainedInput other;
  std::vector<std::uint32_t> now(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    other.points.push_back(input.points[order[i]]);
    now[order[i]] = i;
  }
  for (const auto& [a, b] : input.constraints) {
    other.constraints.push_back({now[a], now[b]});
    if (random.below(2) == 0) std::swap(other.constraints.back()[0], other.constraints.back()[1]);
    if (random.below(8) == 0) other.constraints.push_back({now[a], now[b]});
  }
  random.shuffle(other.constraints);
  return other;
}

/// A closed loop of `sides` points about (x, y), and its edges.
void add_loop(std::vector<DVec2>& points, std::vector<PointPair>& edges, const std::vector<DVec2>& loop) {
  const auto first = static_cast<std::uint32_t>(points.size()), n = static_cast<std::uint32_t>(loop.size());
  for (std::uint32_t i = 0; i < n; ++i) edges.push_back({first + i, first + (i + 1) % n});
  points.insert(points.end(), loop.begin(), loop.end());
}
std::vector<DVec2> square(double x, double y, double size, bool clockwise = false) {
  std::vector<DVec2> loop = {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
  if (clockwise) std::reverse(loop.begin(), loop.end());
  return loop;
}

}  // namespace

TEST_CASE("Constraints are edges, and all other edges are Delaunay", "[constrained]") {
  for (const std::size_t n : {8u, 40u, 400u})
    for (const auto& [name, points] : planar_points(n)) {
      INFO(name << ", " << n);
      PlanarRandom random(n);
      ConstrainedInput input{points, {}};
      add_constraints(input, n / 3, random);
      const ConstrainedTriangulation made = constrained(input);
      check_triangles(made);
      const Edges kept = constrained_edges(made);
      const auto plain = delaunay(points);
      REQUIRE(plain);
      CHECK(made.vertex_of_point == plain->vertex_of_point);
      CHECK(made.point_of_vertex == plain->point_of_vertex);
      CHECK(made.mesh.edge_count() == plain->mesh.edge_count());
      CHECK(made.added.empty());
      std::set<std::uint32_t> ends;
      for (const auto& [a, b] : input.constraints)
        if (!is_covered(made, kept, made.vertex_of_point[a], made.vertex_of_point[b])) FAIL(a << " to " << b);
    }
}

TEST_CASE("A constrained triangulation is a function of places and constraints", "[constrained]") {
  PlanarRandom random(3);
  for (const auto& [name, points] : planar_points(200)) {
    INFO(name);
    ConstrainedInput input{points, {}};
    add_constraints(input, 60, random);
    const ConstrainedTriangulation made = constrained(input);
    CHECK(same(made, constrained(shuffled(input, random))));
    // Crossings are split the same way, too.
    for (int i = 0; i < 30; ++i) input.constraints.push_back({random.index(200), random.index(200)});
    ConstrainedDelaunayOptions options;
    options.split_crossings = true;
    const ConstrainedTriangulation split = constrained(input, options);
    CHECK(same(split, constrained(shuffled(input, random), options)));
  }
}

TEST_CASE("Without constraints, or with edges that are there, it is the Delaunay triangulation",
          "[constrained]") {
  for (const auto& [name, points] : planar_points(300)) {
    INFO(name);
    const auto plain = delaunay(points);
    REQUIRE(plain);
    ConstrainedInput input{points, {}};
    for (int with_edges = 0; with_edges < 2; ++with_edges) {
      const ConstrainedTriangulation made = constrained(input);
      CHECK(std::ranges::equal(made.mesh.origins(), plain->mesh.origins()));
      CHECK(std::ranges::equal(made.mesh.twins(), plain->mesh.twins()));
      CHECK(std::ranges::equal(made.mesh.leadings(), plain->mesh.leadings()));
      CHECK(made.constrained_edges.size() == input.constraints.size());
      plain->mesh.for_each_edge([&](HalfEdgeId h) {
        if (h.index % 3 == 0)
          input.constraints.push_back({plain->point_of_vertex[plain->mesh.origin(h).index],
                                       plain->point_of_vertex[plain->mesh.target(h).index]});
      });
    }
  }
}

TEST_CASE("Constraints overlap, touch, and run along hulls and through points", "[constrained]") {
  ConstrainedInput input;
  for (std::uint32_t i = 0; i < 25; ++i) input.points.emplace_back(i % 5, i / 5);
  // A row twice, a diagonal, a knight's line through one point, the hull, ends on other constraints.
  input.constraints = {{10, 14}, {14, 11}, {0, 24}, {2, 22}, {0, 4}, {20, 0}, {6, 8}, {5, 19}, {3, 3}};
  input.points.push_back(input.points[7]);
  input.constraints.push_back({25, 7});  // two points of one place
  const ConstrainedTriangulation made = constrained(input);
  check_triangles(made);
  const Edges kept = constrained_edges(made);
  for (const auto& [a, b] : input.constraints)
    CHECK(is_covered(made, kept, made.vertex_of_point[a], made.vertex_of_point[b]));
  CHECK(kept.size() == 5 * 4 + 2 + 2);
  // Points in one line have no edges, and no crossings.
  const ConstrainedTriangulation line = constrained({{{0, 0}, {1, 1}, {2, 2}}, {{0, 2}, {1, 2}}});
  CHECK(line.mesh.face_count() == 0);
  CHECK(line.positions.size() == 3);
  CHECK(line.constrained_edges.empty());
}

TEST_CASE("Constraints that cross are named, and so are those of points that are not there",
          "[constrained]") {
  const std::vector<DVec2> points = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, -1}, {1, 3}};
  CHECK(refused({points, {{0, 1}, {4, 5}, {3, 0}}}) == "constraint 0 crosses constraint 1");
  CHECK(refused({points, {{3, 0}, {1, 3}, {0, 1}, {0, 2}}}) == "constraint 1 crosses constraint 3");
  CHECK(refused({points, {{0, 1}, {0, 6}}}) == "constraint 1 ends at point 6, and there are 6");
  CHECK(refused({{}, {{0, 0}}}) == "constraint 0 ends at point 0, and there are 0");
  ConstrainedDelaunayOptions options;
  const std::vector<PointPair> outlines = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  options.outlines = outlines;
  options.domain = DelaunayDomain::kNonZero;
  CHECK(refused({points, {{4, 5}}}, options) == "constraint 0 crosses outline edge 0");
  const std::vector<PointPair> open = {{0, 1}, {1, 2}, {2, 3}, {0, 3}};
  options.outlines = open;
  CHECK(refused({points, {}}, options) == "the outlines do not close at point 0");
  options.domain = DelaunayDomain::kEvenOdd;
  CHECK(constrained({points, {}}, options).mesh.face_count() == 2);
  options.outlines = std::span(open).first(3);
  CHECK(refused({points, {}}, options) == "the outlines do not close at point 0");
  CHECK(constrained_delaunay(points, {}, {}, [](double) { return false; }).error().code ==
        ErrorCode::kInterrupted);
}

TEST_CASE("Crossings are split on request: chains from end to end that no longer cross", "[constrained]") {
  std::map<std::string, ConstrainedInput> inputs;
  for (const std::size_t n : {12u, 60u})
    for (const auto& [name, points] : planar_points(n)) {
      PlanarRandom random(n);
      ConstrainedInput& input = inputs[name + std::to_string(n)];
      input.points = points;
      for (std::size_t i = 0; i < n / 2; ++i) input.constraints.push_back({random.index(n), random.index(n)});
    }
  // A pencil of lines that meet nearly in one point, needles, and lines that leave the hull by rounding.
  PlanarRandom random(1);
  ConstrainedInput &pencil = inputs["pencil"], &needles = inputs["needles"], &lattice = inputs["lattice"];
  for (std::uint32_t i = 0; i < 40; ++i) {
    const double a = 3.14159 * i / 40;
    pencil.points.insert(pencil.points.end(),
                         {{1e6 + std::cos(a), std::sin(a)}, {1e6 - std::cos(a), -std::sin(a)}});
    needles.points.insert(needles.points.end(), {{0, i * 1e-16}, {1, (40 - i) * 1e-16}});
    lattice.points.insert(lattice.points.end(), {DVec2(random.whole(4), random.whole(4)) * 0x1p-1074,
                                                 DVec2(random.whole(40), random.whole(40)) * 0x1p-1074});
    for (auto* input : {&pencil, &needles, &lattice}) input->constraints.push_back({2 * i, 2 * i + 1});
  }
  ConstrainedDelaunayOptions options;
  options.split_crossings = true;
  for (const auto& [name, input] : inputs) {
    INFO(name);
    const ConstrainedTriangulation made = constrained(input, options);
    check_triangles(made);
    const Edges kept = constrained_edges(made);
    for (const auto& [a, b] : input.constraints)
      if (made.mesh.face_count() > 0 &&
          !has_chain(made, kept, made.vertex_of_point[a], made.vertex_of_point[b]))
        FAIL(a << " to " << b);
    const auto is_crossing = [&](const PointPair& e, const PointPair& f) {
      const auto& p = made.positions;
      return cross_properly(p[e[0]], p[e[1]], p[f[0]], p[f[1]]);
    };
    for (auto e = kept.begin(); e != kept.end(); ++e)
      for (auto f = kept.begin(); f != e; ++f)
        if (is_crossing(*e, *f)) FAIL("edges cross");
    CHECK(made.added.size() <= made.crossings);
    for (std::size_t i = 0; i < made.added.size(); ++i) {
      const std::size_t v = made.positions.size() - made.added.size() + i;
      CHECK(made.point_of_vertex[v] == kInvalid);
      const auto& [from, weights] = made.added[i];
      CHECK(std::fabs(weights[0] + weights[1] + weights[2] - 1) < 1e-6f);
      CHECK(std::max({from[0], from[1], from[2]}) < v);
    }
  }
  const ConstrainedTriangulation star =
      constrained({{{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {{0, 2}, {1, 3}}}, options);
  CHECK(star.crossings == 1);
  CHECK(star.positions.back() == DVec2(1, 1));
  CHECK(star.constrained_edges.size() == 4);
}

TEST_CASE("Polygons with holes: what the outlines wind around is kept", "[constrained]") {
  ConstrainedInput input;
  std::vector<PointPair> outlines;
  add_loop(input.points, outlines, square(0, 0, 10));
  add_loop(input.points, outlines, square(2, 2, 3, true));
  add_loop(input.points, outlines, square(3, 3, 1));         // an island in the hole
  add_loop(input.points, outlines, square(20, 0, 2, true));  // apart, and clockwise
  PlanarRandom random(8);
  for (int i = 0; i < 200; ++i) input.points.emplace_back(random.unit() * 25 - 1, random.unit() * 12 - 1);
  input.constraints = {{0, 4}};  // from the corner to the hole
  ConstrainedDelaunayOptions options;
  options.outlines = outlines;
  for (const DelaunayDomain domain : {DelaunayDomain::kNonZero, DelaunayDomain::kEvenOdd}) {
    options.domain = domain;
    const ConstrainedTriangulation made = constrained(input, options);
    check_triangles(made);
    CHECK(area_of(made) == Approx(100 - 9 + 1 + 4).epsilon(1e-13));
    CHECK(made.mesh.boundary_loops().size() == 4);
    for (std::uint32_t v = 0; v < made.positions.size(); ++v) {
      const DVec2 p = made.positions[v];
      const bool in_hole =
          p.x > 2 && p.x < 5 && p.y > 2 && p.y < 5 && !(p.x >= 3 && p.x <= 4 && p.y >= 3 && p.y <= 4);
      const bool outside =
          p.x < 0 || p.y < 0 || p.y > 10 || (p.x > 10 && p.x < 20) || p.x > 22 || (p.x >= 20 && p.y > 2);
      CHECK(made.mesh.is_isolated(VertexId(v)) == (in_hole || outside));
    }
  }
  // Wound twice: united, or a hole.
  ConstrainedInput twice;
  outlines.clear();
  add_loop(twice.points, outlines, square(0, 0, 4));
  add_loop(twice.points, outlines, square(1, 1, 2));
  options.outlines = outlines;
  options.domain = DelaunayDomain::kNonZero;
  CHECK(area_of(constrained(twice, options)) == 16);
  options.domain = DelaunayDomain::kEvenOdd;
  CHECK(area_of(constrained(twice, options)) == 12);
  // An edge there and back counts for nothing, and stays.
  outlines.insert(outlines.end(), {{0, 4}, {4, 0}});
  options.outlines = outlines;
  const ConstrainedTriangulation slit = constrained(twice, options);
  CHECK(area_of(slit) == 12);
  CHECK(slit.constrained_edges.size() == 9);
}

TEST_CASE("Outlines that cross themselves, and domains that touch themselves", "[constrained]") {
  // An eight: its two parts wind the other way round.
  ConstrainedInput eight{{{0, 0}, {4, 4}, {4, 0}, {0, 4}}, {}};
  const std::vector<PointPair> loop = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  ConstrainedDelaunayOptions options;
  options.outlines = loop;
  options.domain = DelaunayDomain::kNonZero;
  CHECK(refused(eight, options) == "outline edge 0 crosses outline edge 2");
  options.split_crossings = true;
  for (const DelaunayDomain domain : {DelaunayDomain::kNonZero, DelaunayDomain::kEvenOdd}) {
    options.domain = domain;
    const ConstrainedTriangulation made = constrained(eight, options);
    CHECK(area_of(made) == 8);
    CHECK(made.crossings == 1);
    // The crossing is a vertex of two fans, and so two vertices.
    REQUIRE(made.positions.size() == 6);
    CHECK(made.positions[4] == DVec2(2, 2));
    CHECK(made.positions[5] == DVec2(2, 2));
    CHECK(made.added[1].vertices[0] == 4);
    CHECK(made.mesh.boundary_loops().size() == 2);
  }
  // A chessboard, by its 32 squares.
  ConstrainedInput board;
  std::vector<PointPair> squares;
  for (int y = 0; y < 8; ++y)
    for (int x = y % 2; x < 8; x += 2) add_loop(board.points, squares, square(x, y, 1));
  options = {};
  options.outlines = squares;
  options.domain = DelaunayDomain::kNonZero;
  const ConstrainedTriangulation made = constrained(board, options);
  CHECK(area_of(made) == 32);
  CHECK(made.mesh.boundary_loops().size() == 32);
  CHECK(made.mesh.face_count() == 64);
}

TEST_CASE("A constraint between two rows of points", "[constrained]") {
  ConstrainedInput input;
  for (int i = 1; i < 20000; ++i) input.points.insert(input.points.end(), {{i, 1}, {i + 0.5, -1}});
  const auto n = static_cast<std::uint32_t>(input.points.size());
  input.points.insert(input.points.end(), {{0, 0}, {20001, 0}});
  input.constraints = {{n, n + 1}};
  const ConstrainedTriangulation made = constrained(input);
  check_triangles(made);
  CHECK(made.constrained_edges.size() == 1);
}
