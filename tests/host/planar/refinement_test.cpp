#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/planar/constrained_delaunay.h>

#include "host/planar/constrained_input.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Outlines and constraints of points, to be refined.
struct Domain {
  ConstrainedInput input;
  std::vector<PointPair> outlines;

  void add_outline(const std::vector<DVec2>& loop) {
    const auto first = static_cast<std::uint32_t>(input.points.size());
    const auto n = static_cast<std::uint32_t>(loop.size());
    for (std::uint32_t i = 0; i < n; ++i) outlines.push_back({first + i, first + (i + 1) % n});
    input.points.insert(input.points.end(), loop.begin(), loop.end());
  }
};

ConstrainedTriangulation refined(const Domain& domain, const std::optional<DelaunayRefinement>& refinement) {
  ConstrainedDelaunayOptions options;
  options.outlines = domain.outlines;
  options.domain = domain.outlines.empty() ? DelaunayDomain::kConvexHull : DelaunayDomain::kEvenOdd;
  options.refinement = refinement;
  auto made = constrained_delaunay(domain.input.points, domain.input.constraints, options);
  if (!made) FAIL(made.error().describe());
  REQUIRE(validate(made->mesh));
  return std::move(*made);
}

struct Triangle {
  double least_angle, area, shortest;
};
Triangle triangle(const ConstrainedTriangulation& of, std::size_t f) {
  std::array<DVec2, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = of.positions[of.mesh.origins()[3 * f + i]];
  Triangle result{4, 0, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < 3; ++i) {
    const DVec2 a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
    result.area = (a.x * b.y - a.y * b.x) / 2;
    result.least_angle = std::min(result.least_angle, std::atan2(2 * result.area, a.x * b.x + a.y * b.y));
    result.shortest = std::min(result.shortest, std::hypot(a.x, a.y));
  }
  return result;
}

/// Every triangle is as asked for, or listed.
void check_refined(const ConstrainedTriangulation& of, const DelaunayRefinement& asked) {
  std::size_t next = 0;
  for (std::size_t f = 0; f < of.mesh.face_count(); ++f) {
    const Triangle t = triangle(of, f);
    if (t.area <= 0) FAIL("face " << f << " is turned over");
    const bool listed = next < of.unrefined.size() && of.unrefined[next].face.index == f;
    if (listed) ++next;
    const double area = asked.max_area.value_or(std::numeric_limits<double>::infinity());
    const bool good = t.least_angle >= asked.min_angle * (1 - 1e-12) && t.area <= area * (1 + 1e-12);
    const bool bad = t.least_angle < asked.min_angle * (1 - 1e-6) || t.area > area * (1 + 1e-6);
    if (!listed && !good) FAIL("face " << f << " is bad: " << t.least_angle / kDegree << ", " << t.area);
    if (listed && good && !bad) FAIL("face " << f << " is listed, and good");
  }
  CHECK(next == of.unrefined.size());
  CHECK(of.positions.size() == of.mesh.vertex_count());
  for (std::size_t i = 0; i < of.added.size(); ++i) {
    const auto& [from, weights] = of.added[i];
    DVec2 sum(0, 0);
    for (std::size_t k = 0; k < 3; ++k) sum += of.positions[from[k]] * static_cast<double>(weights[k]);
    const DVec2 p = of.positions[of.positions.size() - of.added.size() + i];
    const DVec2 q = of.positions[from[0]], r = of.positions[from[1]];
    if (std::hypot(sum.x - p.x, sum.y - p.y) >
        1e-5 * (std::hypot(p.x, p.y) + std::hypot(q.x - r.x, q.y - r.y)))
      FAIL("added vertex " << i << " is not where its weights say");
  }
}

double area_of(const ConstrainedTriangulation& of) {
  double area = 0;
  for (std::size_t f = 0; f < of.mesh.face_count(); ++f) area += triangle(of, f).area;
  return area;
}

/// The constraint from a to b is a chain of edges of constraints that leaves it by rounding alone.
bool follows(const ConstrainedTriangulation& of, std::uint32_t from, std::uint32_t to) {
  std::set<std::array<std::uint32_t, 2>> kept;
  for (const HalfEdgeId h : of.constrained_edges) {
    kept.insert({of.mesh.origin(h).index, of.mesh.target(h).index});
    kept.insert({of.mesh.target(h).index, of.mesh.origin(h).index});
  }
  const auto& p = of.positions;
  const DVec2 whole = p[to] - p[from];
  const double length = std::hypot(whole.x, whole.y);
  std::uint32_t now = from;
  while (now != to) {
    std::uint32_t next = kInvalid;
    for (auto e = kept.lower_bound({now, 0}); e != kept.end() && (*e)[0] == now; ++e) {
      const DVec2 step = p[(*e)[1]] - p[now], off = p[(*e)[1]] - p[from];
      const double height = std::fabs(whole.x * off.y - whole.y * off.x) / length;
      if (height <= 1e-14 * length && step.x * whole.x + step.y * whole.y > 0) next = (*e)[1];
    }
    if (next == kInvalid) return false;
    now = next;
  }
  return true;
}

/// An outline like a coast, with a lake.
Domain coast(std::uint32_t sides) {
  Domain domain;
  PlanarRandom random(sides);
  std::vector<DVec2> shore, lake;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double a = 2 * std::numbers::pi * i / sides,
                 r = 8 + std::cos(3 * a) + std::cos(7 * a + 1) + random.unit();
    shore.emplace_back(r * std::cos(a), r * std::sin(a));
    if (i % 4 == 0) lake.emplace_back(2 * std::cos(a) - 1, 1.5 * std::sin(a) + 1);
  }
  domain.add_outline(shore);
  domain.add_outline(lake);
  return domain;
}

}  // namespace

TEST_CASE("Refinement reaches angles and areas", "[refinement]") {
  std::vector<Domain> domains(3);
  domains[0].add_outline({{0, 0}, {10, 0}, {10, 1}, {0, 1}});
  domains[0].input.points.push_back({9.99, 0.013});
  domains[1] = coast(100);
  domains[2].input.points = planar_points(500)["uniform"];
  PlanarRandom random(5);
  for (const double angle : {0.0, 15.0, 20.7, 28.0, 33.0})
    for (const double area : {0.0, 0.02})
      for (const Domain& domain : domains) {
        INFO(angle << " degrees, area " << area << ", " << domain.input.points.size() << " points");
        DelaunayRefinement asked;
        asked.min_angle = angle * kDegree;
        if (area > 0) asked.max_area = area;
        const ConstrainedTriangulation made = refined(domain, asked);
        check_refined(made, asked);
        for (const UnrefinedTriangle& t : made.unrefined) CHECK(t.reason == UnrefinedReason::kInputAngle);
        if (domain.input.points.size() == 500) CHECK(made.unrefined.empty());
        CHECK(made.refined_points == made.added.size());
        // What Delaunay refinement promises besides: no vertex in the circle over a part of a constraint.
        if (angle == 28.0)
          for (const HalfEdgeId h : made.constrained_edges)
            for (const HalfEdgeId side : {h, made.mesh.twin(h)}) {
              if (!side.valid()) continue;
              const auto at = [&](HalfEdgeId e) { return made.positions[made.mesh.origin(e).index]; };
              const DVec2 apex = at(made.mesh.previous(side)), u = at(side) - apex,
                          v = at(made.mesh.next(side)) - apex;
              CHECK(u.x * v.x + u.y * v.y >= 0);
            }
      }
}

TEST_CASE("Refinement keeps the domain and the constraints", "[refinement]") {
  Domain domain = coast(60);
  const auto first = static_cast<std::uint32_t>(domain.input.points.size());
  domain.input.points.insert(domain.input.points.end(), {{-5, -4}, {5, -3.3}, {-3, -5}, {3.1, -2}, {4, 4}});
  domain.input.constraints = {{first, first + 1}, {first + 3, first + 4}};
  const ConstrainedTriangulation before = refined(domain, {});
  DelaunayRefinement asked;
  asked.min_angle = 25 * kDegree;
  asked.max_area = 0.1;
  const ConstrainedTriangulation made = refined(domain, asked);
  CHECK(made.refined_points > 1000);
  CHECK(area_of(made) == Approx(area_of(before)).epsilon(1e-13));
  CHECK(made.mesh.boundary_loops().size() == 2);
  for (const auto* edges : {&domain.outlines, &domain.input.constraints})
    for (const auto& [a, b] : *edges)
      if (!follows(made, made.vertex_of_point[a], made.vertex_of_point[b])) FAIL(a << " to " << b);
  // The same bytes for any order.
  Domain turned = domain;
  std::reverse(turned.outlines.begin(), turned.outlines.end());
  std::swap(turned.input.constraints[0], turned.input.constraints[1]);
  const ConstrainedTriangulation again = refined(turned, asked);
  CHECK(made.positions == again.positions);
  CHECK(std::ranges::equal(made.mesh.origins(), again.mesh.origins()));
  CHECK(made.constrained_edges == again.constrained_edges);
}

TEST_CASE("Refinement ends at small angles, and lists the triangles there", "[refinement]") {
  for (const double spread : {40.0, 5.0, 0.1, 1e-6, 1e-9}) {
    INFO(spread << " degrees");
    Domain domain;
    domain.input.points = {{0, 0}, {-3, -3}, {8, -3}, {8, 3}, {-3, 3}};
    for (std::uint32_t i = 0; i < 6; ++i) {
      const double a = (1 + i * spread) * kDegree, r = 1 + 0.37 * i;
      domain.input.points.emplace_back(r * std::cos(a), r * std::sin(a));
      domain.input.constraints.push_back({0, 5 + i});
    }
    DelaunayRefinement asked;
    asked.min_angle = 25 * kDegree;
    asked.max_points = 20000;
    const ConstrainedTriangulation made = refined(domain, asked);
    check_refined(made, asked);
    CHECK(made.refined_points < 4000);
    for (const UnrefinedTriangle& t : made.unrefined) CHECK(t.reason == UnrefinedReason::kInputAngle);
    CHECK(made.unrefined.empty() == (spread > 25));
  }
}

TEST_CASE("Refinement ends with its budget, and at its shortest edge", "[refinement]") {
  const Domain domain = coast(40);
  DelaunayRefinement asked;
  asked.min_angle = 50 * kDegree;  // more than can be
  for (const std::size_t most : {std::size_t{0}, std::size_t{1}, std::size_t{77}, std::size_t{3000}}) {
    asked.max_points = most;
    const ConstrainedTriangulation made = refined(domain, asked);
    check_refined(made, asked);
    CHECK(made.refined_points == most);
    REQUIRE(!made.unrefined.empty());
    CHECK(std::any_of(made.unrefined.begin(), made.unrefined.end(),
                      [](const UnrefinedTriangle& t) { return t.reason == UnrefinedReason::kMaxPoints; }));
  }
  asked = {};
  asked.max_area = 1e-3;
  asked.min_edge = 0.2;
  const ConstrainedTriangulation made = refined(domain, asked);
  check_refined(made, asked);
  CHECK(made.refined_points > 100);
  for (const UnrefinedTriangle& t : made.unrefined) CHECK(t.reason == UnrefinedReason::kMinEdge);
  double shortest = 1;
  for (std::size_t f = 0; f < made.mesh.face_count(); ++f)
    shortest = std::min(shortest, triangle(made, f).shortest);
  CHECK(shortest >= 0.2 * (1 - 1e-12));
  // Triangles of the least numbers there are, and of the largest.
  for (const double scale : {0x1p-1074, 0x1p-1000, 0x1p-500, 0x1p500, 0x1p1000, 0x1p1018}) {
    Domain extreme;
    extreme.input.points = {DVec2(0, 0) * scale, DVec2(30, 1) * scale, DVec2(29, 9) * scale,
                            DVec2(2, 8) * scale};
    extreme.input.constraints = {{0, 2}};
    asked = {};
    asked.min_angle = 25 * kDegree;
    asked.max_points = 500;
    CHECK(refined(extreme, asked).refined_points <= 500);
  }
}

TEST_CASE("Refinement refuses what has no meaning", "[refinement]") {
  const std::vector<DVec2> points = {{0, 0}, {1, 0}, {0, 1}};
  const auto message = [&](const DelaunayRefinement& refinement) {
    ConstrainedDelaunayOptions options;
    options.refinement = refinement;
    const auto made = constrained_delaunay(points, {}, options);
    REQUIRE(!made);
    CHECK(made.error().code == ErrorCode::kUsage);
    return made.error().message;
  };
  for (const double angle : {60 * kDegree, -0.1, std::nan("")}) {
    DelaunayRefinement asked;
    asked.min_angle = angle;
    CHECK(message(asked) == "the least angle of a triangle is from 0 to below 60 degrees");
  }
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    DelaunayRefinement asked;
    asked.max_area = bad;
    CHECK(message(asked) == "the largest area of a triangle is above 0");
    asked = {};
    asked.min_edge = bad == 0 ? HUGE_VAL : bad;
    CHECK(message(asked) == "the shortest edge that refinement may make has a length from 0 on");
  }
}

TEST_CASE("Refinement of random points and constraints ends, on grids and lines, too", "[refinement]") {
  for (const std::size_t n : {6u, 25u})
    for (const auto& [name, points] : planar_points(n)) {
      PlanarRandom random(n);
      Domain domain;
      domain.input.points = points;
      add_constraints(domain.input, n / 3, random);
      for (const double angle : {20.0, 30.0}) {
        INFO(name << ", " << n << ", " << angle << " degrees");
        DelaunayRefinement asked;
        asked.min_angle = angle * kDegree;
        asked.max_points = 3000;
        const ConstrainedTriangulation made = refined(domain, asked);
        if (name != "subnormal" && name != "spread") check_refined(made, asked);
        CHECK(made.refined_points <= 3000);
      }
    }
}
