// The passes against textbook formulas in double precision, written without regard to their order of
// operations.
#include <cmath>
#include <map>
#include <numbers>

#include <catch2/catch.hpp>

#include <vkmesh/node_neighbours.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/vertex_normals.h>

#include "support/shapes.h"

using namespace vkmesh;

namespace {

DVec3 cross(DVec3 a, DVec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(DVec3 a, DVec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
double length(DVec3 a) {
  return std::sqrt(dot(a, a));
}

DVec3 area_of(const IndexedFaceSet& mesh, std::size_t f) {
  const auto c = mesh.face(f);
  const DVec3 p(mesh.points[c[0]]), q(mesh.points[c[1]]), r(mesh.points[c[2]]);
  return cross(q - p, r - p);
}

std::vector<IndexedFaceSet> noisy_shapes() {
  std::vector<IndexedFaceSet> shapes = {test::icosphere(4), test::torus(40, 20), test::grid(20, 15),
                                        test::cylinder(10, 12), test::cube()};
  for (std::size_t i = 0; i < shapes.size(); ++i)
    test::jitter(shapes[i], 0.02f, static_cast<std::uint32_t>(i));
  return shapes;
}

}  // namespace

TEST_CASE("vertex normals agree with double precision") {
  for (const IndexedFaceSet& set : noisy_shapes()) {
    const auto normals = vertex_normals(test::half_edges(set), set.points);
    REQUIRE(normals);
    std::vector<DVec3> expected(set.points.size(), DVec3(0.0));
    std::vector<double> magnitude(set.points.size(), 0.0);
    for (std::size_t f = 0; f < set.face_count(); ++f)
      for (const std::uint32_t v : set.face(f)) {
        expected[v] += area_of(set, f);
        magnitude[v] += length(area_of(set, f));
      }
    for (std::size_t v = 0; v < expected.size(); ++v) {
      // Each area vector carries a few roundings of its products, at most 2^-21 of |a||b|, which these shapes
      // bound by four times the area; summing and normalising add as much again. Cancellation in the sum
      // magnifies it.
      const double tolerance = 16 * 0x1p-21 * magnitude[v] / length(expected[v]);
      CHECK(length(DVec3((*normals)[v]) - expected[v] / length(expected[v])) < tolerance);
    }
  }
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
  const auto normals = vertex_normals(test::half_edges(set), set.points);
  REQUIRE(normals);
  for (const Vec3& n : *normals) CHECK(n == Vec3(0.0f));
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
    for (const bool fix : {true, false}) {
      const auto smoothed =
          laplacian_smoothing(neighbours, set.points, {.lambda = 0.3f, .iterations = 1, .fix_boundary = fix});
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
      const double expected = std::atan2(length(cross(a, b)), dot(a, b));
      // The direction of each normal is good to 16 · 2^-21 (see above).
      CHECK(std::fabs(angles.half_edge[h] - expected) < 32 * 0x1p-21);
      for (const VertexId v : {mesh.origin(HalfEdgeId(h)), mesh.target(HalfEdgeId(h))})
        maximum[v.index] = std::max(maximum[v.index], expected);
    }
    for (std::size_t v = 0; v < maximum.size(); ++v)
      CHECK(std::fabs(angles.vertex_maximum[v] - maximum[v]) < 32 * 0x1p-21);
  }
}

TEST_CASE("passes take triangles only, and one position for each vertex") {
  const IndexedFaceSet quads = test::quad_cube();
  const HalfEdgeMesh mesh = test::half_edges(quads);
  CHECK(vertex_normals(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(dihedral_angles(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  const IndexedFaceSet cube = test::cube();
  CHECK(vertex_normals(test::half_edges(cube), std::span(cube.points).first(5)).error().code ==
        ErrorCode::kUsage);
}
