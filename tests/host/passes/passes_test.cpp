// The passes against textbook formulas in double precision, written without regard to their order of
// operations.
#include <cmath>
#include <map>
#include <numbers>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/surface_measures.h>
#include <vkmesh/passes/triangle_normals.h>
#include <vkmesh/passes/vertex_normals.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::area_of;
using test::cross;
using test::dot;
using test::length;

namespace {

std::vector<IndexedFaceSet> noisy_shapes() {
  std::vector<IndexedFaceSet> shapes = {test::icosphere(4), test::torus(40, 20), test::grid(20, 15),
                                        test::cylinder(10, 12), test::cube()};
  for (std::size_t i = 0; i < shapes.size(); ++i)
    test::jitter(shapes[i], 0.02f, static_cast<std::uint32_t>(i));
  return shapes;
}

}  // namespace

// The angle of face f at its corner i.
double angle_of(const IndexedFaceSet& mesh, std::size_t f, std::size_t i) {
  const auto c = mesh.face(f);
  const DVec3 p(mesh.points[c[i]]), a = DVec3(mesh.points[c[(i + 1) % 3]]) - p,
                                    b = DVec3(mesh.points[c[(i + 2) % 3]]) - p;
  return std::acos(dot(a, b) / (length(a) * length(b)));
}

TEST_CASE("triangle normals agree with double precision, and are zero without area") {
  for (const IndexedFaceSet& set : noisy_shapes()) {
    const auto normals = triangle_normals(test::half_edges(set), set.points);
    REQUIRE(normals);
    REQUIRE(normals->size() == set.face_count());
    // As for vertex normals below.
    for (std::size_t f = 0; f < set.face_count(); ++f)
      CHECK(length(DVec3((*normals)[f]) - area_of(set, f) / length(area_of(set, f))) < 16 * 0x1p-21);
  }
  IndexedFaceSet line = test::grid(1, 1);
  for (Vec3& p : line.points) p = Vec3(p.x, p.x, p.x);
  const auto none = triangle_normals(test::half_edges(line), line.points);
  REQUIRE(none);
  for (const Vec3& n : *none) CHECK(n == Vec3(0.0f));
}

TEST_CASE("vertex normals agree with double precision, by area, by angle and uniform") {
  for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform})
    for (const IndexedFaceSet& set : noisy_shapes()) {
      const auto normals = vertex_normals(test::half_edges(set), set.points, {.weights = weights});
      REQUIRE(normals);
      std::vector<DVec3> expected(set.points.size(), DVec3(0.0));
      std::vector<double> magnitude(set.points.size(), 0.0);
      for (std::size_t f = 0; f < set.face_count(); ++f)
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t v = set.face(f)[i];
          const DVec3 area = area_of(set, f);
          const double weight = weights == NormalWeights::kArea    ? 1.0
                                : weights == NormalWeights::kAngle ? angle_of(set, f, i) / length(area)
                                                                   : 1.0 / length(area);
          expected[v] += weight * area;
          magnitude[v] += weight * length(area);
        }
      for (std::size_t v = 0; v < expected.size(); ++v) {
        // Each area vector carries a few roundings of its products, at most 2^-21 of |a||b|, which these
        // shapes bound by four times the area; summing and normalising add as much again. Cancellation in the
        // sum magnifies it.
        const double tolerance = 16 * 0x1p-21 * magnitude[v] / length(expected[v]);
        CHECK(length(DVec3((*normals)[v]) - expected[v] / length(expected[v])) < tolerance);
      }
    }
}

TEST_CASE("vertex normals at the corners of a cube: by angle the diagonals, however its sides are cut") {
  const IndexedFaceSet set = test::cube();
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto apart = [&](NormalWeights weights) {
    const auto normals = vertex_normals(mesh, set.points, {.weights = weights}).value();
    double most = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
      const DVec3 diagonal = DVec3(set.points[v]) - DVec3(0.5);
      most = std::max(most, length(DVec3(normals[v]) - diagonal / length(diagonal)));
    }
    return most;
  };
  // Angles of 45 and 90 degrees, and unit vectors, to a few ULP each.
  CHECK(apart(NormalWeights::kAngle) < 8 * 0x1p-23);
  CHECK(apart(NormalWeights::kArea) > 0.1);
  CHECK(apart(NormalWeights::kUniform) > 0.1);
}

TEST_CASE("vertex normals of a sphere point outward") {
  const IndexedFaceSet set = test::icosphere(5);
  const auto normals = vertex_normals(test::half_edges(set), set.points);
  REQUIRE(normals);
  // Area weights deviate from the true normal with the mesh's irregularity: first order in the edge length,
  // 0.035.
  for (std::size_t v = 0; v < set.points.size(); ++v)
    CHECK(length(DVec3((*normals)[v]) - DVec3(set.points[v])) < 0.01);
}

TEST_CASE("vertex normals are zero where no direction is defined") {
  IndexedFaceSet set = test::grid(1, 1);
  set.points.emplace_back(7.0f, 7.0f, 7.0f);  // isolated
  for (Vec3& p : set.points) p.x = 1.0f;      // all in one line's plane: still areas
  for (std::size_t i = 0; i < 4; ++i) set.points[i] = Vec3(1.0f, 2.0f, 3.0f);  // and now none
  for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform}) {
    const auto normals = vertex_normals(test::half_edges(set), set.points, {.weights = weights});
    REQUIRE(normals);
    for (const Vec3& n : *normals) CHECK(n == Vec3(0.0f));
  }
}

TEST_CASE("vertex normals do not depend on the unit of length, from nanometres to light years") {
  IndexedFaceSet set = test::icosphere(3);
  test::jitter(set, 0.05f, 9);
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto normals = vertex_normals(mesh, set.points);
  for (const float unit : {0x1p-30f, 0x1p-10f, 0x1p40f}) {
    std::vector<Vec3> scaled = set.points;
    for (Vec3& p : scaled) p *= unit;
    CHECK(vertex_normals(mesh, scaled).value() == normals.value());
  }
}

TEST_CASE("one smoothing step agrees with double precision") {
  for (const IndexedFaceSet& set : noisy_shapes()) {
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

TEST_CASE("one smoothing step by cotangents agrees with double precision") {
  for (const IndexedFaceSet& set : noisy_shapes()) {
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

TEST_CASE("dihedral angles of known solids") {
  const double pi = std::numbers::pi;
  SECTION("cube: right angles at its edges, flat across each side") {
    const IndexedFaceSet set = test::cube();
    const HalfEdgeMesh mesh = test::half_edges(set);
    const DihedralAngles angles = dihedral_angles(mesh, set.points).value();
    int right = 0, flat = 0;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      CHECK(angles.half_edge[h] == angles.half_edge[mesh.twins()[h]]);
      right += std::fabs(angles.half_edge[h] - pi / 2) < 1e-6;
      flat += angles.half_edge[h] == 0.0f;
    }
    CHECK(right == 24);
    CHECK(flat == 12);
    for (const float m : angles.vertex_maximum) CHECK(std::fabs(m - pi / 2) < 1e-6);
  }
  SECTION("regular tetrahedron: its normals are π − arccos(1/3) apart") {
    const IndexedFaceSet set = test::tetrahedron();  // coordinates of six digits
    const DihedralAngles angles = dihedral_angles(test::half_edges(set), set.points).value();
    for (const float a : angles.half_edge) CHECK(std::fabs(a - (pi - std::acos(1.0 / 3.0))) < 1e-5);
  }
  SECTION("grid: flat inside and on the boundary") {
    const IndexedFaceSet set = test::grid(3, 2);
    const DihedralAngles angles = dihedral_angles(test::half_edges(set), set.points).value();
    for (const float a : angles.half_edge) CHECK(a == 0.0f);
    for (const float m : angles.vertex_maximum) CHECK(m == 0.0f);
  }
}

TEST_CASE("dihedral angles agree with double precision") {
  for (const IndexedFaceSet& set : noisy_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const DihedralAngles angles = dihedral_angles(mesh, set.points).value();
    std::vector<double> maximum(set.points.size(), 0.0);
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      if (mesh.twins()[h] == kInvalid) {
        CHECK(angles.half_edge[h] == 0.0f);
        continue;
      }
      const DVec3 a = area_of(set, h / 3), b = area_of(set, mesh.twins()[h] / 3);
      const double angle = std::atan2(length(cross(a, b)), dot(a, b));
      // Concave: the other face's far corner lies above this one's plane.
      const std::uint32_t t = mesh.twins()[h];
      const auto far = mesh.origins()[3 * (t / 3) + (t + 2) % 3];
      const DVec3 here(set.points[mesh.origins()[h]]);
      const double expected = dot(a, DVec3(set.points[far]) - here) > 0 ? -angle : angle;
      // The direction of each normal is good to 16 · 2^-21 (see above).
      CHECK(std::fabs(angles.half_edge[h] - expected) < 32 * 0x1p-21);
      for (const VertexId v : {mesh.origin(HalfEdgeId(h)), mesh.target(HalfEdgeId(h))})
        maximum[v.index] = std::max(maximum[v.index], angle);
    }
    for (std::size_t v = 0; v < maximum.size(); ++v)
      CHECK(std::fabs(angles.vertex_maximum[v] - maximum[v]) < 32 * 0x1p-21);
  }
}

TEST_CASE("area, volume, centroid and bounds agree with double precision, wherever the mesh lies") {
  std::vector<IndexedFaceSet> shapes = noisy_shapes();
  shapes.push_back(test::double_torus());
  for (const IndexedFaceSet& shape : shapes)
    for (const Vec3 offset : {Vec3(0.0f), Vec3(-3, 5, 20)}) {
      IndexedFaceSet set = shape;
      for (Vec3& p : set.points) p += offset;
      DVec3 low(set.points[0]), high = low;
      for (const Vec3& p : set.points)
        for (int k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], double{p[k]});
          high[k] = std::max(high[k], double{p[k]});
        }
      const DVec3 centre = 0.5 * (low + high);
      double area = 0, volume = 0;
      DVec3 moment(0.0);
      for (std::size_t f = 0; f < set.face_count(); ++f) {
        const auto c = set.face(f);
        const DVec3 p(set.points[c[0]]), q(set.points[c[1]]), r(set.points[c[2]]);
        area += length(area_of(set, f)) / 2;
        volume += dot(p - centre, area_of(set, f)) / 6;
        moment += length(area_of(set, f)) / 6 * (p + q + r);
      }
      const auto found = surface_measures(test::half_edges(set), set.points);
      REQUIRE(found);
      CHECK(DVec3(found->low) == low);
      CHECK(DVec3(found->high) == high);
      // Corners are rounded to 2^-24 of the extent, a part of a triangle's size as large as the mesh is fine;
      // sums take 64 roundings a level at most. Volumes cancel against that of the bounding box.
      const double extent = length(high - low);
      CHECK(std::fabs(found->area / area - 1) < 64 * 0x1p-23);
      CHECK(std::fabs(found->volume - volume) < 64 * 0x1p-23 * area * extent);
      CHECK(length(found->centroid - moment / area) < 64 * 0x1p-23 * extent);
    }
}

TEST_CASE("area, volume and centroid of known solids, of any size; of nothing they are 0") {
  for (const float unit : {1.0f, 0x1p-40f, 0x1p50f}) {
    IndexedFaceSet set = test::cube();
    for (Vec3& p : set.points) p *= unit;
    const SurfaceMeasures cube = surface_measures(test::half_edges(set), set.points).value();
    const double u = unit;
    CHECK(cube.area == 6.0 * u * u);
    CHECK(std::fabs(cube.volume - u * u * u) < 4 * 0x1p-24 * u * u * u);
    CHECK(cube.centroid == DVec3(0.5 * u));
    CHECK((cube.low == Vec3(0.0f) && cube.high == Vec3(unit)));
  }
  IndexedFaceSet set = test::cube();
  for (std::size_t f = 0; f < set.face_count(); ++f) std::swap(set.corners[3 * f], set.corners[3 * f + 1]);
  CHECK(surface_measures(test::half_edges(set), set.points).value().volume < -0.99);
  for (Vec3& p : set.points) p = Vec3(2.0f);
  const SurfaceMeasures point = surface_measures(test::half_edges(set), set.points).value();
  CHECK((point.area == 0.0 && point.volume == 0.0 && point.centroid == DVec3(2.0)));
  const SurfaceMeasures nothing = surface_measures(HalfEdgeMesh{}, {}).value();
  CHECK((nothing.area == 0.0 && nothing.volume == 0.0 && nothing.high == Vec3(0.0f)));
}

TEST_CASE("passes take triangles only, and one position for each vertex") {
  const IndexedFaceSet quads = test::quad_cube();
  const HalfEdgeMesh mesh = test::half_edges(quads);
  CHECK(vertex_normals(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(dihedral_angles(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(triangle_normals(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(surface_measures(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  const IndexedFaceSet cube = test::cube();
  CHECK(vertex_normals(test::half_edges(cube), std::span(cube.points).first(5)).error().code ==
        ErrorCode::kUsage);
}

TEST_CASE("normals into memory of the caller are those of their own, whatever it held") {
  const IndexedFaceSet set = noisy_shapes().front();
  const HalfEdgeMesh sphere = test::half_edges(set);
  const Vec3 before(7.0f);
  std::vector<Vec3> at_faces(sphere.face_count(), before), at_vertices(sphere.vertex_count(), before);
  CHECK(triangle_normals(sphere, set.points, std::span(at_faces).first(5)).error().code == ErrorCode::kUsage);
  CHECK(vertex_normals(sphere, set.points, std::span(at_vertices).first(5)).error().code ==
        ErrorCode::kUsage);
  CHECK((at_faces[0] == before && at_vertices[0] == before));
  REQUIRE(triangle_normals(sphere, set.points, at_faces));
  CHECK(at_faces == triangle_normals(sphere, set.points).value());
  for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform}) {
    REQUIRE(vertex_normals(sphere, set.points, at_vertices, {weights}));
    CHECK(at_vertices == vertex_normals(sphere, set.points, {weights}).value());
  }
}
