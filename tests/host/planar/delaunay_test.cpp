#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/planar/delaunay.h>
#include <vkmesh/repair/consolidate.h>

#include "host/planar/random_points.h"

using namespace vkmesh;

namespace {

using Points = std::vector<DVec2>;
using Triangle = std::array<std::uint32_t, 3>;

using Random = test::RandomPoints;

/// By name: random, degenerate and cocircular points, n of each.
std::map<std::string, Points> families(std::size_t n) {
  std::map<std::string, Points> all;
  Random random(n);
  const auto make = [&](const char* name, auto&& point) {
    for (std::size_t i = 0; i < n; ++i) all[name].push_back(point(i));
    random.shuffle(all[name]);
  };
  const auto unit = [&] { return random.unit(); };
  const auto whole = [&](std::size_t below) { return static_cast<double>(random.below(below)); };
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  const double c = std::cos(0.3), s = std::sin(0.3);
  make("uniform", [&](std::size_t) {
    const double x = unit();
    return DVec2(x, unit());
  });
  make("grid",
       [&](std::size_t i) { return DVec2(static_cast<double>(i % side), static_cast<double>(i / side)); });
  make("tilted grid", [&](std::size_t i) {
    const auto x = static_cast<double>(i % side), y = static_cast<double>(i / side);
    return DVec2(c * x - s * y, s * x + c * y);
  });
  make("circle", [&](std::size_t) {
    const double a = 6.283185307179586 * unit();
    return DVec2(std::cos(a), std::sin(a));
  });
  make("cocircular", [&](std::size_t) {
    constexpr std::array<double, 6> kOf65 = {0, 16, 25, 33, 39, 52};
    const double x = kOf65[random.below(6)], y = std::sqrt(65.0 * 65 - x * x);
    const bool turned = random.below(2) == 0;
    const double p = random.below(2) == 0 ? x : -x, q = random.below(2) == 0 ? y : -y;
    return turned ? DVec2(q, p) : DVec2(p, q);
  });
  make("walls", [&](std::size_t) {
    const double x = whole(5) / 5;
    return DVec2(x, unit());
  });
  make("duplicates", [&](std::size_t) {
    const double x = whole(6);
    return DVec2(x, whole(6));
  });
  make("map coordinates", [&](std::size_t) {
    const double x = 500000 + whole(1000) / 100;
    return DVec2(x, 5400000 + whole(1000) / 100);
  });
  make("collinear but one", [&](std::size_t i) {
    return i == 2 ? DVec2(7, 8) : DVec2(static_cast<double>(i), 3.0 * static_cast<double>(i));
  });
  make("subnormal", [&](std::size_t) {
    const double x = whole(20);
    return DVec2(x, whole(20)) * 0x1p-1074;
  });
  make("spread", [&](std::size_t) {
    const double x = std::ldexp(unit(), static_cast<int>(random.below(1800)) - 900);
    return DVec2(x, std::ldexp(unit(), static_cast<int>(random.below(1800)) - 900));
  });
  return all;
}

DelaunayTriangulation triangulated(const Points& points) {
  auto made = delaunay(points);
  REQUIRE(made);
  REQUIRE(validate(made->mesh));
  return std::move(*made);
}

Points places(const DelaunayTriangulation& of, const Points& points) {
  Points result;
  for (const std::uint32_t i : of.point_of_vertex) result.push_back(points[i]);
  return result;
}

std::vector<Triangle> triangles_of(const HalfEdgeMesh& mesh) {
  std::vector<Triangle> all;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    all.push_back({mesh.origins()[3 * f], mesh.origins()[3 * f + 1], mesh.origins()[3 * f + 2]});
  return all;
}

bool same(const HalfEdgeMesh& a, const HalfEdgeMesh& b) {
  return std::ranges::equal(a.origins(), b.origins()) && std::ranges::equal(a.twins(), b.twins()) &&
         std::ranges::equal(a.leadings(), b.leadings());
}

/// All triangles whose circle is empty, in the order of delaunay().
std::vector<Triangle> plain_delaunay(const Points& p) {
  std::vector<Triangle> all;
  const auto n = static_cast<std::uint32_t>(p.size());
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = a + 1; b < n; ++b)
      for (std::uint32_t c = a + 1; c < n; ++c) {
        if (c == b || orientation(p[a], p[b], p[c]) <= 0) continue;
        bool empty = true;
        for (std::uint32_t d = 0; d < n && empty; ++d)
          if (d != a && d != b && d != c) empty = in_circle_perturbed(p[a], p[b], p[c], p[d]) < 0;
        if (empty) all.push_back({a, b, c});
      }
  return all;
}

/// The first interior edge whose circle is not empty, or kInvalid.
std::uint32_t first_wrong_edge(const HalfEdgeMesh& mesh, const Points& p) {
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    const HalfEdgeId e(h);
    if (mesh.is_boundary(e)) continue;
    const auto at = [&](VertexId v) { return p[v.index]; };
    if (in_circle_perturbed(at(mesh.origin(e)), at(mesh.target(e)), at(mesh.origin(mesh.previous(e))),
                            at(mesh.origin(mesh.previous(mesh.twin(e))))) >= 0)
      return h;
  }
  return kInvalid;
}

/// Swaps edges of a list of triangles at random, where the two are strictly convex together.
std::vector<Triangle> randomly_swapped(std::vector<Triangle> triangles, const Points& p, Random& random,
                                       std::size_t swaps) {
  for (std::size_t done = 0, tried = 0; done < swaps && tried < 1000 * swaps; ++tried) {
    Triangle &t = triangles[random.below(triangles.size())], &u = triangles[random.below(triangles.size())];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3], d = u[(k + 2) % 3];
        if (&t == &u || u[k] != b || u[(k + 1) % 3] != a) continue;
        if (orientation(p[c], p[a], p[d]) <= 0 || orientation(p[d], p[b], p[c]) <= 0) continue;
        t = {c, a, d};
        u = {d, b, c};
        ++done;
        i = k = 3;
      }
  }
  return triangles;
}

HalfEdgeMesh mesh_of(const std::vector<Triangle>& triangles, std::size_t points) {
  IndexedFaceSet set;
  set.points.resize(points);
  for (const Triangle& t : triangles) set.corners.insert(set.corners.end(), t.begin(), t.end());
  auto mesh = to_half_edge_mesh(set);
  REQUIRE(mesh);
  return std::move(*mesh);
}

/// All angles, ascending.
std::vector<double> angles_of(const std::vector<Triangle>& triangles, const Points& p) {
  std::vector<double> angles;
  for (const Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const DVec2 a = p[t[(i + 1) % 3]] - p[t[i]], b = p[t[(i + 2) % 3]] - p[t[i]];
      angles.push_back(std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y));
    }
  std::ranges::sort(angles);
  return angles;
}

}  // namespace

TEST_CASE("Delaunay triangles are those of empty circles", "[delaunay]") {
  for (const std::size_t n : {5u, 12u, 40u})
    for (const auto& [name, points] : families(n)) {
      INFO(name << ", " << n);
      const DelaunayTriangulation made = triangulated(points);
      CHECK(triangles_of(made.mesh) == plain_delaunay(places(made, points)));
    }
}

TEST_CASE("Delaunay triangulations of many points: edges, counts and hull", "[delaunay]") {
  for (const auto& [name, points] : families(3000)) {
    INFO(name);
    const DelaunayTriangulation made = triangulated(points);
    const HalfEdgeMesh& mesh = made.mesh;
    const Points p = places(made, points);
    CHECK(first_wrong_edge(mesh, p) == kInvalid);
    for (const Triangle& t : triangles_of(mesh)) {
      if (orientation(p[t[0]], p[t[1]], p[t[2]]) <= 0) FAIL("a triangle without area");
      if (t[0] > std::min(t[1], t[2])) FAIL("a face does not begin with its least vertex");
    }
    CHECK(std::ranges::is_sorted(triangles_of(mesh)));
    const std::size_t hull = mesh.boundary_half_edge_count();
    CHECK(mesh.face_count() == 2 * p.size() - 2 - hull);
    CHECK(mesh.edge_count() == 3 * p.size() - 3 - hull);
    // One loop that turns left or runs on everywhere, and all points left of it.
    const auto loops = mesh.boundary_loops();
    REQUIRE(loops.size() == 1);
    for (const HalfEdgeId h : loops[0]) {
      const DVec2 a = p[mesh.origin(h).index], b = p[mesh.target(h).index];
      CHECK(orientation(a, b, p[mesh.target(mesh.next_on_boundary(h)).index]) >= 0);
    }
    for (std::size_t i = 0; i < loops[0].size(); i += 1 + loops[0].size() / 40)
      for (const DVec2 q : p)
        if (orientation(p[mesh.origin(loops[0][i]).index], p[mesh.target(loops[0][i]).index], q) < 0)
          FAIL("outside");
    // The maps between points and vertices.
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const std::uint32_t v = made.vertex_of_point[i];
      if (p[v] != points[i] || made.point_of_vertex[v] > i) FAIL("point " << i);
    }
  }
}

TEST_CASE("A Delaunay triangulation is a function of the set of points", "[delaunay]") {
  Random random(17);
  for (const auto& [name, points] : families(1000)) {
    INFO(name);
    const DelaunayTriangulation made = triangulated(points);
    const Points p = places(made, points);
    Points other = points;
    random.shuffle(other);
    const DelaunayTriangulation shuffled = triangulated(other);
    CHECK(same(made.mesh, shuffled.mesh));
    CHECK(p == places(shuffled, other));
    if (name != "spread" && name != "subnormal")
      for (const int exponent : {-60, 60, -150}) {
        other = points;
        for (DVec2& q : other) q *= std::ldexp(1.0, exponent);
        const DelaunayTriangulation scaled = triangulated(other);
        CHECK(same(made.mesh, scaled.mesh));
        CHECK(made.vertex_of_point == scaled.vertex_of_point);
      }
    // Cocircular points go by their lexicographic order, which a turn changes.
    if (name != "uniform" && name != "spread") continue;
    other = points;
    for (DVec2& q : other) q = {-q.y, q.x};
    const DelaunayTriangulation turned = triangulated(other);
    const auto in_points = [](const DelaunayTriangulation& of) {
      std::vector<Triangle> triangles = triangles_of(of.mesh);
      for (Triangle& t : triangles) {
        for (std::uint32_t& v : t) v = of.point_of_vertex[v];
        const Triangle u = t;
        const auto k = static_cast<std::size_t>(std::ranges::min_element(u) - u.begin());
        t = {u[k], u[(k + 1) % 3], u[(k + 2) % 3]};
      }
      std::ranges::sort(triangles);
      return triangles;
    };
    CHECK(in_points(made) == in_points(turned));
  }
}

TEST_CASE("A Delaunay triangulation does not depend on the number of threads", "[delaunay]") {
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 8);
  std::map<std::string, Points> all = families(40000);
  for (const char* name : {"uniform", "tilted grid", "walls"}) {
    INFO(name);
    const Points& points = all[name];
    const auto on = [&](int threads) {
      DelaunayTriangulation made;
      tbb::task_arena(threads).execute([&] { made = triangulated(points); });
      return made;
    };
    const DelaunayTriangulation one = on(1);
    for (const int threads : {2, 4}) {
      const DelaunayTriangulation several_threads = on(threads);
      CHECK(same(one.mesh, several_threads.mesh));
      CHECK(one.vertex_of_point == several_threads.vertex_of_point);
      CHECK(one.point_of_vertex == several_threads.point_of_vertex);
    }
    CHECK(first_wrong_edge(one.mesh, places(one, points)) == kInvalid);
    tbb::task_arena(4).execute([&] {
      const auto none = delaunay(points, [](double fraction) { return fraction < 0.05; });
      REQUIRE(!none);
      CHECK(none.error().code == ErrorCode::kInterrupted);
    });
  }
}

TEST_CASE("Few points, and points in one line", "[delaunay]") {
  CHECK(triangulated({}).mesh.vertex_count() == 0);
  for (const Points& line : {Points{{3, 4}}, Points{{3, 4}, {3, 4}, {3, 4}}, Points{{0, 0}, {1, 1}},
                             Points{{0, 0}, {1, 3}, {-5, -15}, {1, 3}, {0.5, 1.5}}}) {
    const DelaunayTriangulation made = triangulated(line);
    CHECK(made.mesh.face_count() == 0);
    for (std::uint32_t i = 0; i < line.size(); ++i)
      CHECK(line[made.point_of_vertex[made.vertex_of_point[i]]] == line[i]);
  }
  const DelaunayTriangulation same_place = triangulated({{0.0, 0.0}, {1, 0}, {0, 1}, {-0.0, -0.0}, {1, 0}});
  CHECK(same_place.mesh.vertex_count() == 3);
  CHECK(same_place.mesh.face_count() == 1);
  CHECK(same_place.vertex_of_point[3] == same_place.vertex_of_point[0]);
  CHECK(same_place.point_of_vertex[same_place.vertex_of_point[4]] == 1);
  // The largest coordinates there are.
  constexpr double kMost = std::numeric_limits<double>::max();
  CHECK(triangulated({{-kMost, -kMost}, {kMost, -kMost}, {kMost, kMost}, {-kMost, kMost}, {0, 1e-300}})
            .mesh.face_count() == 4);
}

TEST_CASE("Points that are not finite are named", "[delaunay]") {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    Points points(10, DVec2(0, 0));
    points[7].y = bad;
    const auto made = delaunay(points);
    REQUIRE(!made);
    CHECK(made.error().code == ErrorCode::kUnsuitable);
    CHECK(made.error().message == "point 7 is not finite");
  }
}

TEST_CASE("A Delaunay triangulation hears that it is not wanted", "[delaunay]") {
  const Points points = families(3000)["uniform"];
  const auto made = delaunay(points, [](double) { return false; });
  REQUIRE(!made);
  CHECK(made.error().code == ErrorCode::kInterrupted);
}

TEST_CASE("Delaunay triangles have the largest angles", "[delaunay]") {
  Random random(4);
  for (const char* name : {"uniform", "tilted grid", "walls"}) {
    INFO(name);
    const Points points = families(14)[name];
    const DelaunayTriangulation made = triangulated(points);
    const Points p = places(made, points);
    std::vector<Triangle> triangles = triangles_of(made.mesh);
    const std::vector<double> best = angles_of(triangles, p);
    for (int i = 0; i < 1000; ++i) {
      triangles = randomly_swapped(std::move(triangles), p, random, 3);
      const std::vector<double> angles = angles_of(triangles, p);
      // Lexicographically, angles that differ by rounding taken for equal.
      const auto differ =
          std::ranges::mismatch(best, angles, [](double a, double b) { return std::fabs(a - b) < 1e-9; });
      if (differ.in1 != best.end() && *differ.in1 < *differ.in2) FAIL("better by swaps " << i);
    }
  }
}

TEST_CASE("Swaps from any triangulation end at the Delaunay triangulation", "[delaunay]") {
  Random random(5);
  for (const std::size_t n : {14u, 200u})
    for (const auto& [name, points] : families(n)) {
      INFO(name << ", " << n);
      const DelaunayTriangulation made = triangulated(points);
      const Points p = places(made, points);
      std::vector<Triangle> triangles = triangles_of(made.mesh);
      for (int i = 0; i < 5; ++i) {
        triangles = randomly_swapped(std::move(triangles), p, random, n);
        random.shuffle(triangles);
        const auto swapped = swap_to_delaunay(mesh_of(triangles, p.size()), p);
        REQUIRE(swapped);
        REQUIRE(same(swapped->mesh, made.mesh));
      }
      const auto none = swap_to_delaunay(made.mesh, p);
      REQUIRE(none);
      CHECK(none->swaps == 0);
    }
}

TEST_CASE("Swaps keep the boundary", "[delaunay]") {
  // A comb: its boundary is not convex, and has collinear points.
  Points p;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const auto x = static_cast<double>(i);
    p.insert(p.end(), {{x, 0}, {x, 1 + (i % 2) * 9.0}});
    if (i > 0)
      triangles.insert(triangles.end(), {{2 * i - 2, 2 * i, 2 * i + 1}, {2 * i - 2, 2 * i + 1, 2 * i - 1}});
  }
  const HalfEdgeMesh comb = mesh_of(triangles, p.size());
  const auto swapped = swap_to_delaunay(comb, p);
  REQUIRE(swapped);
  REQUIRE(validate(swapped->mesh));
  CHECK(swapped->swaps > 0);
  CHECK(first_wrong_edge(swapped->mesh, p) == kInvalid);
  CHECK(swapped->mesh.boundary_half_edge_count() == comb.boundary_half_edge_count());
  for (std::uint32_t h = 0; h < comb.half_edge_count(); ++h)
    if (comb.is_boundary(HalfEdgeId(h))) {
      const HalfEdgeId kept =
          swapped->mesh.find_half_edge(comb.origin(HalfEdgeId(h)), comb.target(HalfEdgeId(h)));
      CHECK((kept.valid() && swapped->mesh.is_boundary(kept)));
    }
}

TEST_CASE("Meshes that are no triangulation of the plane are refused", "[delaunay]") {
  const Points p = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const auto refused = [](const HalfEdgeMesh& mesh, const Points& points) {
    const auto swapped = swap_to_delaunay(mesh, points);
    REQUIRE(!swapped);
    CHECK(swapped.error().code == ErrorCode::kUnsuitable);
    return swapped.error().message;
  };
  CHECK(refused(mesh_of({{0, 1, 2}, {0, 2, 3}}, 4), {p[0], p[1], p[2], {1, 0.5}}) ==
        "face 1 does not turn counter-clockwise");
  CHECK(refused(mesh_of({{0, 1, 2}, {0, 2, 3}}, 4), {p[0], p[1], p[2], {NAN, 0.5}}) ==
        "point 3 is not finite");
  CHECK(refused(mesh_of({{0, 1, 2}}, 3), p) ==
        "edges are swapped in triangles, with a point for each vertex");
  // Two sheets that wind twice round vertices 0 and 1: swaps would join these on either.
  const DVec2 up(0, 3), down(0, -3), west(-5, 0), east(5, 0);
  const Points sheets = {{-1, 0}, {1, 0}, up, down, up, down, west, west, east, east};
  const std::vector<Triangle> twice = {{0, 3, 2}, {0, 5, 4}, {1, 2, 3}, {1, 4, 5}, {6, 0, 2}, {6, 5, 0},
                                       {7, 0, 4}, {7, 3, 0}, {8, 2, 1}, {8, 1, 5}, {9, 4, 1}, {9, 1, 3}};
  CHECK(refused(mesh_of(twice, sheets.size()), sheets) == "triangles overlap");
}
