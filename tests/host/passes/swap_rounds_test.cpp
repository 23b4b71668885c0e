#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <tbb/task_arena.h>

#include <vkmesh/passes/swap_rounds.h>

#include "support/shapes.h"

namespace vkmesh {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

SwapRounds rounds_of(const HalfEdgeMesh& mesh, const std::vector<Vec3>& points,
                     const SwapRoundsOptions& options = {}) {
  auto result = swap_rounds(mesh, points, options);
  REQUIRE(result.has_value());
  const auto valid = validate(result->mesh);
  if (!valid) FAIL(valid.error().describe());
  return std::move(*result);
}

std::set<Edge> edges_of(const HalfEdgeMesh& mesh) {
  std::set<Edge> all;
  mesh.for_each_edge([&](HalfEdgeId h) {
    const std::uint32_t a = mesh.origin(h).index, b = mesh.target(h).index;
    all.emplace(std::min(a, b), std::max(a, b));
  });
  return all;
}

/// Textbook, in double precision: what the swap of each inner edge gains; less than 0 where it is illegal.
/// And the four vertices of its quadrilateral.
struct Swap {
  double gain;
  std::array<std::uint32_t, 4> vertices;
};
std::map<Edge, Swap> swaps_by_definition(const HalfEdgeMesh& mesh, const std::vector<Vec3>& points,
                                         SwapCriterion criterion) {
  const std::set<Edge> edges = edges_of(mesh);
  const auto at = [&](std::uint32_t v) { return DVec3(points[v]); };
  const auto area = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return glm::cross(at(b) - at(a), at(c) - at(a));
  };
  const auto score = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    double least = 4, sides = 0;
    for (const auto& [x, y, z] : {std::array{a, b, c}, {b, c, a}, {c, a, b}}) {
      const DVec3 u = at(y) - at(x), v = at(z) - at(x);
      least = std::min(least, std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)));
      sides += glm::dot(u, u);
    }
    if (criterion == SwapCriterion::kMinAngle) return std::pow(std::sin(least), 2);
    return 2 * std::sqrt(3.0) * glm::length(area(a, b, c)) / sides;
  };
  std::map<Edge, Swap> swaps;
  mesh.for_each_edge([&](HalfEdgeId h) {
    if (mesh.is_boundary(h)) return;
    const HalfEdgeId t = mesh.twin(h);
    const std::uint32_t p = mesh.origin(h).index, q = mesh.origin(t).index,
                        a = mesh.origin(mesh.previous(h)).index, b = mesh.origin(mesh.previous(t)).index;
    double gain = std::min(score(b, a, p), score(a, b, q)) - std::min(score(p, q, a), score(q, p, b));
    const DVec3 mean = area(p, q, a) + area(q, p, b);
    if (edges.contains({std::min(a, b), std::max(a, b)}) || glm::dot(area(b, a, p), mean) <= 0 ||
        glm::dot(area(a, b, q), mean) <= 0)
      gain = -1;
    swaps[{std::min(p, q), std::max(p, q)}] = {gain, {p, q, a, b}};
  });
  return swaps;
}

IndexedFaceSet noisy_torus(std::uint32_t seed) {
  IndexedFaceSet torus = test::torus(24, 16);
  test::jitter(torus, 0.06f, seed);
  return torus;
}

}  // namespace

TEST_CASE("a round swaps the best edge about each of its vertices, and no two next to each other",
          "[swap_rounds]") {
  for (const SwapCriterion criterion : {SwapCriterion::kMinAngle, SwapCriterion::kAspectRatio}) {
    const IndexedFaceSet torus = noisy_torus(3);
    HalfEdgeMesh mesh = test::half_edges(torus);
    SwapRoundsOptions options;
    options.criterion = criterion;
    options.max_rounds = 1;
    for (int round = 0; round < 4; ++round) {
      const SwapRounds one = rounds_of(mesh, torus.points, options);
      REQUIRE(one.swaps.size() == 1);
      const auto swaps = swaps_by_definition(mesh, torus.points, criterion);
      const std::set<Edge> after = edges_of(one.mesh);
      std::map<std::uint32_t, double> best;  // of each vertex
      for (const auto& [edge, swap] : swaps)
        for (const std::uint32_t v : swap.vertices) best[v] = std::max(best[v], swap.gain);
      std::set<std::uint32_t> touched;
      std::size_t gone = 0;
      for (const auto& entry : swaps) {
        const Edge& edge = entry.first;
        const Swap& swap = entry.second;
        const bool is_best =
            std::ranges::all_of(swap.vertices, [&](std::uint32_t v) { return swap.gain >= best[v] - 1e-6; });
        if (!after.contains(edge)) {
          ++gone;
          CHECK(swap.gain > -1e-6);
          CHECK(is_best);
          for (const std::uint32_t v : swap.vertices) CHECK(touched.insert(v).second);
          CHECK(after.contains(
              {std::min(swap.vertices[2], swap.vertices[3]), std::max(swap.vertices[2], swap.vertices[3])}));
        } else if (swap.gain > 1e-5) {
          // It stayed because another is as good.
          CHECK(std::ranges::any_of(swap.vertices,
                                    [&](std::uint32_t v) { return best[v] > swap.gain - 1e-6; }));
          CHECK(!std::ranges::all_of(swap.vertices, [&](std::uint32_t v) {
            return swap.gain > best[v] - 1e-9 && !touched.contains(v);
          }));
        }
      }
      CHECK(gone == one.swaps[0]);
      for (std::uint32_t c = 0; c < one.source_corner.size(); ++c)
        CHECK(mesh.origins()[one.source_corner[c]] == one.mesh.origins()[c]);
      CHECK(after.size() == mesh.edge_count());
      mesh = one.mesh;
    }
  }
}

TEST_CASE("rounds of swaps end where no swap gains", "[swap_rounds]") {
  for (const SwapCriterion criterion : {SwapCriterion::kMinAngle, SwapCriterion::kAspectRatio}) {
    for (IndexedFaceSet shape : test::noisy_shapes()) {
      test::jitter(shape, 0.03f, 5);
      const HalfEdgeMesh mesh = test::half_edges(shape);
      SwapRoundsOptions options;
      options.criterion = criterion;
      const SwapRounds result = rounds_of(mesh, shape.points, options);
      REQUIRE(!result.swaps.empty());
      CHECK(result.swaps.back() == 0);
      CHECK(result.swaps.size() < 40);
      for (const auto& [edge, swap] : swaps_by_definition(result.mesh, shape.points, criterion))
        CHECK(swap.gain < 1e-5);
      // Round by round it is the same.
      HalfEdgeMesh step = mesh;
      options.max_rounds = 1;
      std::vector<std::uint32_t> swaps;
      do {
        const SwapRounds one = rounds_of(step, shape.points, options);
        swaps.push_back(one.swaps.back());
        step = one.mesh;
      } while (swaps.back() != 0);
      CHECK(swaps == result.swaps);
      CHECK(std::ranges::equal(step.origins(), result.mesh.origins()));
      CHECK(std::ranges::equal(step.twins(), result.mesh.twins()));
    }
  }
}

TEST_CASE("a plane whose points moved is Delaunay again after few rounds", "[swap_rounds]") {
  IndexedFaceSet grid = test::grid(150, 120);
  test::jitter(grid, 0.3f, 1);
  for (Vec3& p : grid.points) p.z = 0.0f;
  const SwapRounds first = rounds_of(test::half_edges(grid), grid.points);
  IndexedFaceSet moved = grid;
  test::jitter(moved, 0.3f, 2);
  for (Vec3& p : moved.points) p.z = 0.0f;
  // From a Delaunay triangulation of other places; where a triangle lies upside down swaps must not make more
  // of them.
  const SwapRounds again = rounds_of(first.mesh, moved.points);
  CHECK(again.swaps.size() <= 15);
  CHECK(again.swaps.front() > 100);
  std::size_t upside_down = 0;
  for (std::uint32_t f = 0; f < again.mesh.face_count(); ++f) {
    const auto at = [&](std::uint32_t i) { return moved.points[again.mesh.origins()[3 * f + i]]; };
    upside_down += glm::cross(at(1) - at(0), at(2) - at(0)).z < 0 ? 1 : 0;
  }
  CAPTURE(upside_down);
  for (const auto& [edge, swap] : swaps_by_definition(again.mesh, moved.points, SwapCriterion::kMinAngle))
    CHECK(swap.gain < 1e-5);
}

TEST_CASE("locked edges stay through rounds of swaps", "[swap_rounds]") {
  const IndexedFaceSet torus = noisy_torus(8);
  const HalfEdgeMesh mesh = test::half_edges(torus);
  std::vector<std::uint32_t> locked(mesh.half_edge_count(), 0);
  const SwapRounds free = rounds_of(mesh, torus.points);
  std::set<Edge> kept;
  for (std::uint32_t h = 0; h < locked.size(); h += 7) {
    locked[h] = 1;
    const std::uint32_t a = mesh.origin(HalfEdgeId(h)).index, b = mesh.target(HalfEdgeId(h)).index;
    kept.emplace(std::min(a, b), std::max(a, b));
  }
  SwapRoundsOptions options;
  options.locked = locked;
  const SwapRounds result = rounds_of(mesh, torus.points, options);
  CHECK(result.swaps.front() > 0);
  const std::set<Edge> after = edges_of(result.mesh), after_free = edges_of(free.mesh);
  std::size_t missed = 0;
  for (const Edge& edge : kept) {
    CHECK(after.contains(edge));
    missed += after_free.contains(edge) ? 0 : 1;
  }
  CHECK(missed > 0);
}

TEST_CASE("rounds of swaps have an answer for every surface, and one for bad options", "[swap_rounds]") {
  for (const auto& [name, shape] : test::degenerate_shapes()) {
    CAPTURE(name);
    const HalfEdgeMesh mesh = test::half_edges(shape);
    CHECK(rounds_of(mesh, shape.points).mesh.edge_count() == mesh.edge_count());
  }
  // A wheel of more spokes than are looked at: nothing at its hub swaps, and nothing breaks.
  IndexedFaceSet wheel;
  wheel.points.emplace_back(0.0f);
  const std::uint32_t spokes = kMaxSwapValence + 100;
  for (std::uint32_t i = 0; i < spokes; ++i) {
    const double angle = 2 * 3.14159265358979 * i / spokes, radius = i % 2 == 0 ? 1.0 : 1.3;
    wheel.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
    wheel.corners.insert(wheel.corners.end(), {0, 1 + i, 1 + (i + 1) % spokes});
  }
  CHECK(rounds_of(test::half_edges(wheel), wheel.points).swaps == std::vector<std::uint32_t>{0});

  const IndexedFaceSet torus = noisy_torus(1);
  const HalfEdgeMesh mesh = test::half_edges(torus);
  SwapRoundsOptions options;
  options.max_rounds = 0;
  CHECK(rounds_of(mesh, torus.points, options).swaps.empty());
  const std::vector<std::uint32_t> few(3);
  options.locked = few;
  CHECK(swap_rounds(mesh, torus.points, options).error().code == ErrorCode::kUsage);
  CHECK(swap_rounds(mesh, torus.points, {}, [](double) { return false; }).error().code ==
        ErrorCode::kInterrupted);
  const IndexedFaceSet quads = test::quad_cube();
  CHECK(swap_rounds(test::half_edges(quads), quads.points).error().code == ErrorCode::kUnsuitable);

  std::vector<HalfEdgeMesh> results;
  for (const int threads : {1, 2, 8}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { results.push_back(rounds_of(mesh, torus.points).mesh); });
  }
  for (const HalfEdgeMesh& result : results)
    CHECK(std::ranges::equal(result.origins(), results.front().origins()));
}

}  // namespace vkmesh
