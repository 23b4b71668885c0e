// Swap scores against double precision, and against the circles of Delaunay triangulations.
#include <algorithm>
#include <array>
#include <cmath>

#include <catch2/catch.hpp>

#include <vkmesh/passes/swap_scores.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::cross;
using test::dot;
using test::length;

namespace {

constexpr SwapCriterion kCriteria[] = {SwapCriterion::kMinAngle, SwapCriterion::kAspectRatio};

double score_of(DVec3 a, DVec3 b, DVec3 c, SwapCriterion criterion) {
  const DVec3 area = cross(b - a, c - a);
  if (criterion == SwapCriterion::kAspectRatio)
    return 2 * std::sqrt(3.0) * length(area) / (dot(b - a, b - a) + dot(c - b, c - b) + dot(a - c, a - c));
  const auto angle = [](DVec3 at, DVec3 to, DVec3 other) {
    return std::acos(
        std::clamp(dot(to - at, other - at) / (length(to - at) * length(other - at)), -1.0, 1.0));
  };
  return std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
}

// An edge from p to q, and the corners opposite to it.
struct Quad {
  DVec3 p, q, left, right;

  Quad(const IndexedFaceSet& set, const HalfEdgeMesh& mesh, HalfEdgeId h) {
    const auto at = [&](HalfEdgeId of) { return DVec3(set.points[mesh.origin(of).index]); };
    p = at(h);
    q = at(mesh.twin(h));
    left = at(mesh.previous(h));
    right = at(mesh.previous(mesh.twin(h)));
  }
  [[nodiscard]] double gain(SwapCriterion criterion) const {
    return std::min(score_of(left, right, q, criterion), score_of(right, left, p, criterion)) -
           std::min(score_of(p, q, left, criterion), score_of(q, p, right, criterion));
  }
  // Cosine of the angle between the new triangle that faces away most and the two before.
  [[nodiscard]] double facing() const {
    const DVec3 before = cross(q - p, left - p) + cross(p - q, right - q);
    const auto cosine = [&](DVec3 area) { return dot(area, before) / (length(area) * length(before)); };
    return std::min(cosine(cross(right - left, q - left)), cosine(cross(left - right, p - right)));
  }
  // The longest of the six distances, in terms of the shortest.
  [[nodiscard]] double spread() const {
    const auto [least, most] = std::minmax({length(q - p), length(left - p), length(left - q),
                                            length(right - p), length(right - q), length(right - left)});
    return most / least;
  }
};

}  // namespace

TEST_CASE("swap scores agree with double precision, by angles and by shapes") {
  std::vector<IndexedFaceSet> shapes = {test::icosphere(4), test::torus(40, 20), test::grid(20, 15),
                                        test::cylinder(10, 12), test::fine_cube(6)};
  for (std::size_t i = 0; i < shapes.size(); ++i)
    test::jitter(shapes[i], i == 2 ? 0.25f : 0.03f, static_cast<std::uint32_t>(i));
  for (const SwapCriterion criterion : kCriteria) {
    std::size_t gains = 0, losses = 0, none = 0;
    for (const IndexedFaceSet& set : shapes) {
      const HalfEdgeMesh mesh = test::half_edges(set);
      const auto scores = swap_scores(mesh, set.points, criterion);
      REQUIRE(scores);
      REQUIRE(scores->size() == mesh.half_edge_count());
      mesh.for_each_edge([&](HalfEdgeId h) {
        const float score = (*scores)[h.index];
        if (mesh.is_boundary(h)) {
          CHECK(score == kNoSwap);
          return;
        }
        CHECK((*scores)[mesh.twin(h).index] == score);
        const Quad quad(set, mesh, h);
        // Products of two sides are good to 2^-21 of their lengths, which a shorter pair at another corner
        // sees as much larger; four triangles of a few of these each.
        const double tolerance = 32 * 0x1p-21 * quad.spread();
        if (std::fabs(quad.facing()) < tolerance * quad.spread()) return;
        if (quad.facing() < 0) {
          CHECK(score == kNoSwap);
          ++none;
          return;
        }
        const double expected = quad.gain(criterion);
        CHECK(std::fabs(double{score} - expected) < tolerance);
        (expected > 0 ? gains : losses) += 1;
      });
    }
    INFO(gains << " gains, " << losses << " losses, " << none << " that cannot be swapped");
    CHECK((gains > 100 && losses > 100 && none > 20));
  }
}

TEST_CASE("swap scores of known quadrilaterals") {
  IndexedFaceSet set;
  set.corners = {0, 1, 2, 1, 0, 3};
  const auto score = [&](SwapCriterion criterion) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    const auto scores = swap_scores(mesh, set.points, criterion).value();
    CHECK(std::count(scores.begin(), scores.end(), kNoSwap) >= 4);
    CHECK(scores[0] == scores[3]);
    return double{scores[0]};
  };
  // A rhombus across its long diagonal: from angles of atan 1/2 to twice that, area and sides by hand.
  set.points = {{0, 0, 0}, {4, 0, 0}, {2, 1, 0}, {2, -1, 0}};
  CHECK(score(SwapCriterion::kMinAngle) == Approx(std::atan(0.5)).epsilon(1e-6));
  CHECK(score(SwapCriterion::kAspectRatio) ==
        Approx(4 * std::sqrt(3.0) * (2.0 / 14 - 2.0 / 26)).epsilon(1e-6));
  // Two equilateral triangles: the best that there is, given away for 30 degrees less and a long side.
  const float high = std::sqrt(3.0f);
  set.points = {{-1, 0, 5}, {1, 0, 5}, {0, high, 5}, {0, -high, 5}};
  CHECK(score(SwapCriterion::kMinAngle) == Approx(-std::acos(-1.0) / 6).epsilon(1e-6));
  CHECK(score(SwapCriterion::kAspectRatio) ==
        Approx(4 * std::sqrt(3.0) * std::sqrt(3.0) / 20 - 1).epsilon(1e-6));
  // A square gains nothing.
  set.points = {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}};
  for (const SwapCriterion criterion : kCriteria) CHECK(std::fabs(score(criterion)) < 4 * 0x1p-23);
  // Not convex; three corners in one line; folded onto itself.
  for (const Vec3 right : {Vec3(-1, -3, 0), Vec3(0, -1, 0), Vec3(1, 3, 0)}) {
    set.points = {{0, 0, 0}, {4, 0, 0}, {0, 2, 0}, right};
    for (const SwapCriterion criterion : kCriteria) CHECK(score(criterion) == -4.0);
  }
}

TEST_CASE("swap scores in the plane: a gain in the least angle is a point in the circle") {
  IndexedFaceSet set = test::grid(30, 30);
  test::jitter(set, 0.45f, 12);
  for (Vec3& p : set.points) p.z = 0.0f;
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto scores = swap_scores(mesh, set.points).value();
  std::array<int, 2> in_circle{};
  int concave = 0;
  mesh.for_each_edge([&](HalfEdgeId h) {
    if (mesh.is_boundary(h)) return;
    const Quad quad(set, mesh, h);
    const auto turn = [](DVec3 a, DVec3 b, DVec3 c) { return cross(b - a, c - a).z; };
    // Triangles that the noise has flipped have no circle to speak of.
    if (turn(quad.p, quad.q, quad.left) < 1e-3 || turn(quad.q, quad.p, quad.right) < 1e-3) return;
    const double convex = std::min(turn(quad.left, quad.right, quad.q), turn(quad.right, quad.left, quad.p));
    if (std::fabs(convex) < 1e-3) return;
    if (convex < 0) {
      CHECK(scores[h.index] == kNoSwap);
      ++concave;
      return;
    }
    // The circle through p, q and left, lifted to the paraboloid about right.
    const auto lift = [&](DVec3 a) {
      const DVec3 d = a - quad.right;
      return DVec3(d.x, d.y, d.x * d.x + d.y * d.y);
    };
    const double inside = dot(lift(quad.p), cross(lift(quad.q), lift(quad.left)));
    if (std::fabs(inside) < 1e-3) return;
    CHECK((scores[h.index] > 0) == (inside > 0));
    ++in_circle[inside > 0 ? 1 : 0];
  });
  INFO(in_circle[0] << " outside, " << in_circle[1] << " inside, " << concave << " not convex");
  CHECK((in_circle[0] > 200 && in_circle[1] > 200 && concave > 50));
}

TEST_CASE("swap scores do not depend on the unit of length") {
  IndexedFaceSet set = test::torus(20, 12);
  test::jitter(set, 0.05f, 4);
  const HalfEdgeMesh mesh = test::half_edges(set);
  for (const SwapCriterion criterion : kCriteria) {
    const auto scores = swap_scores(mesh, set.points, criterion).value();
    for (const float unit : {0x1p-30f, 0x1p40f}) {
      std::vector<Vec3> scaled = set.points;
      for (Vec3& p : scaled) p *= unit;
      CHECK(swap_scores(mesh, scaled, criterion).value() == scores);
    }
  }
}

TEST_CASE("swap scores of degenerate meshes are numbers, and twins agree") {
  for (const auto& [name, set] : test::degenerate_shapes()) {
    INFO(name);
    for (const SwapCriterion criterion : kCriteria) {
      const HalfEdgeMesh mesh = test::half_edges(set);
      const auto scores = swap_scores(mesh, set.points, criterion).value();
      for (std::uint32_t h = 0; h < scores.size(); ++h) {
        CHECK((scores[h] == kNoSwap || (scores[h] >= -1.1f && scores[h] <= 1.1f)));
        if (mesh.twins()[h] != kInvalid) CHECK(scores[h] == scores[mesh.twins()[h]]);
      }
    }
  }
  CHECK(swap_scores(HalfEdgeMesh{}, {}).value().empty());
}

TEST_CASE("swap scores: errors") {
  const IndexedFaceSet set = test::cube(), quads = test::quad_cube();
  CHECK(swap_scores(test::half_edges(quads), quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(swap_scores(test::half_edges(set), std::span(set.points).first(7)).error().code == ErrorCode::kUsage);
}
