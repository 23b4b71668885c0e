// Voronoi diagrams of Boost.Polygon beside those of vkmesh, for sites of whole numbers.
//   boost_voronoi [SITES]    so many sites of each family, default 20000
// Prints one line of totals; every disagreement goes to standard error and fails.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <boost/polygon/voronoi.hpp>

#include <vkmesh/planar/voronoi.h>

namespace {

using vkmesh::DVec2;
using Site = boost::polygon::point_data<std::int32_t>;

std::map<std::string, std::vector<DVec2>> families(std::size_t n) {
  std::map<std::string, std::vector<DVec2>> all;
  std::mt19937_64 random(1);
  const auto whole = [&](std::uint64_t below) { return static_cast<double>(random() % below); };
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(n)));
  const auto make = [&](const char* name, std::size_t count, auto&& point) {
    for (std::size_t i = 0; i < count; ++i) all[name].push_back(point(i));
    std::shuffle(all[name].begin(), all[name].end(), random);
  };
  const auto any = [&](std::uint64_t below) {
    return [&whole, below](std::size_t) {
      const double x = whole(below);
      return DVec2(x, whole(below));
    };
  };
  make("uniform", n, any(100000000));
  make("coarse", n, any(300));
  make("few places", n / 10, any(20));
  make("grid", side * side, [&](std::size_t i) { return DVec2(i % side, i / side); });
  make("hexagons", side * side,
       [&](std::size_t i) { return DVec2(4 * (i % side) + 2 * (i / side % 2), 3 * (i / side)); });
  make("cocircular", 500, [&](std::size_t) {
    constexpr int kLegs[6][2] = {{33, 56}, {16, 63}, {25, 60}, {39, 52}, {0, 65}, {52, 39}};
    const auto& leg = kLegs[random() % 6];
    return DVec2(random() % 2 ? leg[0] : -leg[0], random() % 2 ? leg[1] : -leg[1]);
  });
  make("collinear", 500, [&](std::size_t) {
    const double x = whole(5000);
    return DVec2(x, 3 * x);
  });
  for (std::size_t few = 1; few < 5; ++few) make(("few " + std::to_string(few)).c_str(), few, any(10));
  return all;
}

/// What two diagrams are compared by: which pairs of sites have an edge between them, and the vertices.
struct Diagram {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;  // of sites, the lesser first
  std::vector<DVec2> vertices;                              // in lexicographic order
};

Diagram of_boost(const std::vector<DVec2>& sites) {
  std::vector<Site> input;
  for (const DVec2 p : sites)
    input.emplace_back(static_cast<std::int32_t>(p.x), static_cast<std::int32_t>(p.y));
  boost::polygon::voronoi_diagram<double> made;
  boost::polygon::construct_voronoi(input.begin(), input.end(), &made);
  Diagram result;
  for (const auto& edge : made.edges()) {
    const auto a = static_cast<std::uint32_t>(edge.cell()->source_index()),
               b = static_cast<std::uint32_t>(edge.twin()->cell()->source_index());
    result.edges.emplace(std::min(a, b), std::max(a, b));
  }
  for (const auto& vertex : made.vertices()) result.vertices.emplace_back(vertex.x(), vertex.y());
  return result;
}

/// Within a box that holds all vertices, and that all rays leave.
Diagram of_vkmesh(const vkmesh::VoronoiDiagram& made) {
  Diagram result;
  std::vector<bool> on_box(made.vertices.size(), false);
  for (std::uint32_t i = 0; i < made.cell_count(); ++i)
    for (std::size_t k = 0; k < made.cell(i).size(); ++k) {
      const std::uint32_t other = made.neighbours_of(i)[k];
      if (other != vkmesh::kInvalid) {
        result.edges.emplace(std::min(i, other), std::max(i, other));
        continue;
      }
      on_box[made.cell(i)[k]] = true;
      on_box[made.cell(i)[(k + 1) % made.cell(i).size()]] = true;
    }
  for (std::size_t v = 0; v < made.vertices.size(); ++v)
    if (!on_box[v]) result.vertices.push_back(made.vertices[v]);
  return result;
}

void sort(std::vector<DVec2>& points) {
  std::sort(points.begin(), points.end(),
            [](DVec2 a, DVec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
}

/// Each vertex of one near one of the other.
bool same_vertices(std::vector<DVec2> a, std::vector<DVec2> b) {
  if (a.size() != b.size()) return false;

  sort(a);
  sort(b);
  const auto near = [](DVec2 p, DVec2 q) {
    const double scale = 1 + std::max({std::fabs(p.x), std::fabs(p.y)});
    return std::fabs(p.x - q.x) <= 1e-12 * scale && std::fabs(p.y - q.y) <= 1e-12 * scale;
  };
  for (const auto& [from, to] : {std::pair(&a, &b), {&b, &a}})
    for (const DVec2 p : *from) {
      const double slack = 1e-12 * (1 + std::fabs(p.x) + std::fabs(p.y));
      auto q =
          std::lower_bound(to->begin(), to->end(), p.x - slack, [](DVec2 v, double x) { return v.x < x; });
      while (q != to->end() && q->x <= p.x + slack && !near(p, *q)) ++q;
      if (q == to->end() || !near(p, *q)) return false;
    }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  int bad = 0;
  std::size_t edges = 0, vertices = 0;
  for (const auto& [name, points] : families(count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 20000)) {
    vkmesh::VoronoiOptions options;
    options.clip = {{-1e30, -1e30}, {1e30, -1e30}, {1e30, 1e30}, {-1e30, 1e30}};
    const auto ours = vkmesh::voronoi(points, options);
    if (!ours) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), ours.error().describe().c_str());
      return 1;
    }
    const Diagram mine = of_vkmesh(*ours), theirs = of_boost(ours->sites);
    edges += mine.edges.size();
    vertices += mine.vertices.size();
    if (mine.edges == theirs.edges && same_vertices(mine.vertices, theirs.vertices)) continue;
    ++bad;
    std::fprintf(stderr, "%s: %zu edges and %zu vertices, Boost.Polygon has %zu and %zu\n", name.c_str(),
                 mine.edges.size(), mine.vertices.size(), theirs.edges.size(), theirs.vertices.size());
  }
  std::printf("%zu edges between cells, %zu vertices\n", edges, vertices);
  return bad == 0 ? 0 : 1;
}
