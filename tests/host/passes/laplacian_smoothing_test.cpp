// Laplacian, Taubin and cotangent smoothing against textbook formulas in double precision, written without
// regard to their order of operations.
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/laplacian_smoothing.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::angle_of;
using test::cross;
using test::dot;
using test::length;

TEST_CASE("one smoothing step agrees with double precision") {
  for (const IndexedFaceSet& set : test::noisy_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const NodeNeighbours neighbours = node_neighbours(mesh).value();
    for (const SmoothingBoundary boundary : {SmoothingBoundary::kFixed, SmoothingBoundary::kFree}) {
      const bool fix = boundary == SmoothingBoundary::kFixed;
      const auto smoothed = laplacian_smoothing(neighbours, set.points,
                                                {.lambda = 0.3f, .iterations = 1, .boundary = boundary});
      REQUIRE(smoothed);
      for (std::uint32_t v = 0; v < set.points.size(); ++v) {
        DVec3 expected(set.points[v]);
        double largest = length(expected);
        if (!(fix && mesh.is_boundary(VertexId(v)))) {
          DVec3 sum(0.0);
          int count = 0;
          mesh.for_each_neighbour(VertexId(v), [&](VertexId n) {
            sum += DVec3(set.points[n.index]);
            largest = std::max(largest, length(DVec3(set.points[n.index])));
            ++count;
          });
          expected += static_cast<double>(0.3f) * (sum / static_cast<double>(count) - expected);
        }
        // At most `valence` + 6 roundings of values no larger than the sum.
        CHECK(length(DVec3((*smoothed)[v]) - expected) < 32 * 0x1p-24 * largest);
      }
    }
  }
}

namespace {

// The mean of v's neighbours by cotangent weights, from the angles themselves.
DVec3 cotangent_mean(const IndexedFaceSet& set, std::uint32_t v) {
  std::map<std::uint32_t, double> weights;
  for (std::size_t f = 0; f < set.face_count(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto c = set.face(f);
      if (c[i] == v || (c[(i + 1) % 3] != v && c[(i + 2) % 3] != v)) continue;
      weights[c[(i + 1) % 3] == v ? c[(i + 2) % 3] : c[(i + 1) % 3]] += 1.0 / std::tan(angle_of(set, f, i));
    }
  DVec3 sum(0.0);
  double total = 0;
  for (const auto& [n, weight] : weights) {
    sum += std::max(weight, 0.0) * DVec3(set.points[n]);
    total += std::max(weight, 0.0);
  }
  return sum / total;
}

}  // namespace

TEST_CASE("one smoothing step by cotangents agrees with double precision") {
  for (const IndexedFaceSet& set : test::noisy_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const auto smoothed = laplacian_smoothing(node_neighbours(mesh).value(), set.points,
                                              {.lambda = 0.3f,
                                               .iterations = 1,
                                               .boundary = SmoothingBoundary::kFree,
                                               .weights = SmoothingWeights::kCotangent});
    REQUIRE(smoothed);
    for (std::uint32_t v = 0; v < set.points.size(); ++v) {
      const DVec3 here(set.points[v]);
      const DVec3 expected = here + static_cast<double>(0.3f) * (cotangent_mean(set, v) - here);
      // The roundings of a uniform step, and those of the cotangents: 2^-21 each as in the test of normals,
      // and ten times that where angles of six degrees occur; they weigh differences of positions.
      double largest = length(here);
      mesh.for_each_neighbour(
          VertexId(v), [&](VertexId n) { largest = std::max(largest, length(DVec3(set.points[n.index]))); });
      CHECK(length(DVec3((*smoothed)[v]) - expected) < 32 * 0x1p-21 * largest);
    }
  }
}

TEST_CASE("smoothing by cotangents: plane vertices stay, degenerate triangles and slivers do no harm") {
  IndexedFaceSet set = test::grid(6, 6);
  for (Vec3& p : set.points)
    p = Vec3(p.x - 0.5f * p.y + 0.1f * std::sin(p.y), 0.87f * p.y + 0.1f * std::cos(2 * p.x), 0.0f);
  const NodeNeighbours neighbours = node_neighbours(test::half_edges(set)).value();
  const LaplacianSmoothingOptions options{.iterations = 1, .weights = SmoothingWeights::kCotangent};
  // In a plane the cotangent Laplacian of positions vanishes, as long as no weight is negative.
  const auto smoothed = laplacian_smoothing(neighbours, set.points, options).value();
  for (std::size_t v = 0; v < smoothed.size(); ++v)
    CHECK(length(DVec3(smoothed[v]) - DVec3(set.points[v])) < 32 * 0x1p-24 * 10);

  set.points[8] = set.points[9];
  set.points[17] = 0.5f * (set.points[16] + set.points[18]) + Vec3(0, 1e-7f, 0);
  for (const std::uint32_t iterations : {1u, 50u}) {
    LaplacianSmoothingOptions many = options;
    many.iterations = iterations;
    const auto result = laplacian_smoothing(neighbours, set.points, many).value();
    for (const Vec3& p : result) CHECK((p.x >= -4 && p.x <= 8 && p.y >= -1 && p.y <= 8 && p.z == 0.0f));
  }
  for (Vec3& p : set.points) p = Vec3(1.0f);
  CHECK(laplacian_smoothing(neighbours, set.points, options).value() == set.points);
}

TEST_CASE("Taubin's λ|μ keeps the volume of a sphere that λ alone loses, and removes its noise") {
  IndexedFaceSet set = test::icosphere(5);
  const auto volume = [&](const std::vector<Vec3>& points) {
    double sum = 0;
    for (std::size_t f = 0; f < set.face_count(); ++f) {
      const auto c = set.face(f);
      sum += dot(DVec3(points[c[0]]), cross(DVec3(points[c[1]]), DVec3(points[c[2]]))) / 6;
    }
    return sum;
  };
  const double whole = volume(set.points);
  test::jitter(set, 0.005f, 4);
  const NodeNeighbours neighbours = node_neighbours(test::half_edges(set)).value();
  for (const SmoothingWeights weights : {SmoothingWeights::kUniform, SmoothingWeights::kCotangent}) {
    const auto plain =
        laplacian_smoothing(neighbours, set.points, {.iterations = 100, .weights = weights}).value();
    const auto taubin =
        laplacian_smoothing(neighbours, set.points, {.iterations = 50, .weights = weights, .mu = -0.53f})
            .value();
    CHECK(std::fabs(volume(taubin) / whole - 1) < 0.01);
    CHECK(volume(plain) / whole < 0.95);
    double before = 0, after = 0;
    for (std::size_t v = 0; v < taubin.size(); ++v) {
      before += std::pow(length(DVec3(set.points[v])) - 1, 2);
      after += std::pow(length(DVec3(taubin[v])) - 1, 2);
    }
    CHECK(after < before / 4);
  }
}

TEST_CASE("Taubin steps are a step by λ and a step by μ") {
  IndexedFaceSet set = test::cube();
  const NodeNeighbours neighbours = node_neighbours(test::half_edges(set)).value();
  const auto taubin =
      laplacian_smoothing(neighbours, set.points, {.lambda = 0.5f, .iterations = 1, .mu = -0.5f}).value();
  const auto half = laplacian_smoothing(neighbours, set.points, {.lambda = 0.5f, .iterations = 1}).value();
  for (std::uint32_t v = 0; v < 8; ++v) {
    DVec3 sum(0.0);
    const auto around = neighbours.of(VertexId(v));
    for (const std::uint32_t n : around) sum += DVec3(half[n]);
    const DVec3 expected = DVec3(half[v]) - 0.5 * (sum / static_cast<double>(around.size()) - DVec3(half[v]));
    CHECK(length(DVec3(taubin[v]) - expected) < 32 * 0x1p-24);
  }
}

TEST_CASE("smoothing: locked vertices stay, the boundary moves along itself") {
  IndexedFaceSet set = test::grid(8, 8);
  test::jitter(set, 0.1f, 3);
  const HalfEdgeMesh mesh = test::half_edges(set);
  const NodeNeighbours neighbours = node_neighbours(mesh).value();
  std::vector<std::uint32_t> locked(neighbours.boundary_bits.size(), 0u);
  for (const std::uint32_t v : {3u, 40u, 41u, 80u}) locked[v / 32] |= 1u << (v % 32);
  for (const SmoothingWeights weights : {SmoothingWeights::kUniform, SmoothingWeights::kCotangent}) {
    LaplacianSmoothingOptions options{.lambda = 0.4f,
                                      .iterations = 1,
                                      .boundary = SmoothingBoundary::kAlongItself,
                                      .weights = weights,
                                      .locked = locked};
    const auto smoothed = laplacian_smoothing(neighbours, set.points, options).value();
    options.locked = {};
    const auto unlocked = laplacian_smoothing(neighbours, set.points, options).value();
    for (std::uint32_t v = 0; v < smoothed.size(); ++v) {
      const bool is_locked = v == 3 || v == 40 || v == 41 || v == 80;
      CHECK(smoothed[v] == (is_locked ? set.points[v] : unlocked[v]));
      CHECK(unlocked[v] != set.points[v]);
    }
    for (const auto& loop : mesh.boundary_loops())
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::uint32_t v = mesh.origin(loop[i]).index;
        const DVec3 here(set.points[v]), next(set.points[mesh.target(loop[i]).index]),
            previous(set.points[mesh.origin(loop[(i + loop.size() - 1) % loop.size()]).index]);
        const DVec3 expected = here + static_cast<double>(0.4f) * (0.5 * (next + previous) - here);
        CHECK(length(DVec3(unlocked[v]) - expected) < 32 * 0x1p-24 * 12);
      }
  }
}

TEST_CASE("smoothing with λ = 1 puts each vertex on the mean of its neighbours") {
  IndexedFaceSet set = test::grid(2, 2);
  set.points[4] = Vec3(1.2f, 0.7f, 5.0f);
  const auto smoothed = laplacian_smoothing(node_neighbours(test::half_edges(set)).value(), set.points,
                                            {.lambda = 1.0f, .iterations = 1});
  REQUIRE(smoothed);
  CHECK(length(DVec3((*smoothed)[4]) - DVec3(1.0, 1.0, 0.0)) < 1e-6);
  for (const std::size_t v : {0u, 1u, 2u, 3u, 5u, 6u, 7u, 8u}) CHECK((*smoothed)[v] == set.points[v]);
}

TEST_CASE("smoothing: iterations compose, zero iterations change nothing, isolated vertices stay") {
  IndexedFaceSet set = test::icosphere(2);
  set.points.emplace_back(3.0f, 4.0f, 5.0f);
  const NodeNeighbours neighbours = node_neighbours(test::half_edges(set)).value();
  const auto three = laplacian_smoothing(neighbours, set.points, {.lambda = 0.4f, .iterations = 3}).value();
  auto one_by_one = set.points;
  for (int i = 0; i < 3; ++i)
    one_by_one = laplacian_smoothing(neighbours, one_by_one, {.lambda = 0.4f, .iterations = 1}).value();
  CHECK(three == one_by_one);
  CHECK(three.back() == set.points.back());
  CHECK(three != set.points);
  CHECK(laplacian_smoothing(neighbours, set.points, {.iterations = 0}).value() == set.points);
}

TEST_CASE("smoothing: each of many copies of a mesh, more than caches hold, goes the way of the mesh alone") {
  IndexedFaceSet set = test::icosphere(4);
  test::jitter(set, 0.03f, 5);
  set.points.emplace_back(3.0f, 4.0f, 5.0f);  // isolated: stays
  const NodeNeighbours one = node_neighbours(test::half_edges(set)).value();
  const std::size_t vertices = set.points.size(), copies = (std::size_t{1} << 20) / vertices + 1;
  NodeNeighbours many;
  std::vector<Vec3> positions;
  for (std::size_t copy = 0; copy < copies; ++copy) {
    const auto ids = static_cast<std::uint32_t>(many.ids.size());
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (std::size_t v = 0; v < vertices; ++v) many.offsets.push_back(ids + one.offsets[v]);
    for (const std::uint32_t id : one.ids) many.ids.push_back(first + id);
    positions.insert(positions.end(), set.points.begin(), set.points.end());
  }
  many.offsets.push_back(static_cast<std::uint32_t>(many.ids.size()));
  many.boundary_bits.assign((positions.size() + 31) / 32, 0);
  for (const std::uint32_t iterations : {1u, 2u}) {
    const LaplacianSmoothingOptions options = {.iterations = iterations};
    const auto expected = laplacian_smoothing(one, set.points, options).value();
    const auto smoothed = laplacian_smoothing(many, positions, options).value();
    REQUIRE(smoothed.size() == positions.size());
    std::size_t equal = 0;
    for (std::size_t i = 0; i < smoothed.size(); ++i) equal += smoothed[i] == expected[i % vertices];
    CHECK(equal == smoothed.size());
  }
}

TEST_CASE("smoothing shrinks a noisy sphere towards its middle and removes the noise") {
  IndexedFaceSet set = test::icosphere(4);
  test::jitter(set, 0.03f, 11);
  const auto spread = [](const std::vector<Vec3>& points) {
    double mean = 0, square = 0;
    for (const Vec3& p : points) mean += length(DVec3(p)) / static_cast<double>(points.size());
    for (const Vec3& p : points)
      square += std::pow(length(DVec3(p)) - mean, 2) / static_cast<double>(points.size());
    return std::pair(mean, std::sqrt(square));
  };
  const auto smoothed =
      laplacian_smoothing(node_neighbours(test::half_edges(set)).value(), set.points).value();
  CHECK(spread(smoothed).first < spread(set.points).first);
  CHECK(spread(smoothed).second < 0.3 * spread(set.points).second);
}

TEST_CASE("smoothing: λ out of range, wrong sizes and cancellation are errors") {
  const IndexedFaceSet set = test::cube();
  const NodeNeighbours neighbours = node_neighbours(test::half_edges(set)).value();
  for (const float lambda : {-0.1f, 1.1f, NAN})
    CHECK(laplacian_smoothing(neighbours, set.points, {.lambda = lambda}).error().code == ErrorCode::kUsage);
  for (const float mu : {0.1f, -1.1f, NAN})
    CHECK(laplacian_smoothing(neighbours, set.points, {.mu = mu}).error().code == ErrorCode::kUsage);
  const std::vector<std::uint32_t> locked(2, 0u);
  CHECK(laplacian_smoothing(neighbours, set.points, {.locked = locked}).error().code == ErrorCode::kUsage);
  CHECK(laplacian_smoothing(neighbours, std::span(set.points).first(7)).error().code == ErrorCode::kUsage);
  CHECK(laplacian_smoothing(neighbours, set.points, {}, [](double) { return false; }).error().code ==
        ErrorCode::kInterrupted);
}
