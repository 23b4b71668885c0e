#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <vkmesh/optimize/swap_edges.h>

#include "math/angle.h"
#include "optimize/triangle_costs.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr double kPi = std::numbers::pi;
constexpr std::array kAllCosts = {
    SwapCost::kMinAngle,          SwapCost::kAspectRatio,   SwapCost::kDelaunay,
    SwapCost::kValence,           SwapCost::kMeanCurvature, SwapCost::kSquaredMeanCurvature,
    SwapCost::kAbsoluteCurvature, SwapCost::kDihedralAngle, SwapCost::kNormalDeviation};

bool is_of_worst(SwapCost cost) {
  return cost == SwapCost::kMinAngle || cost == SwapCost::kAspectRatio;
}

/// What costs are by their definitions, from a list of triangles, with the functions of <cmath>.
class Definition {
 public:
  /// `unit`: of lengths; 0: that of swap_edges() for these triangles.
  Definition(std::vector<Triangle> triangles, const std::vector<Vec3>& points,
             const std::vector<Vec3>& normals, double unit = 0)
      : triangles_(std::move(triangles)), unit_(unit), normals_(normals) {
    if (unit_ == 0) {
      DVec3 low(points[triangles_[0][0]]), high = low;
      for (const Triangle& t : triangles_)
        for (const std::uint32_t v : t) {
          low = glm::min(low, DVec3(points[v]));
          high = glm::max(high, DVec3(points[v]));
        }
      const double size = glm::length(high - low) / std::sqrt(static_cast<double>(triangles_.size()));
      unit_ = std::exp2(std::floor(std::log2(size)));
    }
    for (const Vec3& p : points) points_.push_back(DVec3(p) / unit_);
    for (std::size_t f = 0; f < triangles_.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = triangles_[f][i], to = triangles_[f][(i + 1) % 3];
        faces_[{std::min(from, to), std::max(from, to)}].push_back(f);
      }
  }

  [[nodiscard]] double total(SwapCost cost) const {
    double sum = 0;
    switch (cost) {
      case SwapCost::kMinAngle:
      case SwapCost::kAspectRatio:
      case SwapCost::kDelaunay:
        for (const Triangle& t : triangles_) sum += of_triangle(t, cost);
        return sum;
      case SwapCost::kNormalDeviation:
        for (const Triangle& t : triangles_)
          for (const std::uint32_t v : t)
            sum += glm::length(area(t)) / 6 *
                   (1 - glm::dot(glm::normalize(area(t)), glm::normalize(DVec3(normals_[v]))));
        return sum;
      case SwapCost::kDihedralAngle:
        for (const auto& [edge, faces] : faces_) sum += bend(faces);
        return sum;
      default:
        break;
    }
    std::map<std::uint32_t, std::array<double, 4>> at;  // valence, H, A, angles
    std::set<std::uint32_t> boundary;
    for (const auto& [edge, faces] : faces_)
      for (const std::uint32_t v : {edge.first, edge.second}) {
        at[v][0] += 1;
        at[v][1] += glm::length(points_[edge.first] - points_[edge.second]) * bend(faces) / 4;
        if (faces.size() == 1) boundary.insert(v);
      }
    for (const Triangle& t : triangles_)
      for (std::size_t i = 0; i < 3; ++i) {
        const DVec3 x = points_[t[(i + 1) % 3]] - points_[t[i]], y = points_[t[(i + 2) % 3]] - points_[t[i]];
        at[t[i]][2] += glm::length(glm::cross(x, y)) / 6;
        at[t[i]][3] += std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y));
      }
    for (const auto& [v, sums] : at) {
      const auto& [valence, h, a, angles] = sums;
      const double k = (boundary.contains(v) ? 1 : 2) * kPi - angles;
      if (cost == SwapCost::kValence) sum += std::pow(valence - (boundary.contains(v) ? 4 : 6), 2);
      if (cost == SwapCost::kMeanCurvature) sum += h;
      if (cost == SwapCost::kSquaredMeanCurvature) sum += h * h / a;
      if (cost == SwapCost::kAbsoluteCurvature) sum += k >= 0 ? 2 * h : 2 * std::sqrt(h * h - a * k);
    }
    return sum;
  }

  /// The term of a triangle: ¾ − sin² of the least angle, 1 − quality, or the sum of the cotangents.
  [[nodiscard]] double of_triangle(const Triangle& t, SwapCost cost) const {
    double least = kPi, cotangents = 0, sides = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const DVec3 x = points_[t[(i + 1) % 3]] - points_[t[i]], y = points_[t[(i + 2) % 3]] - points_[t[i]];
      const double angle = std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y));
      least = std::min(least, angle);
      cotangents += 1 / std::tan(angle);
      sides += glm::dot(x, x);
    }
    if (cost == SwapCost::kMinAngle) return 0.75 - std::pow(std::sin(least), 2);
    if (cost == SwapCost::kAspectRatio) return 1 - 2 * std::sqrt(3.0) * glm::length(area(t)) / sides;
    return cotangents;
  }
  [[nodiscard]] DVec3 area(const Triangle& t) const {
    return glm::cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]);
  }
  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  [[nodiscard]] const auto& faces_of_edges() const { return faces_; }

 private:
  [[nodiscard]] double bend(const std::vector<std::size_t>& faces) const {
    if (faces.size() == 1) return 0;
    const DVec3 a = area(triangles_[faces[0]]), b = area(triangles_[faces[1]]);
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  }

  std::vector<Triangle> triangles_;
  double unit_;
  std::vector<DVec3> points_;
  const std::vector<Vec3>& normals_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> faces_;
};

std::vector<Triangle> triangles_of(const HalfEdgeMesh& mesh) {
  std::vector<Triangle> all;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    all.push_back({mesh.origins()[3 * f], mesh.origins()[3 * f + 1], mesh.origins()[3 * f + 2]});
  return all;
}

/// The triangles as a set, the least corner first.
std::set<Triangle> triangle_set(const HalfEdgeMesh& mesh) {
  std::set<Triangle> all;
  for (Triangle t : triangles_of(mesh)) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    all.insert(t);
  }
  return all;
}

/// A torus whose points lie exactly on it, their parameters moved by up to 0.33 of a step, and random
/// diagonals.
IndexedFaceSet jittered_torus(std::uint32_t rings, std::uint32_t sides, std::uint32_t seed) {
  IndexedFaceSet torus;
  std::mt19937 random(seed);
  const auto step = [&] { return 0.66 * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double u = 2 * kPi * (i + step()) / rings, v = 2 * kPi * (j + step()) / sides;
      torus.points.emplace_back((1 + 0.4 * std::cos(v)) * std::cos(u), (1 + 0.4 * std::cos(v)) * std::sin(u),
                                0.4 * std::sin(v));
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % rings * sides + j % sides; };
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      const std::array<std::uint32_t, 6> quad =
          random() % 2 == 0 ? std::array{a, b, c, a, c, d} : std::array{a, b, d, b, c, d};
      torus.corners.insert(torus.corners.end(), quad.begin(), quad.end());
    }
  return torus;
}

std::vector<Vec3> normals_of(const IndexedFaceSet& set) {
  std::vector<Vec3> normals(set.points.size(), Vec3(0.0f));
  for (std::size_t f = 0; f < set.face_count(); ++f) {
    const auto v = set.face(f);
    const Vec3 area = glm::cross(set.points[v[1]] - set.points[v[0]], set.points[v[2]] - set.points[v[0]]);
    for (const std::uint32_t corner : v) normals[corner] += area;
  }
  return normals;
}

SwappedEdges swapped(const HalfEdgeMesh& mesh, const std::vector<Vec3>& points,
                     const SwapEdgesOptions& options) {
  auto result = swap_edges(mesh, points, options);
  REQUIRE(result.has_value());
  const auto valid = validate(result->mesh);
  if (!valid) FAIL(valid.error().describe());
  return std::move(*result);
}

SwapEdgesOptions options_of(SwapCost cost, const std::vector<Vec3>& normals) {
  SwapEdgesOptions options;
  options.costs = {{cost, 1}};
  if (cost == SwapCost::kNormalDeviation) options.normals = normals;
  return options;
}

/// How much the swap of an edge between two faces would lower the cost, by definition; less than 0 where it
/// is illegal.
double gain_by_definition(const Definition& now, const std::vector<Vec3>& points,
                          const std::vector<Vec3>& normals, std::pair<std::uint32_t, std::uint32_t> edge,
                          SwapCost cost) {
  const auto& faces = now.faces_of_edges().at(edge);
  if (faces.size() != 2) return -1;
  auto [p, q] = edge;
  std::array<std::uint32_t, 2> across{};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const Triangle& t = now.triangles()[faces[i]];
      if (t[k] != p && t[k] != q) across[i] = t[k];
      if (i == 0 && t[k] == p && t[(k + 1) % 3] != q) {
        std::swap(p, q);  // the first face runs from p to q
        k = 0;
      }
    }
  const auto [a, b] = across;
  if (now.faces_of_edges().contains({std::min(a, b), std::max(a, b)})) return -1;
  const Triangle n0 = {b, a, p}, n1 = {a, b, q};
  const DVec3 f = now.area(now.triangles()[faces[0]]), g = now.area(now.triangles()[faces[1]]);
  for (const Triangle& made : {n0, n1}) {
    if (glm::dot(now.area(made), f + g) <= 0) return -1;
    if (glm::dot(now.area(made), f) <= 0 || glm::dot(now.area(made), g) <= 0) return -1;
  }
  if (is_of_worst(cost))
    return std::max(now.of_triangle(now.triangles()[faces[0]], cost),
                    now.of_triangle(now.triangles()[faces[1]], cost)) -
           std::max(now.of_triangle(n0, cost), now.of_triangle(n1, cost));
  std::vector<Triangle> then = now.triangles();
  then[faces[0]] = n0;
  then[faces[1]] = n1;
  return now.total(cost) - Definition(std::move(then), points, normals, now.unit()).total(cost);
}

}  // namespace

TEST_CASE("costs of swaps are what their definitions say, before and after", "[optimize]") {
  for (IndexedFaceSet shape : {jittered_torus(9, 8, 1), test::grid(6, 5), test::cylinder(5, 9)}) {
    test::jitter(shape, 0.05f, 3);
    const std::vector<Vec3> normals = normals_of(shape);
    const HalfEdgeMesh mesh = test::half_edges(shape);
    for (const SwapCost cost : kAllCosts) {
      CAPTURE(static_cast<int>(cost));
      const SwappedEdges result = swapped(mesh, shape.points, options_of(cost, normals));
      CHECK(result.stop == SwapStop::kNoGain);
      const Definition start(triangles_of(mesh), shape.points, normals);
      const Definition end(triangles_of(result.mesh), shape.points, normals, start.unit());
      // Each term is rounded.
      const double margin = static_cast<double>(mesh.edge_count()) * 0x1p-24;
      CHECK(result.cost_before == Approx(start.total(cost)).epsilon(1e-6).margin(margin));
      CHECK(result.cost_after == Approx(end.total(cost)).epsilon(1e-6).margin(margin));
      CHECK(result.cost_before > (cost == SwapCost::kValence ? -1 : 0));
      if (!is_of_worst(cost)) CHECK(result.cost_after <= result.cost_before);
    }
  }
}

TEST_CASE("no legal swap is left that lowers the cost, by brute force", "[optimize]") {
  for (const std::uint32_t seed : {1u, 2u}) {
    IndexedFaceSet shape = seed == 1 ? jittered_torus(9, 7, seed) : test::grid(8, 7);
    test::jitter(shape, seed == 1 ? 0.02f : 0.3f, seed);
    const std::vector<Vec3> normals = normals_of(shape);
    const HalfEdgeMesh mesh = test::half_edges(shape);
    for (const SwapCost cost : kAllCosts) {
      const SwappedEdges result = swapped(mesh, shape.points, options_of(cost, normals));
      CAPTURE(static_cast<int>(cost), result.swaps);
      CHECK((result.swaps > 0 || cost == SwapCost::kValence));
      const Definition end(triangles_of(result.mesh), shape.points, normals);
      for (const auto& [edge, faces] : end.faces_of_edges())
        REQUIRE(gain_by_definition(end, shape.points, normals, edge, cost) < 1e-5);
    }
  }
}

TEST_CASE("each swap lowers the cost, and changes nothing but two triangles", "[optimize]") {
  IndexedFaceSet shape = jittered_torus(8, 7, 5);
  const std::vector<Vec3> normals = normals_of(shape);
  for (const SwapCost cost : kAllCosts) {
    HalfEdgeMesh mesh = test::half_edges(shape);
    SwapEdgesOptions options = options_of(cost, normals);
    const SwappedEdges whole = swapped(mesh, shape.points, options);
    options.max_swaps = 1;
    std::size_t swaps = 0;
    for (;; ++swaps) {
      const SwappedEdges one = swapped(mesh, shape.points, options);
      if (one.swaps == 0) break;
      CHECK(one.stop == SwapStop::kMaxSwaps);
      if (is_of_worst(cost)) {
        const auto sorted = [&](const HalfEdgeMesh& m) {
          const Definition all(triangles_of(m), shape.points, normals);
          std::vector<double> costs;
          for (const Triangle& t : all.triangles()) costs.push_back(all.of_triangle(t, cost));
          std::ranges::sort(costs, std::greater{});
          return costs;
        };
        CHECK(sorted(one.mesh) < sorted(mesh));
      } else {
        REQUIRE(one.cost_after < one.cost_before);
      }
      std::map<std::uint32_t, int> valences;
      for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        int change = 0;
        one.mesh.for_each_neighbour(VertexId(v), [&](VertexId) { ++change; });
        mesh.for_each_neighbour(VertexId(v), [&](VertexId) { --change; });
        if (change != 0) valences[v] = change;
      }
      REQUIRE(valences.size() == 4);
      int sum = 0, squares = 0;
      for (const auto& [v, change] : valences) {
        sum += change;
        squares += change * change;
      }
      CHECK(sum == 0);
      CHECK(squares == 4);
      CHECK(one.mesh.edge_count() == mesh.edge_count());
      mesh = one.mesh;
      REQUIRE(swaps < 2000);
    }
    CHECK(swaps > 0);
    // The same swaps as in one run, but where two gains are alike and edges have other numbers.
    CHECK(static_cast<double>(swaps) == Approx(static_cast<double>(whole.swaps)).epsilon(0.1));
  }
}

TEST_CASE("in the plane swaps end in the Delaunay triangulation, whatever they start from", "[optimize]") {
  IndexedFaceSet grid = test::grid(14, 11);
  test::jitter(grid, 0.3f, 7);
  for (Vec3& p : grid.points) p.z = 0.25f;
  // A hull that is convex: otherwise what lies beyond notches is no part of it.
  for (Vec3& p : grid.points) {
    const Vec3 c = p - Vec3(7.0f, 5.5f, 0.25f);
    p += Vec3(c.x * (1 - c.y * c.y / 200), c.y * (1 - c.x * c.x / 200), 0.0f);
  }
  const HalfEdgeMesh mesh = test::half_edges(grid);
  SwapEdgesOptions options;
  options.costs = {{SwapCost::kMinAngle}};
  const SwappedEdges by_angle = swapped(mesh, grid.points, options);
  CHECK(by_angle.swaps > 50);
  const std::set<Triangle> triangles = triangle_set(by_angle.mesh);
  const auto circle_holds = [&](const HalfEdgeMesh& m) {
    std::size_t held = 0;
    m.for_each_edge([&](HalfEdgeId h) {
      if (m.is_boundary(h)) return;
      const auto at = [&](VertexId v) { return DVec3(grid.points[v.index]); };
      const DVec3 a = at(m.origin(h)), b = at(m.target(h)), c = at(m.origin(m.previous(h))),
                  d = at(m.origin(m.previous(m.twin(h))));
      const auto row = [&](const DVec3& p) { return DVec3(p.x - d.x, p.y - d.y, 0.0); };
      const DVec3 x = row(a), y = row(b), z = row(c);
      const double det = glm::dot(x, x) * (y.x * z.y - y.y * z.x) - glm::dot(y, y) * (x.x * z.y - x.y * z.x) +
                         glm::dot(z, z) * (x.x * y.y - x.y * y.x);
      // Only where the swap would be possible.
      const auto turn = [&](const DVec3& o, const DVec3& p, const DVec3& q) {
        return (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
      };
      if (det > 1e-6 && turn(d, b, c) > 1e-6 && turn(c, a, d) > 1e-6) ++held;
    });
    return held;
  };
  CHECK(circle_holds(mesh) > 50);
  CHECK(circle_holds(by_angle.mesh) == 0);
  options.costs = {{SwapCost::kDelaunay}};
  CHECK(triangle_set(swapped(mesh, grid.points, options).mesh) == triangles);
  // From far away: by valence and by the aspect ratio first.
  for (const SwapCost start : {SwapCost::kValence, SwapCost::kAspectRatio}) {
    SwapEdgesOptions first;
    first.costs = {{start}};
    const HalfEdgeMesh other = swapped(mesh, grid.points, first).mesh;
    CHECK(triangle_set(other) != triangles);
    for (const SwapCost cost : {SwapCost::kMinAngle, SwapCost::kDelaunay}) {
      options.costs = {{cost}};
      CHECK(triangle_set(swapped(other, grid.points, options).mesh) == triangles);
    }
  }
}

TEST_CASE("costs of curvature make a torus rounder than the max-min angle does", "[optimize]") {
  const IndexedFaceSet torus = jittered_torus(100, 160, 11);
  const HalfEdgeMesh mesh = test::half_edges(torus);
  // Root mean square distance of points on the faces from the torus.
  const auto rms = [&](const HalfEdgeMesh& m) {
    double sum = 0, area = 0;
    for (const Triangle& t : triangles_of(m)) {
      const DVec3 a(torus.points[t[0]]), b(torus.points[t[1]]), c(torus.points[t[2]]);
      const double weight = glm::length(glm::cross(b - a, c - a));
      for (int i = 0; i <= 4; ++i)
        for (int j = 0; i + j <= 4; ++j) {
          const double u = (i + 1.0 / 3) / 5, v = (j + 1.0 / 3) / 5;
          const DVec3 p = a + u * (b - a) + v * (c - a);
          const double d = std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.4;
          sum += weight * d * d;
          area += weight;
        }
    }
    return std::sqrt(sum / area);
  };
  const auto after = [&](SwapCost cost) {
    SwapEdgesOptions options;
    options.costs = {{cost}};
    return rms(swapped(mesh, torus.points, options).mesh);
  };
  const double start = rms(mesh), angle = after(SwapCost::kMinAngle), mean = after(SwapCost::kMeanCurvature),
               square = after(SwapCost::kSquaredMeanCurvature),
               absolute = after(SwapCost::kAbsoluteCurvature);
  CAPTURE(start, angle, mean, square, absolute);
  const double best = std::min({mean, square, absolute}), worst = std::max({mean, square, absolute});
  CHECK(worst <= 1.02 * best);
  CHECK(worst <= 0.78 * start);
  CHECK(worst <= 0.86 * angle);
}

TEST_CASE("edges that are to stay stay, and say why", "[optimize]") {
  const IndexedFaceSet torus = jittered_torus(12, 10, 3);
  const HalfEdgeMesh mesh = test::half_edges(torus);
  const auto edges_of = [](const HalfEdgeMesh& m) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> all;
    m.for_each_edge([&](HalfEdgeId h) {
      const std::uint32_t a = m.origin(h).index, b = m.target(h).index;
      all.emplace(std::min(a, b), std::max(a, b));
    });
    return all;
  };
  const auto blocked = [](const SwappedEdges& result, SwapReason reason) {
    return result.blocked[static_cast<std::size_t>(reason)];
  };
  SwapEdgesOptions options;
  const SwappedEdges free = swapped(mesh, torus.points, options);
  CHECK(blocked(free, SwapReason::kLocked) == 0);

  // What is free to swap otherwise, as the second half of the faces, is kept for each reason.
  const std::size_t faces = mesh.face_count(), half = faces / 2;
  std::vector<std::uint32_t> corners(3 * faces), materials(faces);
  std::vector<std::uint8_t> region(faces);
  for (std::size_t f = half; f < faces; ++f) {
    materials[f] = static_cast<std::uint32_t>(f);
    for (std::size_t i = 0; i < 3; ++i) {
      corners[3 * f + i] = static_cast<std::uint32_t>(f);
      options.locked_edges.push_back(static_cast<std::uint32_t>(3 * f + i));
    }
  }
  for (std::size_t f = 0; f < half; ++f) region[f] = 1;
  const auto kept = [&](const SwapEdgesOptions& with, SwapReason reason) {
    const SwappedEdges result = swapped(mesh, torus.points, with);
    CAPTURE(name_of(reason));
    CHECK(result.swaps > 0);
    CHECK(result.swaps < free.swaps);
    CHECK(blocked(result, reason) > 0);
    const auto before = edges_of(mesh), after = edges_of(result.mesh);
    for (std::uint32_t f = static_cast<std::uint32_t>(half); f < faces; ++f)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t a = mesh.origins()[3 * f + i], b = mesh.origins()[3 * f + (i + 1) % 3];
        CHECK(after.contains({std::min(a, b), std::max(a, b)}));
        CHECK(result.mesh.origins()[3 * f + i] == a);
      }
  };
  kept(options, SwapReason::kLocked);
  options.locked_edges.clear();
  options.corner_groups = corners;
  kept(options, SwapReason::kSeam);
  options.corner_groups = {};
  options.face_groups = materials;
  kept(options, SwapReason::kMaterialBorder);
  options.face_groups = {};
  options.region = region;
  kept(options, SwapReason::kOutsideRegion);

  // Creases: the edges of a cube.
  IndexedFaceSet cube = test::fine_cube(4);
  SwapEdgesOptions creases;
  creases.costs = {{SwapCost::kDihedralAngle}};
  creases.crease_angle = 0.5;
  const auto sharp = [&](const HalfEdgeMesh& m) {
    std::size_t count = 0;
    const Definition all(triangles_of(m), cube.points, cube.points);
    for (const auto& [edge, pair] : all.faces_of_edges())
      count += std::fabs(glm::dot(glm::normalize(all.area(all.triangles()[pair[0]])),
                                  glm::normalize(all.area(all.triangles()[pair[1]])))) < 0.01;
    return count;
  };
  CHECK(sharp(swapped(test::half_edges(cube), cube.points, creases).mesh) == 48);
}

TEST_CASE("bounds of a swap hold", "[optimize]") {
  IndexedFaceSet shape = jittered_torus(14, 10, 9);
  test::jitter(shape, 0.05f, 2);
  const HalfEdgeMesh mesh = test::half_edges(shape);
  SwapEdgesOptions options;
  const SwappedEdges free = swapped(mesh, shape.points, options);
  options.max_deviation = Length::absolute(0.004);
  const SwappedEdges near = swapped(mesh, shape.points, options);
  CHECK(near.swaps > 0);
  CHECK(near.swaps < free.swaps);
  CHECK(near.blocked[static_cast<std::size_t>(SwapReason::kDeviation)] > 0);
  // One swap at a time: the distance between the two diagonals.
  HalfEdgeMesh at = mesh;
  options.max_swaps = 1;
  for (int i = 0; i < 40; ++i) {
    const SwappedEdges one = swapped(at, shape.points, options);
    if (one.swaps == 0) break;
    std::vector<DVec3> ends;
    const auto edge_missing = [&](const HalfEdgeMesh& in, const HalfEdgeMesh& from) {
      in.for_each_edge([&](HalfEdgeId h) {
        if (from.find_half_edge(in.origin(h), in.target(h)).valid()) return;
        ends.emplace_back(shape.points[in.origin(h).index]);
        ends.emplace_back(shape.points[in.target(h).index]);
      });
    };
    edge_missing(at, one.mesh);
    edge_missing(one.mesh, at);
    REQUIRE(ends.size() == 4);
    const DVec3 n = glm::normalize(glm::cross(ends[1] - ends[0], ends[3] - ends[2]));
    CHECK(std::fabs(glm::dot(ends[2] - ends[0], n)) <= 0.004 * (1 + 1e-6));
    at = one.mesh;
  }
  options = {};
  options.max_dihedral_change = 0.05;
  const SwappedEdges flat = swapped(mesh, shape.points, options);
  CHECK(flat.swaps > 0);
  CHECK(flat.swaps < free.swaps);
  CHECK(flat.blocked[static_cast<std::size_t>(SwapReason::kDihedralChange)] > 0);
}

TEST_CASE("corners keep their vertices and their sides of seams", "[optimize]") {
  const IndexedFaceSet torus = jittered_torus(12, 9, 4);
  const HalfEdgeMesh mesh = test::half_edges(torus);
  std::vector<std::uint32_t> groups(3 * mesh.face_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)  // two charts, each corner by its vertex as well
    for (std::uint32_t i = 0; i < 3; ++i)
      groups[3 * f + i] = 2 * mesh.origins()[3 * f + i] + (f < mesh.face_count() / 2 ? 0 : 1);
  SwapEdgesOptions options;
  options.corner_groups = groups;
  const SwappedEdges result = swapped(mesh, torus.points, options);
  CHECK(result.swaps > 0);
  std::vector<std::uint32_t> after;
  for (std::uint32_t c = 0; c < groups.size(); ++c) {
    REQUIRE(mesh.origins()[result.source_corner[c]] == result.mesh.origins()[c]);
    after.push_back(groups[result.source_corner[c]]);
  }
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) CHECK(after[3 * f] % 2 == after[3 * f + 1] % 2);
  std::ranges::sort(after);
  std::vector<std::uint32_t> before = groups;
  before.erase(std::unique((std::ranges::sort(before), before.begin()), before.end()), before.end());
  after.erase(std::unique(after.begin(), after.end()), after.end());
  CHECK(after == before);
}

TEST_CASE("flat surfaces keep their area and volume through swaps", "[optimize]") {
  const IndexedFaceSet cube = test::fine_cube(6);
  const HalfEdgeMesh mesh = test::half_edges(cube);
  const auto measure = [&](const HalfEdgeMesh& m) {
    double area = 0, volume = 0;
    for (const Triangle& t : triangles_of(m)) {
      const DVec3 a(cube.points[t[0]]), b(cube.points[t[1]]), c(cube.points[t[2]]);
      area += glm::length(glm::cross(b - a, c - a)) / 2;
      volume += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return std::pair(area, volume);
  };
  for (const SwapCost cost : {SwapCost::kValence, SwapCost::kDelaunay, SwapCost::kMeanCurvature}) {
    SwapEdgesOptions options;
    options.costs = {{cost}};
    options.crease_angle = 0.5;
    const SwappedEdges result = swapped(mesh, cube.points, options);
    const auto [area, volume] = measure(result.mesh);
    CHECK(area == Approx(6).epsilon(1e-6));
    CHECK(volume == Approx(1).epsilon(1e-6));
    // Noise of rounding swaps nothing where all is flat.
    if (cost == SwapCost::kMeanCurvature) CHECK(result.swaps == 0);
  }
}

TEST_CASE("swaps of degenerate surfaces are defined", "[optimize]") {
  for (auto& [name, shape] : test::degenerate_shapes()) {
    CAPTURE(name);
    const HalfEdgeMesh mesh = test::half_edges(shape);
    const std::vector<Vec3> normals(shape.points.size(), Vec3(0.0f, 0.0f, 1.0f));
    for (const SwapCost cost : kAllCosts) {
      const SwappedEdges result = swapped(mesh, shape.points, options_of(cost, normals));
      CHECK(result.stop == SwapStop::kNoGain);
      CHECK(std::isfinite(result.cost_before));
      CHECK(std::isfinite(result.cost_after));
      CHECK(result.mesh.edge_count() == mesh.edge_count());
    }
  }
  // A cap, whose point lies on its longest side, goes.
  IndexedFaceSet cap;
  cap.points = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, -1, 0}};
  cap.corners = {0, 1, 2, 1, 0, 3};
  for (const SwapCost cost : {SwapCost::kMinAngle, SwapCost::kAspectRatio, SwapCost::kDelaunay}) {
    SwapEdgesOptions options;
    options.costs = {{cost}};
    CHECK(swapped(test::half_edges(cap), cap.points, options).swaps == 1);
  }
  const IndexedFaceSet none;
  CHECK(swapped(test::half_edges(none), none.points, {}).swaps == 0);
  IndexedFaceSet one;
  one.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.corners = {0, 1, 2};
  CHECK(swapped(test::half_edges(one), one.points, {}).swaps == 0);
}

TEST_CASE("swaps give the same bytes on any number of threads", "[optimize]") {
  IndexedFaceSet torus = jittered_torus(200, 120, 2);
  const HalfEdgeMesh mesh = test::half_edges(torus);
  SwapEdgesOptions options;
  options.costs = {{SwapCost::kAbsoluteCurvature}, {SwapCost::kValence, 0.01}, {SwapCost::kMinAngle, 0.1}};
  std::vector<SwappedEdges> results;
  for (const int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
    tbb::task_arena arena(threads);
    arena.execute([&] { results.push_back(swapped(mesh, torus.points, options)); });
  }
  for (const SwappedEdges& result : results) {
    CHECK(result.swaps == results.front().swaps);
    CHECK(std::ranges::equal(result.mesh.origins(), results.front().mesh.origins()));
    CHECK(result.source_corner == results.front().source_corner);
    CHECK(result.cost_after == results.front().cost_after);
  }
}

TEST_CASE("swap_edges stops when told, and refuses what it cannot do", "[optimize]") {
  const IndexedFaceSet torus = jittered_torus(40, 30, 2);
  const HalfEdgeMesh mesh = test::half_edges(torus);
  SwapEdgesOptions options;
  options.seconds = 0;
  CHECK(swapped(mesh, torus.points, options).stop == SwapStop::kTimeLimit);
  const auto cancelled = swap_edges(mesh, torus.points, {}, [](double) { return false; });
  REQUIRE(!cancelled.has_value());
  CHECK(cancelled.error().code == ErrorCode::kInterrupted);
  std::vector<double> told;
  REQUIRE(swap_edges(mesh, torus.points, {}, [&](double fraction) {
            told.push_back(fraction);
            return true;
          }).has_value());
  REQUIRE(told.size() >= 2);
  CHECK(std::ranges::is_sorted(told));
  CHECK(told.back() == 1);

  const auto refused = [&](auto&& change) {
    SwapEdgesOptions bad;
    change(bad);
    const auto result = swap_edges(mesh, torus.points, bad);
    REQUIRE(!result.has_value());
    CHECK(result.error().code == ErrorCode::kUsage);
  };
  const std::vector<std::uint32_t> few(5);
  const std::vector<std::uint8_t> flags(5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([](SwapEdgesOptions& o) { o.costs.clear(); });
  refused([](SwapEdgesOptions& o) { o.costs[0].weight = 0; });
  refused([&](SwapEdgesOptions& o) { o.costs[0].weight = nan; });
  refused([](SwapEdgesOptions& o) { o.costs[0].cost = SwapCost::kNormalDeviation; });
  refused([&](SwapEdgesOptions& o) { o.crease_angle = nan; });
  refused([](SwapEdgesOptions& o) { o.max_dihedral_change = 4; });
  refused([&](SwapEdgesOptions& o) { o.max_deviation = Length::absolute(nan); });
  refused([&](SwapEdgesOptions& o) { o.seconds = nan; });
  refused([](SwapEdgesOptions& o) { o.locked_edges = {4000000}; });
  refused([&](SwapEdgesOptions& o) { o.corner_groups = few; });
  refused([&](SwapEdgesOptions& o) { o.face_groups = few; });
  refused([&](SwapEdgesOptions& o) { o.region = flags; });
  const IndexedFaceSet quads = test::quad_cube();
  CHECK(swap_edges(test::half_edges(quads), quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(swap_edges(mesh, std::span(torus.points).first(3)).error().code == ErrorCode::kUsage);
}

TEST_CASE("angles in double precision are those of <cmath>", "[optimize]") {
  std::mt19937 random(2);
  const auto number = [&] { return std::exp(40.0 * (static_cast<double>(random()) / 4294967296.0 - 0.5)); };
  for (int i = 0; i < 20000; ++i) {
    const double y = number(), x = i % 2 == 0 ? number() : -number();
    REQUIRE(std::fabs(detail::angle_of(y, x) - std::atan2(y, x)) <= 4.5e-16 * std::atan2(y, x));
  }
  for (int k = 0; k <= 640; ++k)
    REQUIRE(detail::angle_of(k / 640.0, 1) == Approx(std::atan(k / 640.0)).epsilon(4e-16));
  CHECK(detail::angle_of(0, 0) == 0);
  CHECK(detail::angle_of(0, 3) == 0);
  CHECK(detail::angle_of(0, -3) == Approx(kPi));
  CHECK(detail::angle_of(2, 0) == Approx(kPi / 2));
}

TEST_CASE("costs of triangles do not depend on the order of their sides", "[optimize]") {
  std::mt19937 random(1);
  const auto side = [&] { return std::exp(8.0 * (static_cast<double>(random()) / 4294967296.0 - 0.5)); };
  for (int i = 0; i < 1000; ++i) {
    std::array<double, 3> s = {side(), side(), side()};
    const detail::SquaredSides sides(s[0], s[1], s[2]);
    std::ranges::sort(s);
    CHECK(std::array{sides.a, sides.b, sides.c} == s);
    do {
      const detail::SquaredSides other(s[0], s[1], s[2]);
      CHECK(other.least_sine2() == sides.least_sine2());
      CHECK(other.quality() == sides.quality());
    } while (std::ranges::next_permutation(s).found);
  }
  const detail::SquaredSides right(9, 25, 16);
  CHECK(right.area() == Approx(6));
  CHECK(right.least_sine2() == Approx(0.36));
  CHECK(right.quality() == Approx(4 * std::sqrt(3.0) * 6 / 50));
  CHECK(right.cotangents() == Approx(4.0 / 3 + 3.0 / 4));
}

}  // namespace vkmesh
