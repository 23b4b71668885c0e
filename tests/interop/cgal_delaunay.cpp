// Delaunay triangulations of CGAL beside those of vkmesh, triangle for triangle, with constraints, too, and
// its exact predicates beside ours.
//   cgal_delaunay [POINTS]    so many points of each family, default 20000
// Prints one line of totals; every disagreement goes to standard error and fails.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <vkmesh/planar/constrained_delaunay.h>
#include <vkmesh/planar/delaunay.h>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertices>>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel,
    CGAL::Triangulation_data_structure_2<Vertices, CGAL::Constrained_triangulation_face_base_2<Kernel>>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Exact = CGAL::Simple_cartesian<CGAL::Gmpq>;
using vkmesh::DVec2;
using Points = std::vector<DVec2>;

double unit(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

std::map<std::string, Points> families(std::size_t n) {
  std::map<std::string, Points> all;
  std::mt19937_64 random(1);
  const auto u = [&] { return unit(random); };
  const auto make = [&](const char* name, std::size_t count, auto&& point) {
    for (std::size_t i = 0; i < count; ++i) all[name].push_back(point(i));
  };
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(n)));
  const auto column = [&](std::size_t i) { return static_cast<double>(i % side); };
  const auto row = [&](std::size_t i) { return static_cast<double>(i / side); };
  const double c = std::cos(0.3), s = std::sin(0.3), turn = 6.283185307179586;
  make("uniform", n, [&](std::size_t) {
    const double x = u();
    return DVec2(x, u());
  });
  make("Gaussian", n, [&](std::size_t) {
    const double r = std::sqrt(-2 * std::log(1 - u())), a = turn * u();
    return DVec2(r * std::cos(a), r * std::sin(a));
  });
  make("grid", side * side, [&](std::size_t i) { return DVec2(column(i), row(i)); });
  make("tilted grid", side * side,
       [&](std::size_t i) { return DVec2(c * column(i) - s * row(i), s * column(i) + c * row(i)); });
  make("tilted grid of floats", side * side, [&](std::size_t i) {
    return DVec2(static_cast<float>(c * column(i) - s * row(i)),
                 static_cast<float>(s * column(i) + c * row(i)));
  });
  make("circle", n / 4, [&](std::size_t) {
    const double a = turn * u();
    return DVec2(std::cos(a), std::sin(a));
  });
  make("cocircular", 1000, [&](std::size_t) {  // 5² + 12² and the like, scaled: many on one circle, exactly
    constexpr std::array<std::array<int, 2>, 6> kLegs = {
        {{33, 56}, {16, 63}, {25, 60}, {39, 52}, {0, 65}, {52, 39}}};
    const auto& leg = kLegs[random() % 6];
    const double x = random() % 2 ? leg[0] : -leg[0], y = random() % 2 ? leg[1] : -leg[1];
    return random() % 4 == 0 ? DVec2(std::floor(u() * 130) - 65, std::floor(u() * 130) - 65) : DVec2(x, y);
  });
  make("walls", n, [&](std::size_t) {
    const double x = std::floor(20 * u()) / 20;
    return DVec2(x, u());
  });
  make("lines", n / 4, [&](std::size_t) {
    const double k = std::floor(10 * u()), t = u();
    return DVec2(std::sin(k) + t * std::cos(7 * k), std::cos(3 * k) + t * std::sin(5 * k));
  });
  make("map coordinates", n, [&](std::size_t) {
    const double x = std::floor(u() * 1e6) / 100;
    return DVec2(500000 + x, 5400000 + std::floor(u() * 1e6) / 100);
  });
  make("clusters", n, [&](std::size_t i) {
    const double scale = std::pow(10.0, -static_cast<double>(i % 12)), x = u();
    return DVec2(scale * x, scale * u());
  });
  make("duplicates", n, [&](std::size_t) {
    const double x = std::floor(u() * 50);
    return DVec2(x, std::floor(u() * 50));
  });
  make("collinear", 1000, [&](std::size_t) {
    const double x = std::floor(u() * 5000);
    return DVec2(x, 3 * x);
  });
  make("collinear but one", 1000, [&](std::size_t i) {
    const double x = std::floor(u() * 5000);
    return i == 700 ? DVec2(7, 8) : DVec2(x, 3 * x);
  });
  for (std::size_t few = 0; few < 5; ++few) {
    all["few " + std::to_string(few)] = {};
    make(("few " + std::to_string(few)).c_str(), few, [&](std::size_t i) { return DVec2(i % 2, i / 2); });
  }
  for (const char* name : {"uniform", "grid", "tilted grid"})
    for (const int exponent : {-60, 60}) {
      Points scaled = all[name];
      for (DVec2& p : scaled) p *= std::ldexp(1.0, exponent);
      all[std::string(name) + " times 2^" + std::to_string(exponent)] = scaled;
    }
  make("subnormal", n / 10, [&](std::size_t) {
    const double x = std::floor(u() * 100);
    return DVec2(x, std::floor(u() * 100)) * 0x1p-1074;
  });
  make("spread", n / 10, [&](std::size_t) {
    const double x = std::ldexp(u(), static_cast<int>(random() % 120) - 60);
    return DVec2(x, std::ldexp(u(), static_cast<int>(random() % 120) - 60));
  });
  for (auto& [name, points] : all) std::shuffle(points.begin(), points.end(), random);
  return all;
}

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
void add(Triangles& triangles, std::array<std::uint32_t, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  triangles.push_back(t);
}

/// With ids that stand for all points of a place.
Triangles of_cgal(const Points& points, const vkmesh::DelaunayTriangulation& ours) {
  std::vector<std::pair<Kernel::Point_2, std::uint32_t>> input;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    input.push_back({{points[i].x, points[i].y}, ours.vertex_of_point[i]});
  const Delaunay delaunay(input.begin(), input.end());
  Triangles triangles;
  for (auto f = delaunay.finite_faces_begin(); f != delaunay.finite_faces_end(); ++f)
    add(triangles, {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

int compare_triangulations(std::size_t n, std::size_t& triangles) {
  int bad = 0;
  for (const auto& [name, points] : families(n)) {
    const auto ours = vkmesh::delaunay(points);
    if (!ours) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), ours.error().describe().c_str());
      return 1;
    }
    Triangles mine;
    const auto corners = ours->mesh.origins();
    for (std::size_t f = 0; f < ours->mesh.face_count(); ++f)
      add(mine, {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]});
    std::sort(mine.begin(), mine.end());
    const Triangles theirs = of_cgal(points, *ours);
    triangles += mine.size();
    if (mine == theirs) continue;
    ++bad;
    Triangles common;
    std::set_intersection(mine.begin(), mine.end(), theirs.begin(), theirs.end(), std::back_inserter(common));
    std::fprintf(stderr, "%s: %zu triangles, CGAL has %zu, %zu of both\n", name.c_str(), mine.size(),
                 theirs.size(), common.size());
  }
  return bad;
}

/// A third of the edges of the Delaunay triangulation of some of the points: none crosses another.
std::vector<vkmesh::PointPair> constraints_of(const Points& points, std::mt19937_64& random) {
  std::vector<vkmesh::PointPair> constraints;
  Points some;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (random() % 20 == 0) {
      some.push_back(points[i]);
      numbers.push_back(i);
    }
  const auto made = vkmesh::delaunay(some);
  if (!made) return {};
  made->mesh.for_each_edge([&](vkmesh::HalfEdgeId h) {
    if (random() % 3 > 0) return;
    const auto number = [&](vkmesh::VertexId v) { return numbers[made->point_of_vertex[v.index]]; };
    constraints.push_back({number(made->mesh.origin(h)), number(made->mesh.target(h))});
  });
  return constraints;
}

int compare_constrained(std::size_t n, std::size_t& triangles, std::size_t& edges) {
  int bad = 0;
  std::mt19937_64 random(9);
  for (const auto& [name, points] : families(n)) {
    const auto constraints = constraints_of(points, random);
    const auto ours = vkmesh::constrained_delaunay(points, constraints);
    if (!ours) {
      std::fprintf(stderr, "%s, constrained: %s\n", name.c_str(), ours.error().describe().c_str());
      ++bad;
      continue;
    }
    Constrained theirs;
    std::vector<Constrained::Vertex_handle> handles(ours->positions.size());
    for (std::uint32_t v = 0; v < handles.size(); ++v) {
      handles[v] = theirs.insert({ours->positions[v].x, ours->positions[v].y});
      handles[v]->info() = v;
    }
    for (const auto& [a, b] : constraints) {
      const auto u = handles[ours->vertex_of_point[a]], v = handles[ours->vertex_of_point[b]];
      if (u != v && theirs.dimension() == 2) theirs.insert_constraint(u, v);
    }
    Triangles mine, other;
    const auto corners = ours->mesh.origins();
    for (std::size_t f = 0; f < ours->mesh.face_count(); ++f)
      add(mine, {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]});
    for (auto f = theirs.finite_faces_begin(); f != theirs.finite_faces_end(); ++f)
      add(other, {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    std::sort(mine.begin(), mine.end());
    std::sort(other.begin(), other.end());
    std::size_t their_edges = 0;
    for (auto e = theirs.constrained_edges_begin(); e != theirs.constrained_edges_end(); ++e) ++their_edges;
    triangles += mine.size();
    edges += ours->constrained_edges.size();
    if (mine == other && their_edges == ours->constrained_edges.size()) continue;
    ++bad;
    Triangles common;
    std::set_intersection(mine.begin(), mine.end(), other.begin(), other.end(), std::back_inserter(common));
    std::fprintf(stderr, "%s, constrained: %zu triangles, CGAL has %zu, %zu of both; %zu edges, CGAL %zu\n",
                 name.c_str(), mine.size(), other.size(), common.size(), ours->constrained_edges.size(),
                 their_edges);
  }
  return bad;
}

/// Points on a grid with steps of many sizes, now and then moved by the least there is: many are collinear or
/// cocircular, or nearly.
int compare_predicates(std::size_t& zeros) {
  std::mt19937_64 random(5);
  int bad = 0;
  for (int i = 0; i < 200000; ++i) {
    const int kind = i % 4, base = kind == 3 ? static_cast<int>(random() % 600) - 300 : 0;
    std::array<DVec2, 4> p;
    for (DVec2& at : p)
      for (int axis = 0; axis < 2; ++axis) {
        double x = static_cast<double>(random() % 8);
        if (kind >= 1 && random() % 8 == 0) x = std::nextafter(x, random() % 2 ? 1e9 : -1e9);
        if (kind == 2) x = std::ldexp(unit(random), static_cast<int>(random() % 400) - 200);
        at[axis] = std::ldexp(x, base);
      }
    std::array<Exact::Point_2, 4> q;
    for (int k = 0; k < 4; ++k) q[k] = {CGAL::Gmpq(p[k].x), CGAL::Gmpq(p[k].y)};
    const int turn = static_cast<int>(CGAL::orientation(q[0], q[1], q[2]));
    const int circle =
        turn == 0 ? 0 : turn * static_cast<int>(CGAL::side_of_bounded_circle(q[0], q[1], q[2], q[3]));
    zeros += circle == 0 ? 1 : 0;
    if (vkmesh::orientation(p[0], p[1], p[2]) != turn) ++bad;
    if (turn != 0 && vkmesh::in_circle(p[0], p[1], p[2], p[3]) != circle) ++bad;
  }
  if (bad > 0) std::fprintf(stderr, "%d predicates differ\n", bad);
  return bad;
}

}  // namespace

int main(int count, char** arguments) {
  const std::size_t points = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 20000;
  std::size_t triangles = 0, zeros = 0, constrained = 0, edges = 0;
  const int bad = compare_predicates(zeros) + compare_triangulations(points, triangles) +
                  compare_constrained(points, constrained, edges);
  std::printf("%zu triangles, %zu with %zu edges of constraints, 200000 predicates (%zu of them 0)\n",
              triangles, constrained, edges, zeros);
  return bad == 0 ? 0 : 1;
}
