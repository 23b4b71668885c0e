// Quadrics and collapse costs against sums over planes in double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <catch2/catch.hpp>

#include <vkmesh/passes/collapse_costs.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::cross;
using test::dot;
using test::length;

namespace {

constexpr CollapsePlacement kPlacements[] = {CollapsePlacement::kOptimal, CollapsePlacement::kMidpoint,
                                             CollapsePlacement::kEndpoint};
constexpr float kLargest = std::numeric_limits<float>::max();

// A weighted plane through a vertex.
struct Plane {
  DVec3 normal;
  double weight;
};

// A mesh's quadrics, by vertex, in scaled units.
struct Textbook {
  std::vector<DVec3> points;
  std::vector<std::vector<Plane>> planes;
  std::vector<double> weight;  // That of all planes of a vertex together.

  // The planes of p through its place, those of q through theirs.
  [[nodiscard]] double cost(std::uint32_t p, std::uint32_t q, DVec3 x) const {
    double sum = 0;
    for (const std::uint32_t v : {p, q})
      for (const Plane& plane : planes[v])
        sum += plane.weight * std::pow(dot(plane.normal, x - points[v]), 2);
    return sum;
  }
};

Textbook textbook(const IndexedFaceSet& set, const HalfEdgeMesh& mesh, const CollapseCostOptions& options) {
  Textbook book;
  for (const Vec3& p : set.points)
    book.points.push_back((DVec3(p) - DVec3(options.centre)) * double{options.scale});
  book.planes.resize(set.points.size());
  book.weight.resize(set.points.size(), 0.0);
  const auto add = [&](VertexId v, DVec3 normal, double weight) {
    book.planes[v.index].push_back({normal / length(normal), weight});
    book.weight[v.index] += weight;
  };
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    const auto [a, b] = mesh.vertices_of_edge(HalfEdgeId(h));
    const VertexId c = mesh.origin(mesh.previous(HalfEdgeId(h)));
    const DVec3 along = book.points[b.index] - book.points[a.index];
    const DVec3 area = cross(along, book.points[c.index] - book.points[a.index]);
    add(a, area, length(area) / 2);
    if (!mesh.is_boundary(HalfEdgeId(h))) continue;
    for (const VertexId v : {a, b})
      add(v, cross(along, area), double{options.boundary_weight} * dot(along, along));
  }
  return book;
}

// The least cost of all places, from the normal equations; and whether they are far from singular.
struct Least {
  double cost = 0, away = 0;  // How far from the middle of the edge.
  bool well_conditioned = false;
};

Least least(const Textbook& book, std::uint32_t p, std::uint32_t q) {
  const DVec3 middle = 0.5 * (book.points[p] + book.points[q]);
  double m[3][4] = {};  // Rows of A | −g.
  for (const std::uint32_t v : {p, q})
    for (const Plane& plane : book.planes[v])
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) m[i][j] += plane.weight * plane.normal[i] * plane.normal[j];
        m[i][3] -= plane.weight * plane.normal[i] * dot(plane.normal, middle - book.points[v]);
      }
  const double trace = m[0][0] + m[1][1] + m[2][2];
  for (int i = 0; i < 3; ++i) m[i][i] += 1e-10 * trace;
  double determinant = 1;
  for (int i = 0; i < 3; ++i) {
    int pivot = i;
    for (int r = i + 1; r < 3; ++r)
      if (std::fabs(m[r][i]) > std::fabs(m[pivot][i])) pivot = r;
    if (pivot != i) {
      std::swap(m[i], m[pivot]);
      determinant = -determinant;
    }
    determinant *= m[i][i];
    for (int r = i + 1; r < 3; ++r)
      for (int c = 3; c >= i; --c) m[r][c] -= m[r][i] / m[i][i] * m[i][c];
  }
  DVec3 s(0.0);
  for (int i = 2; i >= 0; --i) {
    s[i] = m[i][3];
    for (int c = i + 1; c < 3; ++c) s[i] -= m[i][c] * s[c];
    s[i] /= m[i][i];
  }
  // The two larger eigenvalues multiply to a quarter of the squared trace at most, so the smallest one is at
  // least 2^-10 of the trace.
  return {book.cost(p, q, middle + s), length(s), determinant > 0x1p-12 * trace * trace * trace};
}

std::vector<IndexedFaceSet> noisy_shapes() {
  std::vector<IndexedFaceSet> shapes = {test::icosphere(3),    test::torus(30, 16), test::grid(12, 9),
                                        test::cylinder(6, 12), test::fine_cube(6),  test::cube()};
  for (std::size_t i = 0; i < shapes.size(); ++i)
    test::jitter(shapes[i], 0.02f, static_cast<std::uint32_t>(i));
  return shapes;
}

struct Result3 {
  HalfEdgeMesh mesh;
  std::vector<VertexQuadric> quadrics;
  std::vector<float> costs;
};
Result3 costs_of(const IndexedFaceSet& set, const CollapseCostOptions& options) {
  Result3 result{test::half_edges(set), {}, {}};
  result.quadrics = vertex_quadrics(result.mesh, set.points, options).value();
  result.costs = collapse_costs(result.mesh, set.points, result.quadrics, options).value();
  return result;
}

}  // namespace

TEST_CASE("quadrics are the planes of the triangles by area, and of boundary edges by weight") {
  for (const IndexedFaceSet& set : noisy_shapes())
    for (const float boundary_weight : {100.0f, 0.0f, 3.0f}) {
      const HalfEdgeMesh mesh = test::half_edges(set);
      CollapseCostOptions options = unit_frame(set.points);
      options.boundary_weight = boundary_weight;
      const Textbook book = textbook(set, mesh, options);
      const auto found = vertex_quadrics(mesh, set.points, options).value();
      REQUIRE(found.size() == set.points.size());
      for (std::size_t v = 0; v < found.size(); ++v) {
        std::array<double, 6> expected{};
        for (const Plane& plane : book.planes[v]) {
          const DVec3 n = plane.normal;
          const double products[] = {n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z};
          for (std::size_t k = 0; k < 6; ++k) expected[k] += plane.weight * products[k];
        }
        // Each normal is good to 16 · 2^-21 (see the test of normals) and stands there twice, areas and
        // squared lengths to as much; adding rounds less.
        const double tolerance = 64 * 0x1p-21 * book.weight[v];
        for (std::size_t k = 0; k < 6; ++k) CHECK(std::fabs(double{found[v][k]} - expected[k]) < tolerance);
      }
    }
}

TEST_CASE("collapse costs agree with double precision; the best place is the least squares' one") {
  std::size_t determined = 0, all = 0;
  for (const IndexedFaceSet& set : noisy_shapes())
    for (const CollapsePlacement placement : kPlacements) {
      CollapseCostOptions options = unit_frame(set.points);
      options.placement = placement;
      const Result3 found = costs_of(set, options);
      const HalfEdgeMesh& mesh = found.mesh;
      const Textbook book = textbook(set, mesh, options);
      mesh.for_each_edge([&](HalfEdgeId h) {
        const std::uint32_t p = mesh.origin(h).index, q = mesh.target(h).index;
        const DVec3 at_p = book.points[p], at_q = book.points[q];
        const double cost = found.costs[h.index], size = length(at_q - at_p),
                     weight = book.weight[p] + book.weight[q];
        const double middle = book.cost(p, q, 0.5 * (at_p + at_q));
        // Quadrics as above, times squared distances: 1 edge at most, or 2.5 at the best place. Coordinates
        // below 2 are rounded to 2^-23, a share of such a distance.
        const double farthest = placement == CollapsePlacement::kOptimal ? 2.5 * size : size;
        const double tolerance = weight * farthest * (farthest * 3 * 64 * 0x1p-21 + 4 * 0x1p-23);
        INFO("edge " << p << " " << q << " of " << size << ", weight " << weight);
        if (placement == CollapsePlacement::kMidpoint) {
          CHECK(std::fabs(cost - middle) < tolerance);
        } else if (placement == CollapsePlacement::kEndpoint) {
          CHECK(std::fabs(cost - std::min(book.cost(p, q, at_p), book.cost(p, q, at_q))) < tolerance);
        } else {
          const Least best = least(book, p, q);
          CHECK(cost > best.cost - tolerance);
          CHECK(cost < middle + tolerance);
          ++all;
          if (!best.well_conditioned || best.away > 1.9 * size) return;
          ++determined;
          CHECK(cost < best.cost + tolerance);
        }
      });
    }
  INFO(determined << " of " << all << " edges determine a place");
  CHECK(4 * determined > all);
}

TEST_CASE("collapse costs of a cube are those worked out by hand") {
  const IndexedFaceSet set = test::cube();
  for (const CollapsePlacement placement : kPlacements) {
    const Result3 found = costs_of(set, {.placement = placement});
    // The sides through a vertex count: half a unit of area for each triangle of theirs that it is a corner
    // of.
    const auto weight = [&](std::uint32_t v, int axis) {
      int triangles = 0;
      for (std::size_t f = 0; f < set.face_count(); ++f) {
        const auto c = set.face(f);
        if (std::find(c.begin(), c.end(), v) == c.end()) continue;
        triangles += set.points[c[0]][axis] == set.points[c[1]][axis] &&
                     set.points[c[1]][axis] == set.points[c[2]][axis];
      }
      return 0.5 * triangles;
    };
    for (std::uint32_t v = 0; v < 8; ++v)
      for (int axis = 0; axis < 3; ++axis)
        CHECK(found.quadrics[v][std::array<std::size_t, 3>{0, 3, 5}[static_cast<std::size_t>(axis)]] ==
              Approx(weight(v, axis)).epsilon(1e-6));
    found.mesh.for_each_edge([&](HalfEdgeId h) {
      const std::uint32_t p = found.mesh.origin(h).index, q = found.mesh.target(h).index;
      // Where the ends differ, p keeps to its side, q to the opposite one, 1 apart.
      double optimal = 0, middle = 0, at_p = 0, at_q = 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (set.points[p][axis] == set.points[q][axis]) continue;
        const double a = weight(p, axis), b = weight(q, axis);
        optimal += a * b / (a + b);
        middle += (a + b) / 4;
        at_p += b;
        at_q += a;
      }
      const double expected = placement == CollapsePlacement::kOptimal    ? optimal
                              : placement == CollapsePlacement::kMidpoint ? middle
                                                                          : std::min(at_p, at_q);
      CHECK(double{found.costs[h.index]} == Approx(expected).epsilon(1e-5));
    });
  }
}

TEST_CASE("collapse costs of two planes: where they meet, unless that is far away") {
  IndexedFaceSet set;
  set.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  set.corners = {0, 1, 2};
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto cost = [&](const VertexQuadric& p, const VertexQuadric& q) {
    return double{collapse_costs(mesh, set.points, std::vector<VertexQuadric>{p, q, {}}).value()[0]};
  };
  // y = slope · x through the vertex.
  const auto sloping = [](float slope) {
    const float norm = 1 + slope * slope;
    return VertexQuadric{slope * slope / norm, -slope / norm, 0, 1 / norm, 0, 0};
  };
  // At x = 1/2; at x = -4, which is 4.5 edges from the middle of the edge, so that it is the middle that
  // counts.
  CHECK(cost(sloping(0.25f), sloping(-0.25f)) < 1e-6);
  CHECK(cost(sloping(0.1f), sloping(0.08f)) == Approx(0.0025 / 1.01 + 0.0016 / 1.0064).epsilon(1e-4));
  // Beside a plane of 2^20 times the weight, which both have in common, other directions still count.
  CHECK(cost({1, 0, 0, 0x1p18f, 0, 0}, {3, 0, 0, 0x1p18f, 0, 0}) == Approx(0.75).epsilon(1e-4));
}

TEST_CASE("collapse costs in a plane are nothing, but for the corners of its boundary") {
  IndexedFaceSet set = test::grid(8, 6);
  const Result3 flat = costs_of(set, {.placement = CollapsePlacement::kMidpoint});
  flat.mesh.for_each_edge([&](HalfEdgeId h) {
    const auto [p, q] = flat.mesh.vertices_of_edge(h);
    if (!flat.mesh.is_boundary(p) && !flat.mesh.is_boundary(q)) CHECK(flat.costs[h.index] == 0.0f);
  });
  // (1, 0) lies on two boundary edges of length 1 and weight 10; half an edge up that is 20 / 4. (1, 1)
  // does not lie on any.
  CHECK(flat.costs[flat.mesh.find_half_edge(VertexId(1), VertexId(10)).index] == 5.0f);
  for (const float weight : {0.0f, 7.0f}) {
    const Result3 other =
        costs_of(set, {.boundary_weight = weight, .placement = CollapsePlacement::kMidpoint});
    CHECK(other.costs[other.mesh.find_half_edge(VertexId(1), VertexId(10)).index] == weight / 2);
  }
  // Tilted, with places off by 2^-22 at most: of squares, and of the product's rounding.
  for (Vec3& p : set.points) p.z = 0.5f * p.x - 0.25f * p.y + 3.0f;
  CollapseCostOptions options = unit_frame(set.points);
  for (const CollapsePlacement placement : kPlacements) {
    options.placement = placement;
    const Result3 tilted = costs_of(set, options);
    const Textbook book = textbook(set, tilted.mesh, options);
    tilted.mesh.for_each_edge([&](HalfEdgeId h) {
      const auto [p, q] = tilted.mesh.vertices_of_edge(h);
      if (tilted.mesh.is_boundary(p) || tilted.mesh.is_boundary(q)) return;
      const double size = length(book.points[p.index] - book.points[q.index]);
      CHECK(tilted.costs[h.index] <
            64 * 0x1p-23 * (book.weight[p.index] + book.weight[q.index]) * size * size);
    });
  }
}

TEST_CASE("collapse costs do not depend on the unit of length, in the frame of their own") {
  IndexedFaceSet set = test::torus(20, 12);
  test::jitter(set, 0.02f, 4);
  const std::vector<float> costs = costs_of(set, unit_frame(set.points)).costs;
  for (const float unit : {0x1p-55f, 0x1p-20f, 0x1p50f}) {
    IndexedFaceSet scaled = set;
    for (Vec3& p : scaled.points) p *= unit;
    CHECK(costs_of(scaled, unit_frame(scaled.points)).costs == costs);
  }
}

TEST_CASE("the unit frame brings positions into [-2, 2] by a power of two") {
  for (const float unit : {0x1p-55f, 1.0f, 3.7f, 0x1p55f})
    for (const Vec3 offset : {Vec3(0.0f), Vec3(9, -7, 100)}) {
      IndexedFaceSet set = test::icosphere(2);
      Vec3 low(1e30f), high(-1e30f);
      for (Vec3& p : set.points) {
        p = (p + offset) * unit;
        for (int k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], p[k]);
          high[k] = std::max(high[k], p[k]);
        }
      }
      const CollapseCostOptions options = unit_frame(set.points);
      int exponent = 0;
      CHECK(std::frexp(options.scale, &exponent) == 0.5f);
      float largest = 0;
      for (const Vec3& p : set.points)
        for (int k = 0; k < 3; ++k)
          largest = std::max(largest, std::fabs(p[k] - options.centre[k]) * options.scale);
      CHECK((largest >= 0.5f && largest <= 2.0f));
      for (int k = 0; k < 3; ++k)
        CHECK(std::fabs(double{options.centre[k]} - 0.5 * (double{low[k]} + double{high[k]})) <=
              0x1p-22 * (std::fabs(double{low[k]}) + std::fabs(double{high[k]})));
    }
  CHECK((unit_frame({}).scale == 1.0f && unit_frame({}).centre == Vec3(0.0f)));
  const std::vector<Vec3> point(3, Vec3(1, 2, 3));
  const CollapseCostOptions options = unit_frame(point);
  CHECK((options.centre == point[0] && options.scale > 0 && options.scale <= 0x1p60f));
}

TEST_CASE("collapse costs of degenerate meshes are numbers, and twins agree") {
  for (const auto& [name, set] : test::degenerate_shapes()) {
    INFO(name);
    for (const CollapsePlacement placement : kPlacements) {
      CollapseCostOptions options = unit_frame(set.points);
      options.placement = placement;
      const Result3 found = costs_of(set, options);
      for (std::uint32_t h = 0; h < found.costs.size(); ++h) {
        CHECK((found.costs[h] >= 0.0f && found.costs[h] <= kLargest));
        if (found.mesh.twins()[h] != kInvalid) CHECK(found.costs[h] == found.costs[found.mesh.twins()[h]]);
      }
      for (const VertexQuadric& quadric : found.quadrics)
        for (const float entry : quadric) CHECK(std::isfinite(entry));
      for (std::uint32_t v = 0; v < set.points.size(); ++v)
        if (found.mesh.is_isolated(VertexId(v))) CHECK(found.quadrics[v] == VertexQuadric{});
      if (name.ends_with("in a point"))
        CHECK(std::all_of(found.costs.begin(), found.costs.end(), [](float cost) { return cost == 0.0f; }));
    }
  }
  // Quadrics of one's own may hold anything.
  const IndexedFaceSet set = test::cube();
  const HalfEdgeMesh mesh = test::half_edges(set);
  for (const float entry : {std::numeric_limits<float>::infinity(), NAN, kLargest})
    for (const CollapsePlacement placement : kPlacements) {
      const std::vector<VertexQuadric> own(8, VertexQuadric{entry, entry, entry, entry, entry, entry});
      const auto costs = collapse_costs(mesh, set.points, own, {.placement = placement}).value();
      for (const float cost : costs) CHECK((cost >= 0.0f && cost <= kLargest));
    }
  CHECK(vertex_quadrics(HalfEdgeMesh{}, {}).value().empty());
  CHECK(collapse_costs(HalfEdgeMesh{}, {}, {}).value().empty());
}

TEST_CASE("collapse costs: errors") {
  const IndexedFaceSet set = test::cube(), quads = test::quad_cube();
  const HalfEdgeMesh mesh = test::half_edges(set), polygons = test::half_edges(quads);
  const std::vector<VertexQuadric> eight(8);
  const auto check = [&](const CollapseCostOptions& options) {
    CHECK(vertex_quadrics(mesh, set.points, options).error().code == ErrorCode::kUsage);
    CHECK(collapse_costs(mesh, set.points, eight, options).error().code == ErrorCode::kUsage);
  };
  for (const float scale : {0.0f, -1.0f, 0x1p-61f, 0x1p61f, NAN}) check({.scale = scale});
  for (const float weight : {-1.0f, 0x1p21f, NAN}) check({.boundary_weight = weight});
  for (const float centre : {0x1p60f, -0x1p60f, NAN}) check({.centre = Vec3(0.0f, centre, 0.0f)});
  const auto few = std::span(set.points).first(7);
  CHECK(vertex_quadrics(mesh, few).error().code == ErrorCode::kUsage);
  CHECK(collapse_costs(mesh, few, eight).error().code == ErrorCode::kUsage);
  CHECK(collapse_costs(mesh, set.points, std::span(eight).first(7)).error().code == ErrorCode::kUsage);
  CHECK(vertex_quadrics(polygons, quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(collapse_costs(polygons, quads.points, eight).error().code == ErrorCode::kUnsuitable);
}
