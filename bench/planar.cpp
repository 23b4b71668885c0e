// vkmesh_bench_planar [POINTS] [REPETITIONS] [FAMILY] [THREADS]: Delaunay triangulations beside CGAL's and
// Voronoi diagrams beside Boost.Polygon's, as a table in Markdown. FAMILY is one of points, or "constrained":
// a closed line among uniform ones, and its refinement.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>

#include <vkmesh/planar/constrained_delaunay.h>
#include <vkmesh/planar/delaunay.h>
#include <vkmesh/planar/voronoi.h>

#ifdef VKMESH_BENCH_CGAL
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_criteria_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/version.h>
#endif

#ifdef VKMESH_BENCH_BOOST
#include <boost/polygon/voronoi.hpp>
#endif

#include "bench/machine.h"
#include "bench/memory.h"

namespace vkmesh::bench {
namespace {

using Points = std::vector<DVec2>;

struct Family {
  const char* name;
  std::function<Points(std::size_t, const std::function<double()>&)> points;
};

template <class Point>
Points listed(std::size_t n, Point&& point) {
  Points points;
  points.reserve(n);
  for (std::size_t i = 0; i < n; ++i) points.push_back(point(i));
  return points;
}

/// Rows of a square grid, turned by `angle`.
Points grid(std::size_t n, double angle, bool single) {
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(n)));
  const double c = std::cos(angle), s = std::sin(angle);
  return listed(side * side, [&](std::size_t i) {
    const auto x = static_cast<double>(i % side), y = static_cast<double>(i / side);
    const DVec2 p(c * x - s * y, s * x + c * y);
    return single ? DVec2(static_cast<float>(p.x), static_cast<float>(p.y)) : p;
  });
}

const std::vector<Family>& families() {
  using Unit = std::function<double()>;
  constexpr double kTurn = 6.283185307179586;
  static const std::vector<Family> all = {
      {"uniform",
       [](std::size_t n, const Unit& u) {
         return listed(n, [&](std::size_t) {
           const double x = u();
           return DVec2(x, u());
         });
       }},
      {"Gaussian",
       [](std::size_t n, const Unit& u) {
         return listed(n, [&](std::size_t) {
           const double r = std::sqrt(-2 * std::log(1 - u())), a = kTurn * u();
           return DVec2(r * std::cos(a), r * std::sin(a));
         });
       }},
      {"grid", [](std::size_t n, const Unit&) { return grid(n, 0, false); }},
      {"tilted grid", [](std::size_t n, const Unit&) { return grid(n, 0.3, false); }},
      {"tilted grid of floats", [](std::size_t n, const Unit&) { return grid(n, 0.3, true); }},
      {"circle",
       [](std::size_t n, const Unit& u) {
         return listed(n, [&](std::size_t) {
           const double a = kTurn * u();
           return DVec2(std::cos(a), std::sin(a));
         });
       }},
      {"20 walls",
       [](std::size_t n, const Unit& u) {
         return listed(n, [&](std::size_t) {
           const double x = std::floor(20 * u()) / 20;
           return DVec2(x, u());
         });
       }},
      {"10 lines",
       [](std::size_t n, const Unit& u) {
         return listed(n, [&](std::size_t) {
           const double k = std::floor(10 * u()), t = u();
           return DVec2(std::sin(k) + t * std::cos(7 * k), std::cos(3 * k) + t * std::sin(5 * k));
         });
       }},
      {"map coordinates",
       [](std::size_t n, const Unit& u) {
         return listed(n, [&](std::size_t) {
           const double x = std::floor(u() * 1e6) / 100;
           return DVec2(500000 + x, 5400000 + std::floor(u() * 1e6) / 100);
         });
       }},
      {"clusters", [](std::size_t n, const Unit& u) {
         return listed(n, [&](std::size_t i) {
           const double scale = std::pow(10.0, -static_cast<double>(i % 8)), x = u();
           return DVec2(scale * x, scale * u());
         });
       }}};
  return all;
}

struct Row {
  std::vector<double> seconds;
  std::size_t bytes = 0, triangles = 0;
};

/// Times work, which returns the number of triangles; the first run is not timed and tells the memory.
Row measured(int repetitions, const std::function<std::size_t()>& work) {
  Row row;
  {
    const MemoryWatch watch;
    row.triangles = work();
    row.bytes = watch.peak();
  }
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    row.seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(row.seconds.begin(), row.seconds.end());
  return row;
}

void print(const char* family, const char* what, std::size_t points, const Row& row,
           const std::string& wrong) {
  std::printf("| %s | %s | %.3f | %.3f-%.3f (%zu) | %.0f | %.0f | %zu | %s |\n", family, what,
              row.seconds[row.seconds.size() / 2], row.seconds.front(), row.seconds.back(),
              row.seconds.size(), 1e9 * row.seconds[row.seconds.size() / 2] / static_cast<double>(points),
              static_cast<double>(row.bytes) / static_cast<double>(points), row.triangles, wrong.c_str());
  std::fflush(stdout);
}

/// Interior edges that are not Delaunay, by the exact predicates.
std::size_t wrong_edges(const DelaunayTriangulation& made, const Points& points) {
  const HalfEdgeMesh& mesh = made.mesh;
  std::size_t wrong = 0;
  const auto at = [&](VertexId v) { return points[made.point_of_vertex[v.index]]; };
  for (std::uint32_t i = 0; i < mesh.half_edge_count(); ++i) {
    const HalfEdgeId h(i), t = mesh.twin(h);
    if (!t.valid() || t < h) continue;
    wrong += in_circle_perturbed(at(mesh.origin(h)), at(mesh.target(h)), at(mesh.origin(mesh.previous(h))),
                                 at(mesh.origin(mesh.previous(t)))) >= 0
                 ? 1
                 : 0;
  }
  return wrong;
}

[[noreturn]] void stop(const Error& error) {
  std::fprintf(stderr, "vkmesh_bench_planar: %s\n", error.describe().c_str());
  std::exit(1);
}

#ifdef VKMESH_BENCH_CGAL
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Numbered = CGAL::Delaunay_triangulation_2<
    Kernel,
    CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>,
                                         CGAL::Triangulation_face_base_with_info_2<std::uint32_t, Kernel>>>;

std::size_t by_cgal(const Points& points) {
  std::vector<Kernel::Point_2> input;
  input.reserve(points.size());
  for (const DVec2 p : points) input.emplace_back(p.x, p.y);
  const CGAL::Delaunay_triangulation_2<Kernel> made(input.begin(), input.end());
  return made.number_of_faces();
}

/// The same with what delaunay() returns: corners, and for each edge the one on its other side.
std::size_t by_cgal_to_arrays(const Points& points) {
  std::vector<std::pair<Kernel::Point_2, std::uint32_t>> input;
  input.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i)
    input.emplace_back(Kernel::Point_2(points[i].x, points[i].y), i);
  Numbered made(input.begin(), input.end());
  std::uint32_t faces = 0;
  for (auto f : made.all_face_handles()) f->info() = made.is_infinite(f) ? kInvalid : faces++;
  std::vector<std::uint32_t> origin, twin;
  origin.reserve(3 * std::size_t{faces});
  twin.reserve(3 * std::size_t{faces});
  for (auto f : made.finite_face_handles())
    for (int i = 0; i < 3; ++i) {
      origin.push_back(f->vertex(i)->info());
      const auto other = f->neighbor(Numbered::cw(i));
      twin.push_back(other->info() == kInvalid
                         ? kInvalid
                         : 3 * other->info() +
                               static_cast<std::uint32_t>(other->index(f->vertex(Numbered::ccw(i)))));
    }
  return origin.size() / 3;
}
#endif

#ifdef VKMESH_BENCH_BOOST
/// It takes whole numbers: 30 bits for each coordinate. Its rays are not clipped.
std::size_t by_boost(const Points& points) {
  const std::vector<DVec2> bounds = bounds_of_sites(points);
  const double scale = 0x1p30 / std::max(bounds[2].x - bounds[0].x, bounds[2].y - bounds[0].y);
  std::vector<boost::polygon::point_data<std::int32_t>> input;
  input.reserve(points.size());
  for (const DVec2 p : points)
    input.emplace_back(static_cast<std::int32_t>(scale * (p.x - bounds[0].x)),
                       static_cast<std::int32_t>(scale * (p.y - bounds[0].y)));
  boost::polygon::voronoi_diagram<double> made;
  boost::polygon::construct_voronoi(input.begin(), input.end(), &made);
  return made.num_cells();
}
#endif

/// Uniform points, the first of which are a closed line like a coast, of which a hundredth are its segments.
struct ConstrainedPoints {
  Points points;
  std::vector<PointPair> outline;
};
ConstrainedPoints constrained_points(std::size_t n) {
  ConstrainedPoints result;
  std::mt19937_64 random(1);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto sides = static_cast<std::uint32_t>(n / 100);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double a = 6.283185307179586 * i / sides, r = 0.4 + 0.05 * std::cos(9 * a) + 0.0001 * unit();
    result.points.emplace_back(0.5 + r * std::cos(a), 0.5 + r * std::sin(a));
    result.outline.push_back({i, (i + 1) % sides});
  }
  while (result.points.size() < n) {
    const double x = unit();
    result.points.emplace_back(x, unit());
  }
  return result;
}

/// Edges that are neither constraints nor Delaunay.
std::size_t wrong_edges(const ConstrainedTriangulation& made) {
  const HalfEdgeMesh& mesh = made.mesh;
  std::vector<bool> kept(mesh.half_edge_count(), false);
  for (const HalfEdgeId h : made.constrained_edges) kept[h.index] = true;
  std::size_t wrong = 0;
  const auto at = [&](VertexId v) { return made.positions[v.index]; };
  mesh.for_each_edge([&](HalfEdgeId h) {
    const HalfEdgeId t = mesh.twin(h);
    if (!t.valid() || kept[h.index]) return;
    wrong += in_circle_perturbed(at(mesh.origin(h)), at(mesh.target(h)), at(mesh.origin(mesh.previous(h))),
                                 at(mesh.origin(mesh.previous(t)))) >= 0
                 ? 1
                 : 0;
  });
  return wrong;
}

#ifdef VKMESH_BENCH_CGAL
using ConstrainedByCgal = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel,
    CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel>,
                                         CGAL::Delaunay_mesh_face_base_2<Kernel>>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;

ConstrainedByCgal constrained_by_cgal(const ConstrainedPoints& input) {
  std::vector<Kernel::Point_2> points;
  points.reserve(input.points.size());
  for (const DVec2 p : input.points) points.emplace_back(p.x, p.y);
  std::vector<std::pair<std::size_t, std::size_t>> segments;
  for (const auto& [a, b] : input.outline) segments.emplace_back(a, b);
  ConstrainedByCgal made;
  made.insert(points.begin(), points.end());
  made.insert_constraints(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(segments.size()),
                          segments.begin(), segments.end());
  return made;
}
#endif

/// A closed line among points, then what it encloses, refined.
void constrained_rows(std::size_t n, int repetitions) {
  const ConstrainedPoints input = constrained_points(n);
  ConstrainedDelaunayOptions options;
  options.outlines = input.outline;
  const std::string family = "uniform, " + std::to_string(input.outline.size()) + " segments";
  std::optional<ConstrainedTriangulation> kept;
  const auto ours = [&] {
    kept.reset();
    auto made = constrained_delaunay(input.points, {}, options);
    if (!made) stop(made.error());
    if (const auto valid = validate(made->mesh); !valid) stop(valid.error());
    kept = std::move(*made);
    return kept->mesh.face_count();
  };
  Row row = measured(repetitions, ours);
  print(family.c_str(), "vkmesh, to validated half-edges", n, row, std::to_string(wrong_edges(*kept)));
#ifdef VKMESH_BENCH_CGAL
  print(family.c_str(), "CGAL, triangulation kept", n,
        measured(repetitions, [&] { return constrained_by_cgal(input).number_of_faces(); }), "");
#endif
  // The bound of CGAL's default criteria.
  options.domain = DelaunayDomain::kEvenOdd;
  options.refinement.emplace().min_angle = std::asin(std::sqrt(0.125));
  row = measured(repetitions, ours);
  const std::string refined = "the same, inside, refined to 20.7 degrees";
  print(
      refined.c_str(),
      ("vkmesh, to validated half-edges (" + std::to_string(kept->refined_points) + " points added)").c_str(),
      n, row, std::to_string(wrong_edges(*kept)));
#ifdef VKMESH_BENCH_CGAL
  std::size_t added = 0;
  row = measured(repetitions, [&] {
    ConstrainedByCgal made = constrained_by_cgal(input);
    const std::size_t before = made.number_of_vertices();
    CGAL::Delaunay_mesher_2<ConstrainedByCgal, CGAL::Delaunay_mesh_criteria_2<ConstrainedByCgal>> mesher(
        made);
    mesher.refine_mesh();
    added = made.number_of_vertices() - before;
    std::size_t inside = 0;
    for (auto f = made.finite_faces_begin(); f != made.finite_faces_end(); ++f)
      inside += f->is_in_domain() ? 1 : 0;
    return inside;
  });
  print(refined.c_str(), ("CGAL, triangulation kept (" + std::to_string(added) + " points added)").c_str(), n,
        row, "");
#endif
}

void all(std::size_t n, int repetitions, const std::string& only, std::size_t threads) {
  const Machine machine = describe_machine();
  std::printf("- %s, %s\n- %s", machine.processor.c_str(), machine.system.c_str(), machine.compiler.c_str());
#ifdef VKMESH_BENCH_CGAL
  std::printf(", CGAL " CGAL_VERSION_STR);
#endif
  std::printf("\n- %zu %s, %zu points in random order\n\n", threads, threads == 1 ? "thread" : "threads", n);
  std::printf(
      "| points | what | median s | min-max (runs) | ns a point | most bytes a point | triangles or cells | "
      "wrong edges |\n"
      "|---|---|---:|---|---:|---:|---:|---:|\n");
  for (const Family& family : families()) {
    if (!only.empty() && only != family.name) continue;
    std::mt19937_64 random(1);
    Points points = family.points(n, [&] { return static_cast<double>(random() >> 11) * 0x1p-53; });
    for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random() % i]);
    std::optional<DelaunayTriangulation> kept;
    const Row ours = measured(repetitions, [&] {
      kept.reset();
      auto made = delaunay(points);
      if (!made) stop(made.error());
      if (const auto valid = validate(made->mesh); !valid) stop(valid.error());
      kept = std::move(*made);
      return kept->mesh.face_count();
    });
    print(family.name, "vkmesh, to validated half-edges", points.size(), ours,
          std::to_string(wrong_edges(*kept, points)));
    kept.reset();
    const Row alone = measured(repetitions, [&] {
      kept.reset();
      kept = std::move(*delaunay(points));
      return kept->mesh.face_count();
    });
    print(family.name, "vkmesh, to half-edges", points.size(), alone, "");
    kept.reset();
#ifdef VKMESH_BENCH_CGAL
    print(family.name, "CGAL, triangulation kept", points.size(),
          measured(repetitions, [&] { return by_cgal(points); }), "");
    print(family.name, "CGAL, to arrays", points.size(),
          measured(repetitions, [&] { return by_cgal_to_arrays(points); }), "");
#endif
    print(family.name, "vkmesh, Voronoi cells in a box", points.size(),
          measured(repetitions,
                   [&] {
                     const auto made = voronoi(points);
                     if (!made) stop(made.error());
                     return made->cell_count();
                   }),
          "");
#ifdef VKMESH_BENCH_BOOST
    print(family.name, "Boost.Polygon, Voronoi diagram", points.size(),
          measured(repetitions, [&] { return by_boost(points); }), "");
#endif
  }
  if (only.empty() || only == "constrained") constrained_rows(n, repetitions);
}

}  // namespace
}  // namespace vkmesh::bench

int main(int count, char** arguments) {
  const auto threads = static_cast<std::size_t>(count > 4 ? std::max(1, std::atoi(arguments[4])) : 1);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const double points = count > 1 ? std::atof(arguments[1]) : 1e6;
  vkmesh::bench::keep_freed_memory();
  vkmesh::bench::all(static_cast<std::size_t>(points), count > 2 ? std::max(1, std::atoi(arguments[2])) : 5,
                     count > 3 ? arguments[3] : "", threads);
}
