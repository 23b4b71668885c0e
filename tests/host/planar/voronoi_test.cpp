#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/planar/delaunay.h>
#include <vkmesh/planar/voronoi.h>
#include <vkmesh/repair/consolidate.h>

#include "host/planar/random_points.h"
#include "math/circumcentre.h"

using namespace vkmesh;

namespace {

using Points = std::vector<DVec2>;

using Random = test::RandomPoints;

std::map<std::string, Points> families(std::size_t n) {
  std::map<std::string, Points> all;
  Random random(n);
  const auto make = [&](const char* name, auto&& point) {
    for (std::size_t i = 0; i < n; ++i) all[name].push_back(point(i));
    random.shuffle(all[name]);
  };
  const auto unit = [&] { return random.unit(); };
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  const auto grid = [&](std::size_t i, double angle) {
    const auto x = static_cast<double>(i % side), y = static_cast<double>(i / side);
    const double c = std::cos(angle), s = std::sin(angle);
    return DVec2(c * x - s * y, s * x + c * y);
  };
  make("uniform", [&](std::size_t) {
    const double x = unit();
    return DVec2(x, unit());
  });
  make("grid", [&](std::size_t i) { return grid(i, 0); });
  make("tilted grid", [&](std::size_t i) { return grid(i, 0.3); });
  make("tilted grid of floats", [&](std::size_t i) {
    const DVec2 p = grid(i, 0.3);
    return DVec2(static_cast<float>(p.x), static_cast<float>(p.y));
  });
  make("circle", [&](std::size_t) {
    const double a = 6.283185307179586 * unit();
    return DVec2(std::cos(a), std::sin(a));
  });
  make("cocircular", [&](std::size_t) {
    constexpr std::array<double, 6> kOf65 = {0, 16, 25, 33, 39, 52};
    const double x = kOf65[random.below(6)], y = std::sqrt(65.0 * 65 - x * x);
    const double p = random.below(2) == 0 ? x : -x, q = random.below(2) == 0 ? y : -y;
    return random.below(2) == 0 ? DVec2(q, p) : DVec2(p, q);
  });
  make("walls", [&](std::size_t) {
    const double x = random.whole(5) / 5;
    return DVec2(x, unit());
  });
  make("duplicates", [&](std::size_t) { return random.whole_point(6); });
  make("map coordinates",
       [&](std::size_t) { return DVec2(500000, 5400000) + random.whole_point(1000) / 100.0; });
  make("collinear",
       [&](std::size_t i) { return DVec2(static_cast<double>(i), 3.0 * static_cast<double>(i)); });
  make("collinear but one", [&](std::size_t i) {
    return i == 2 ? DVec2(7, 8) : DVec2(static_cast<double>(i), 3.0 * static_cast<double>(i));
  });
  // A last bit off a line: circumcentres are far away.
  make("nearly collinear", [&](std::size_t) {
    const double x = unit();
    return DVec2(x, random.below(2) == 0 ? x : std::nextafter(x, 2));
  });
  make("clusters", [&](std::size_t i) {
    const double scale = std::pow(10.0, -static_cast<double>(i % 12)), x = unit();
    return DVec2(scale * x, scale * unit());
  });
  make("spread", [&](std::size_t) {
    const double x = std::ldexp(unit(), static_cast<int>(random.below(300)) - 150);
    return DVec2(x, std::ldexp(unit(), static_cast<int>(random.below(300)) - 150));
  });
  return all;
}

double area_of(const Points& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const DVec2 a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    sum += a.x * b.y - a.y * b.x;
  }
  return 0.5 * sum;
}

double largest_coordinate(const Points& points) {
  double most = 0;
  for (const DVec2 p : points) most = std::max({most, std::fabs(p.x), std::fabs(p.y)});
  return most;
}

Points polygon_of(const VoronoiDiagram& diagram, std::size_t i) {
  Points polygon;
  for (const std::uint32_t v : diagram.cell(i)) polygon.push_back(diagram.vertices[v]);
  return polygon;
}

/// How far p is to the left of the line from a to b.
double left_of(DVec2 a, DVec2 b, DVec2 p) {
  const DVec2 d = b - a;
  const double length = std::hypot(d.x, d.y);
  return length == 0 ? 0 : (d.x * (p.y - a.y) - d.y * (p.x - a.x)) / length;
}

/// Whether p is to the right of the edge from a to b by more than `slack`; edges that are as short as
/// rounding makes them have no sides.
bool is_right_of(DVec2 a, DVec2 b, DVec2 p, double slack) {
  const DVec2 d = b - a;
  return std::hypot(d.x, d.y) > 1e6 * slack && left_of(a, b, p) < -slack;
}

/// Whether the cells that are not empty are the faces of a manifold, tile the polygon and are convex.
void require_sound(const VoronoiDiagram& diagram, const Points& points, Points clip) {
  if (area_of(clip) < 0) std::ranges::reverse(clip);
  const double slack = 0x1p-47 * largest_coordinate(clip);
  // The maps.
  REQUIRE(diagram.site_of_point.size() == points.size());
  REQUIRE(diagram.cell_offsets.size() == diagram.cell_count() + 1);
  REQUIRE(diagram.neighbours.size() == diagram.corners.size());
  // A manifold with the polygon for its boundary, of which each vertex is used.
  IndexedFaceSet set;
  set.points.resize(diagram.vertices.size());
  set.corners = diagram.corners;
  set.face_offsets = {0};
  std::vector<std::uint32_t> site_of_face;
  for (std::uint32_t i = 0; i < diagram.cell_count(); ++i) {
    if (diagram.cell(i).empty()) continue;
    set.face_offsets.push_back(diagram.cell_offsets[i + 1]);
    site_of_face.push_back(i);
  }
  auto mesh = to_half_edge_mesh(set);
  REQUIRE(mesh);
  REQUIRE(validate(*mesh));
  REQUIRE(mesh->boundary_loops().size() == 1);
  REQUIRE(mesh->vertex_count() + mesh->face_count() == mesh->edge_count() + 1);
  for (std::uint32_t h = 0; h < mesh->half_edge_count(); ++h) {
    const HalfEdgeId twin = mesh->twin(HalfEdgeId(h));
    const std::uint32_t expected = twin.valid() ? site_of_face[mesh->face(twin).index] : kInvalid;
    if (diagram.neighbours[h] != expected) FAIL("the neighbour across half-edge " << h);
    if (twin.valid()) continue;
    const DVec2 at = diagram.vertices[mesh->origin(HalfEdgeId(h)).index];
    double nearest = HUGE_VAL;
    for (std::size_t s = 0; s < clip.size(); ++s)
      nearest = std::min(nearest, std::fabs(left_of(clip[s], clip[(s + 1) % clip.size()], at)));
    if (!(nearest <= slack)) FAIL("a vertex of the boundary is off the polygon");
  }
  // Areas, and corners that turn left.
  double sum = 0;
  for (std::size_t i = 0; i < diagram.cell_count(); ++i) {
    const Points cell = polygon_of(diagram, i);
    if (cell.empty()) continue;
    sum += diagram.area(i);
    for (std::size_t k = 0; k < cell.size(); ++k)
      if (left_of(cell[k], cell[(k + 2) % cell.size()], cell[(k + 1) % cell.size()]) > slack)
        FAIL("cell " << i << " is not convex");
  }
  // Vertices on sides that are not parallel to an axis are a last bit off them.
  double length = 0;
  for (std::size_t s = 0; s < clip.size(); ++s) {
    const DVec2 d = clip[(s + 1) % clip.size()] - clip[s];
    if (d.x != 0 && d.y != 0) length += std::hypot(d.x, d.y);
  }
  CHECK(std::fabs(sum - area_of(clip)) <= 1e-12 * area_of(clip) + slack * length);
}

VoronoiDiagram diagram_of(const Points& points, const Points& clip = {}) {
  VoronoiOptions options;
  options.clip = clip;
  auto made = voronoi(points, options);
  REQUIRE(made);
  require_sound(*made, points, clip.empty() ? bounds_of_sites(points) : clip);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::uint32_t site = made->site_of_point[i];
    if (made->sites[site] != points[i] || made->point_of_site[site] > i) FAIL("point " << i);
  }
  return std::move(*made);
}

/// A polygon whose edges are labelled by who is beyond them, cut by half-planes one after the other.
struct CutCell {
  Points corners;
  std::vector<std::uint32_t> beyond;
};
CutCell cut_cell(const Points& sites, std::uint32_t site, const Points& clip, double slack) {
  CutCell cell{clip, std::vector<std::uint32_t>(clip.size(), kInvalid)};
  if (area_of(clip) < 0) std::ranges::reverse(cell.corners);
  for (std::uint32_t other = 0; other < sites.size(); ++other) {
    if (other == site || cell.corners.empty()) continue;
    const DVec2 to = sites[other] - sites[site], middle = 0.5 * (sites[other] + sites[site]);
    // A side along a bisector stays a side.
    const double least = -slack * std::hypot(to.x, to.y);
    const auto depth = [&](DVec2 p) { return to.x * (middle.x - p.x) + to.y * (middle.y - p.y); };
    CutCell cut;
    for (std::size_t i = 0; i < cell.corners.size(); ++i) {
      const DVec2 a = cell.corners[i], b = cell.corners[(i + 1) % cell.corners.size()];
      const double at_a = depth(a), at_b = depth(b);
      if (at_a >= least) {
        cut.corners.push_back(a);
        cut.beyond.push_back(cell.beyond[i]);
      }
      if ((at_a >= least) == (at_b >= least)) continue;
      cut.corners.push_back(a + (b - a) * (at_a / (at_a - at_b)));
      cut.beyond.push_back(at_a >= least ? other : cell.beyond[i]);
    }
    cell = std::move(cut);
  }
  return cell;
}

/// Cells and neighbours beside those of cut_cell(); edges and areas below `small` do not count.
void require_same_as_cut(const VoronoiDiagram& diagram, const Points& clip, double small) {
  for (std::uint32_t i = 0; i < diagram.cell_count(); ++i) {
    const CutCell cut = cut_cell(diagram.sites, i, clip, 1e-6 * small);
    const double area = cut.corners.empty() ? 0 : area_of(cut.corners);
    INFO("cell " << i);
    if (std::fabs(diagram.area(i) - area) > small * largest_coordinate(clip))
      FAIL("area " << diagram.area(i) << ", not " << area);
    if (area <= small * largest_coordinate(clip)) {
      // What touches the polygon alone has no cell.
      if (diagram.area(i) == 0 && !diagram.cell(i).empty()) FAIL("a cell without area");
      continue;
    }
    const auto long_edges = [&](const Points& corners, auto&& beyond) {
      std::set<std::uint32_t> all;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const DVec2 d = corners[(k + 1) % corners.size()] - corners[k];
        if (std::hypot(d.x, d.y) > small) all.insert(beyond[k]);
      }
      return all;
    };
    if (long_edges(polygon_of(diagram, i), diagram.neighbours_of(i)) != long_edges(cut.corners, cut.beyond))
      FAIL("neighbours");
  }
}

bool same(const VoronoiDiagram& a, const VoronoiDiagram& b) {
  return a.sites == b.sites && a.vertices == b.vertices && a.cell_offsets == b.cell_offsets &&
         a.corners == b.corners && a.neighbours == b.neighbours;
}

Points box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// Corners of a convex polygon of whole coordinates, by gift wrapping.
Points convex_polygon(Random& random, std::size_t range) {
  Points cloud;
  while (true) {
    for (int i = 0; i < 6; ++i) cloud.push_back(random.whole_point(range));
    Points hull = {*std::ranges::min_element(
        cloud, [](DVec2 a, DVec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; })};
    do {
      DVec2 next = hull.back();
      for (const DVec2 p : cloud) {
        const int side = next == hull.back() ? -1 : orientation(hull.back(), next, p);
        const DVec2 d = p - hull.back(), e = next - hull.back();
        if (p != hull.back() && (side < 0 || (side == 0 && d.x * d.x + d.y * d.y > e.x * e.x + e.y * e.y)))
          next = p;
      }
      if (next == hull.back()) break;
      hull.push_back(next);
    } while (hull.back() != hull.front() && hull.size() <= cloud.size());
    if (hull.size() > 1) hull.pop_back();
    if (hull.size() >= 3) return hull;
  }
}

/// The integral of the squared distance to the site, over all cells.
double energy_of(const VoronoiDiagram& diagram) {
  double sum = 0;
  for (std::size_t i = 0; i < diagram.cell_count(); ++i) {
    const Points cell = polygon_of(diagram, i);
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const DVec2 a = cell[k] - diagram.sites[i], b = cell[(k + 1) % cell.size()] - diagram.sites[i];
      const double area = 0.5 * (a.x * b.y - a.y * b.x);
      sum += area * (a.x * a.x + a.y * a.y + b.x * b.x + b.y * b.y + a.x * b.x + a.y * b.y) / 6;
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("Voronoi cells tile the box", "[voronoi]") {
  for (const std::size_t n : {3u, 4u, 40u, 1500u})
    for (const auto& [name, points] : families(n)) {
      INFO(name << ", " << n);
      const VoronoiDiagram diagram = diagram_of(points);
      // Each site is in its cell.
      for (std::size_t i = 0; i < diagram.cell_count(); ++i) {
        const Points cell = polygon_of(diagram, i);
        REQUIRE(cell.size() >= 3);
        for (std::size_t k = 0; k < cell.size(); ++k)
          if (is_right_of(cell[k], cell[(k + 1) % cell.size()], diagram.sites[i],
                          0x1p-47 * largest_coordinate(cell)))
            FAIL("site " << i << " is outside its cell");
      }
    }
}

TEST_CASE("Points lie in the cell of their nearest site", "[voronoi]") {
  Random random(3);
  for (const auto& [name, points] : families(300)) {
    if (name == "spread" || name == "clusters") continue;  // cells are too small to be hit
    INFO(name);
    const VoronoiDiagram diagram = diagram_of(points);
    const Points bounds = bounds_of_sites(points);
    for (int i = 0; i < 1000; ++i) {
      const double x = random.unit();
      const DVec2 p = bounds[0] + DVec2(x, random.unit()) * (bounds[2] - bounds[0]);
      std::size_t nearest = 0;
      const auto distance = [&](std::size_t site) {
        return std::hypot(p.x - diagram.sites[site].x, p.y - diagram.sites[site].y);
      };
      for (std::size_t site = 1; site < diagram.cell_count(); ++site)
        if (distance(site) < distance(nearest)) nearest = site;
      const Points cell = polygon_of(diagram, nearest);
      for (std::size_t k = 0; k < cell.size(); ++k)
        if (is_right_of(cell[k], cell[(k + 1) % cell.size()], p, 1e-11 * largest_coordinate(bounds)))
          FAIL("sample " << i);
    }
  }
}

TEST_CASE("Voronoi cells are those cut out by half-planes", "[voronoi]") {
  for (const std::size_t n : {5u, 40u})
    for (const auto& [name, points] : families(n)) {
      if (name == "spread" || name == "nearly collinear" || name == "clusters") continue;  // cuts are rounded
      INFO(name << ", " << n);
      const Points clip = bounds_of_sites(points);
      const VoronoiDiagram diagram = diagram_of(points);
      require_same_as_cut(diagram, clip, 1e-7 * largest_coordinate(clip));
    }
}

TEST_CASE("Neighbours are joined by Delaunay edges", "[voronoi]") {
  for (const auto& [name, points] : families(300)) {
    INFO(name);
    const VoronoiDiagram diagram = diagram_of(points);
    const auto dual = delaunay(points);
    REQUIRE(dual);
    CHECK(dual->vertex_of_point == diagram.site_of_point);
    if (dual->mesh.face_count() == 0) continue;
    for (std::uint32_t i = 0; i < diagram.cell_count(); ++i)
      for (const std::uint32_t k : diagram.neighbours_of(i))
        if (k != kInvalid && !dual->mesh.find_half_edge(VertexId(i), VertexId(k)).valid() &&
            !dual->mesh.find_half_edge(VertexId(k), VertexId(i)).valid())
          FAIL(i << " and " << k);
  }
}

TEST_CASE("Vertices on the sides and in the corners of the polygon are found exactly", "[voronoi]") {
  Random random(11);
  for (int i = 0; i < 4000; ++i) {
    INFO("set " << i);
    Points points;
    const std::size_t range = i % 2 == 0 ? 5 : 9;
    for (std::size_t n = 1 + random.below(9); n > 0; --n) points.push_back(random.whole_point(range));
    Points clip;
    if (i % 3 != 0) {
      clip = convex_polygon(random, range);
    } else {
      const DVec2 low = random.whole_point(range);
      clip = box(low.x, low.y, low.x + 1 + random.whole(range), low.y + 1 + random.whole(range));
    }
    // Sides and corners on and beside the lattice on which bisectors lie.
    if (i % 4 == 0)
      for (DVec2& p : clip) p *= 0.5;
    const VoronoiDiagram diagram = diagram_of(points, clip);
    require_same_as_cut(diagram, clip, 1e-7);
    for (std::size_t cell = 0; cell < diagram.cell_count(); ++cell) {
      const Points corners = polygon_of(diagram, cell);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const DVec2 edge = corners[(k + 1) % corners.size()] - corners[k];
        if (std::hypot(edge.x, edge.y) < 1e-7) FAIL("what is one vertex is two");
      }
    }
  }
}

TEST_CASE("Bisectors along sides, and vertices in corners", "[voronoi]") {
  const Points four = {{0, 0}, {2, 0}, {0, 2}, {2, 2}};
  const auto sizes = [](const VoronoiDiagram& diagram) {
    std::map<std::pair<double, double>, std::size_t> all;
    for (std::size_t i = 0; i < diagram.cell_count(); ++i)
      all[{diagram.sites[i].x, diagram.sites[i].y}] = diagram.cell(i).size();
    return all;
  };
  using Sizes = std::map<std::pair<double, double>, std::size_t>;
  const VoronoiDiagram whole = diagram_of(four, box(-1, -1, 3, 3));
  CHECK(sizes(whole) == Sizes{{{0, 0}, 4}, {{2, 0}, 4}, {{0, 2}, 4}, {{2, 2}, 4}});
  CHECK(whole.vertices.size() == 9);  // the four circumcentres are one
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(whole.area(i) == 4);
    CHECK(whole.centroid(i) == whole.sites[i]);
    CHECK(std::ranges::count(whole.neighbours_of(i), kInvalid) == 2);  // none across the vertex
  }
  const VoronoiDiagram corner = diagram_of(four, box(1, 1, 5, 5));
  CHECK(sizes(corner) == Sizes{{{0, 0}, 0}, {{2, 0}, 0}, {{0, 2}, 0}, {{2, 2}, 4}});
  CHECK(corner.vertices.size() == 4);
  const VoronoiDiagram side = diagram_of(four, box(1, -1, 3, 3));
  CHECK(sizes(side) == Sizes{{{0, 0}, 0}, {{2, 0}, 4}, {{0, 2}, 0}, {{2, 2}, 4}});
  CHECK(side.vertices.size() == 6);  // the one at (1, 1) is on the side
  const VoronoiDiagram diagonal = diagram_of({{0, 0}, {1, 1}}, box(0, 0, 1, 1));
  CHECK(sizes(diagonal) == Sizes{{{0, 0}, 3}, {{1, 1}, 3}});
  CHECK(diagonal.vertices.size() == 4);
  // A cell between two others that touches the side at its tip alone.
  const VoronoiDiagram tip = diagram_of({{-2, 0}, {2, 0}, {0, 2}}, box(-1, 0, 1, 4));
  CHECK(sizes(tip) == Sizes{{{-2, 0}, 3}, {{2, 0}, 3}, {{0, 2}, 5}});
}

TEST_CASE("Sites on one line have strips, and a single one all", "[voronoi]") {
  const VoronoiDiagram single = diagram_of({{3, 4}});
  CHECK(single.vertices == box(2, 3, 4, 5));
  CHECK(single.cell(0).size() == 4);
  CHECK(std::ranges::count(single.neighbours, kInvalid) == 4);
  CHECK(diagram_of({{3, 4}, {3, 4}, {3, 4}}).cell_count() == 1);
  CHECK(diagram_of({{3000, 4}}).vertices == box(2700, -296, 3300, 304));
  const Points line = {{2, 2}, {0, 0}, {4, 4}, {1, 1}, {0, 0}};
  const VoronoiDiagram strips = diagram_of(line, box(-10, -10, 10, 10));
  CHECK(strips.cell_count() == 4);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto neighbours = strips.neighbours_of(strips.site_of_point[i]);
    const bool last = line[i].x == 0 || line[i].x == 4;
    CHECK(std::ranges::count_if(neighbours, [](std::uint32_t k) { return k != kInvalid; }) == (last ? 1 : 2));
  }
  // Where the box is between two of them, one has all, and the others nothing.
  const VoronoiDiagram one = diagram_of({{0, 0}, {10, 0}, {20, 0}}, box(7, -1, 9, 1));
  CHECK(one.area(one.site_of_point[1]) == 4);
  CHECK(one.cell(one.site_of_point[0]).empty());
}

TEST_CASE("No sites have no cells", "[voronoi]") {
  const auto none = voronoi({});
  REQUIRE(none);
  CHECK(none->cell_count() == 0);
  CHECK(none->cell_offsets.size() == 1);
  CHECK(bounds_of_sites({}).empty());
  VoronoiOptions options;
  options.clip = box(0, 0, 1, 1);
  const auto clipped = voronoi({}, options);
  REQUIRE(clipped);
  CHECK(clipped->cell_count() == 0);
}

TEST_CASE("Sites outside the polygon", "[voronoi]") {
  for (const auto& [name, points] : families(150)) {
    if (name == "spread") continue;
    INFO(name);
    const Points bounds = bounds_of_sites(points);
    const DVec2 middle = 0.5 * (bounds[0] + bounds[2]), size = bounds[2] - bounds[0];
    for (const double part : {0.3, 1e-3})
      for (const DVec2 at : {middle, bounds[0], bounds[0] - 3.0 * size, bounds[1] + 0.1 * size}) {
        const DVec2 low = at - 0.5 * part * size, high = at + 0.5 * part * size;
        const Points clip = {{low.x, 0.5 * (low.y + high.y)},
                             {at.x, low.y},
                             {high.x, low.y},
                             high,
                             {low.x + 0.1 * (high.x - low.x), high.y}};
        diagram_of(points, clip);
        if (name != "nearly collinear" && name != "clusters" && name != "collinear but one")
          require_same_as_cut(diagram_of(points, box(low.x, low.y, high.x, high.y)),
                              box(low.x, low.y, high.x, high.y), 1e-7 * largest_coordinate(bounds));
      }
  }
}

TEST_CASE("Voronoi diagrams of the largest and the least coordinates", "[voronoi]") {
  Random random(2);
  constexpr double kMost = std::numeric_limits<double>::max();
  for (const double unit : {0x1p996, 0x1p500, 0x1p-1074, 0x1p-700}) {
    Points points;
    for (int i = 0; i < 60; ++i) points.push_back(random.whole_point(20) * unit);
    const auto made = voronoi(points);
    REQUIRE(made);
    // The same as that of whole numbers but for the rounding of vertices.
    Points wholes = points;
    for (DVec2& p : wholes) p /= unit;
    VoronoiOptions options;
    options.clip = bounds_of_sites(points);
    for (DVec2& p : options.clip) p /= unit;
    const VoronoiDiagram expected = diagram_of(wholes, options.clip);
    REQUIRE(made->cell_count() == expected.cell_count());
    REQUIRE(made->vertices.size() == expected.vertices.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      // Sites may have other numbers.
      const std::uint32_t i = made->site_of_point[k], j = expected.site_of_point[k];
      const auto points_beyond = [&](const VoronoiDiagram& of, std::uint32_t cell) {
        std::multiset<std::uint32_t> beyond;
        for (const std::uint32_t n : of.neighbours_of(cell))
          beyond.insert(n == kInvalid ? kInvalid : of.point_of_site[n]);
        return beyond;
      };
      if (points_beyond(*made, i) != points_beyond(expected, j)) FAIL("the neighbours of point " << k);
      for (const DVec2 p : polygon_of(*made, i))
        if (!std::ranges::any_of(polygon_of(expected, j), [&](DVec2 q) {
              return std::fabs(p.x / unit - q.x) <= 1 && std::fabs(p.y / unit - q.y) <= 1;
            }))
          FAIL("a vertex of the cell of point " << k);
    }
  }
  const auto largest = voronoi(Points{{-kMost, -kMost}, {kMost, -kMost}, {kMost, kMost}, {-kMost, kMost}});
  REQUIRE(largest);
  CHECK(largest->corners.size() == 16);
}

TEST_CASE("A Voronoi diagram is a function of the set of points", "[voronoi]") {
  Random random(17);
  for (const auto& [name, points] : families(700)) {
    INFO(name);
    const Points clip = bounds_of_sites(points);
    const VoronoiDiagram diagram = diagram_of(points);
    Points other = points;
    random.shuffle(other);
    CHECK(same(diagram, diagram_of(other)));
    // A polygon has no first corner and no direction.
    Points turned = {clip[2], clip[1], 0.5 * (clip[0] + clip[1]), clip[0], clip[3], clip[3]};
    CHECK(same(diagram, diagram_of(points, turned)));
    if (name == "spread") continue;
    for (const int exponent : {-60, 60}) {
      other = points;
      for (DVec2& p : other) p *= std::ldexp(1.0, exponent);
      const VoronoiDiagram scaled = diagram_of(other);
      CHECK(scaled.corners == diagram.corners);
      CHECK(scaled.neighbours == diagram.neighbours);
      for (std::size_t v = 0; v < diagram.vertices.size(); ++v)
        if (scaled.vertices[v] != diagram.vertices[v] * std::ldexp(1.0, exponent)) FAIL("vertex " << v);
    }
  }
}

TEST_CASE("Lloyd's relaxation lowers the energy, and ends at the same sites", "[voronoi]") {
  Random random(6);
  for (const char* name : {"uniform", "walls", "collinear", "circle"}) {
    INFO(name);
    Points points = families(200)[name];
    VoronoiOptions options;
    options.clip = bounds_of_sites(points);
    double last = HUGE_VAL;
    std::vector<VoronoiDiagram> all;
    for (const unsigned iterations : {0u, 1u, 2u, 5u, 20u}) {
      options.lloyd_iterations = iterations;
      auto made = voronoi(points, options);
      REQUIRE(made);
      require_sound(*made, points, options.clip);
      const double energy = energy_of(*made);
      CHECK(energy < last);
      last = energy;
      if (iterations > 0) {
        // The first of the points at each site.
        for (std::uint32_t i = 0; i < points.size(); ++i)
          CHECK(made->point_of_site[made->site_of_point[i]] == i);
      }
      all.push_back(std::move(*made));
    }
    // One iteration by hand.
    Points moved;
    for (std::size_t i = 0; i < all[0].cell_count(); ++i) moved.push_back(all[0].centroid(i));
    options.lloyd_iterations = 0;
    CHECK(same(*voronoi(moved, options), all[1]));
    random.shuffle(points);
    options.lloyd_iterations = 20;
    CHECK(same(*voronoi(points, options), all.back()));
  }
}

TEST_CASE("Polygons that Voronoi cells cannot be clipped to are refused", "[voronoi]") {
  const auto refused = [](const Points& clip) {
    VoronoiOptions options;
    options.clip = clip;
    const auto made = voronoi(Points{{0, 0}, {1, 0}, {0, 1}}, options);
    REQUIRE(!made);
    CHECK(made.error().code == ErrorCode::kUnsuitable);
    return made.error().message;
  };
  const std::string not_convex = "the polygon to clip to is not convex",
                    no_area = "the polygon to clip to has no area";
  CHECK(refused({{0, 0}, {4, 0}, {1, 1}, {0, 4}}) == not_convex);
  CHECK(refused({{0, 0}, {1, 1}, {1, 0}, {0, 1}}) == not_convex);
  CHECK(refused({{0, 0}, {2, 0}, {1, 0}, {0, 1}}) == not_convex);
  // A star turns left everywhere, and so does a square that is gone around twice.
  CHECK(refused({{0, 3}, {-2, -3}, {3, 1}, {-3, 1}, {2, -3}}) == not_convex);
  CHECK(refused({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}}) == not_convex);
  CHECK(refused({{0, 0}}) == no_area);
  CHECK(refused({{0, 0}, {1, 1}}) == no_area);
  CHECK(refused({{0, 0}, {1, 1}, {3, 3}, {2, 2}}) == no_area);
  CHECK(refused({{0, 0}, {1, 0}, {NAN, 1}}) == "corner 2 of the polygon to clip to is not finite");
  Points points(10, DVec2(0, 0));
  points[7].y = HUGE_VAL;
  const auto made = voronoi(points);
  REQUIRE(!made);
  CHECK(made.error().message == "point 7 is not finite");
}

TEST_CASE("A Voronoi diagram hears that it is not wanted", "[voronoi]") {
  const Points points = families(3000)["uniform"];
  VoronoiOptions options;
  options.lloyd_iterations = 2;
  std::size_t calls = 0;
  double last = 0;
  REQUIRE(voronoi(points, options, [&](double fraction) {
    CHECK((fraction >= last && fraction <= 1));
    last = fraction;
    ++calls;
    return true;
  }));
  REQUIRE(calls >= 3);
  for (std::size_t at = 1; at <= calls; ++at) {
    std::size_t count = 0;
    const auto made = voronoi(points, options, [&](double) { return ++count < at; });
    REQUIRE(!made);
    CHECK(made.error().code == ErrorCode::kInterrupted);
  }
}

TEST_CASE("Circumcentres are rounded within their bounds, and last bits decide exactly", "[voronoi]") {
  Random random(8);
  for (int i = 0; i < 5000; ++i) {
    std::array<DVec2, 3> p;
    for (DVec2& q : p) q = random.whole_point(i % 2 == 0 ? 50 : 100000);
    if (i % 3 == 0) p[2] = p[0] + (p[1] - p[0]) * 3.0 + DVec2(0, i % 2);  // needles
    if (orientation(p[0], p[1], p[2]) == 0) continue;
    if (orientation(p[0], p[1], p[2]) < 0) std::swap(p[0], p[1]);
    // The textbook's fraction, in whole numbers.
    const auto x = [&](std::size_t k) { return static_cast<std::int64_t>(p[k].x - p[0].x); };
    const auto y = [&](std::size_t k) { return static_cast<std::int64_t>(p[k].y - p[0].y); };
    const auto square = [&](std::size_t k) { return x(k) * x(k) + y(k) * y(k); };
    const std::int64_t area = 2 * (x(1) * y(2) - y(1) * x(2));
    const long double cx = static_cast<long double>(y(2) * square(1) - y(1) * square(2)) /
                               static_cast<long double>(area) +
                           static_cast<long double>(p[0].x),
                      cy = static_cast<long double>(x(1) * square(2) - x(2) * square(1)) /
                               static_cast<long double>(area) +
                           static_cast<long double>(p[0].y);
    const DVec2 exact = detail::exact_circumcentre(p[0], p[1], p[2]);
    const auto differ = [&](DVec2 c) {
      return static_cast<double>(std::max(std::fabs(c.x - cx), std::fabs(c.y - cy)));
    };
    if (differ(exact) > 0x1p-52 * std::max(std::fabs(exact.x), std::fabs(exact.y))) FAIL("exact " << i);
    const detail::RoundedCircumcentre rounded = detail::rounded_circumcentre(p[0], p[1], p[2]);
    if (std::isfinite(rounded.error) &&
        differ(rounded.place) > rounded.error + 0x1p-60 * std::max(std::fabs(exact.x), std::fabs(exact.y)))
      FAIL("rounded " << i);
  }
  // The circumcentre (1/2, 1/2), and lines past it by a last bit.
  const DVec2 a(0, 0), b(1, 0), c(0, 1);
  CHECK(detail::exact_circumcentre(a, b, c) == DVec2(0.5, 0.5));
  CHECK(detail::exact_circumcentre_side(a, b, c, {0, 0}, {3, 3}) == 0);
  CHECK(detail::exact_circumcentre_side(a, b, c, {0, 0}, {3, std::nextafter(3, 4)}) == -1);
  CHECK(detail::exact_circumcentre_side(a, b, c, {0, 0}, {std::nextafter(3, 4), 3}) == 1);
  CHECK(detail::exact_bisector_side(a, b, {0.5, 7}) == 0);
  CHECK(detail::exact_bisector_side(a, b, {std::nextafter(0.5, 1), 7}) == 1);
  CHECK(detail::exact_bisector_side(a, b, {std::nextafter(0.5, 0), 7e300}) == -1);
  CHECK(detail::exact_bisector_crossing(a, b, {0, 5}, {2, 5}) == 0.25);
  CHECK(detail::sign_of_product(a, b, {1, 1}, {1, 9}) == 0);
}
