#include "decimation/legality/hausdorff_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

namespace vkmesh::detail {
namespace {

using Faces = std::vector<LocalChange::Face>;

/// Triangles from `apex` to the sides of a polygon.
Faces fan(const std::vector<DVec3>& ring, const DVec3& apex) {
  Faces faces;
  for (std::size_t i = 0; i < ring.size(); ++i)
    faces.push_back({{apex, ring[i], ring[(i + 1) % ring.size()]}, static_cast<std::uint32_t>(i)});
  return faces;
}

double distance(const DVec3& p, const Faces& faces) {
  double least2 = std::numeric_limits<double>::infinity();
  for (const LocalChange::Face& face : faces) least2 = std::min(least2, squared_distance(p, face.corner));
  return std::sqrt(least2);
}

/// The largest over points on a face in a grid.
double farthest(const LocalChange::Face& face, const Faces& faces) {
  constexpr int kSteps = 40;
  double most = 0;
  const auto& [a, b, c] = face.corner;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j + i <= kSteps; ++j)
      most = std::max(most,
                      distance(a + (b - a) * (i / double{kSteps}) + (c - a) * (j / double{kSteps}), faces));
  return most;
}

/// By face of `from` the largest distance that is told.
std::vector<double> bounds(const Faces& from, const Faces& to) {
  std::vector<double> most(from.size(), -1);
  Overlay overlay;
  CHECK(overlay.cut(from, to, {0, 0, 1}, [&](std::size_t i, std::size_t j, double d) {
    REQUIRE(i < from.size());
    REQUIRE(j < to.size());
    most[i] = std::max(most[i], d);
    return true;
  }));
  return most;
}

std::vector<DVec3> random_ring(std::mt19937& random, std::size_t n, double bumps) {
  std::uniform_real_distribution<double> radius(0.6, 1.0), height(-bumps, bumps);
  std::vector<DVec3> ring;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(n),
                 r = radius(random);
    ring.emplace_back(r * std::cos(angle), r * std::sin(angle), height(random));
  }
  return ring;
}

TEST_CASE("overlay: what it tells is a bound, and a good one where both surfaces are graphs", "[decimate]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.3, 0.3);
  double told = 0, measured = 0;
  for (int round = 0; round < 60; ++round) {
    const std::vector<DVec3> ring = random_ring(random, 3 + static_cast<std::size_t>(round % 7), 0.1);
    const Faces one = fan(ring, {place(random), place(random), place(random) / 3}),
                other = fan(ring, {place(random), place(random), place(random) / 3});
    const std::vector<double> forth = bounds(one, other);
    for (std::size_t i = 0; i < one.size(); ++i) {
      const double sampled = farthest(one[i], other);
      CAPTURE(round, i);
      CHECK(forth[i] >= sampled * (1 - 1e-12));
      told += forth[i];
      measured += sampled;
    }
  }
  // The nearest point is often of another face than that below: a third is given away.
  CHECK(told < 1.35 * measured);
}

TEST_CASE("overlay: surfaces in one plane do not lie apart, however they are cut", "[decimate]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.2, 0.2);
  for (int round = 0; round < 40; ++round) {
    const std::vector<DVec3> ring = random_ring(random, 3 + static_cast<std::size_t>(round % 9), 0.0);
    const Faces one = fan(ring, {place(random), place(random), 0}),
                other = fan(ring, {place(random), place(random), 0});
    for (const double d : bounds(one, other)) CHECK(d < 1e-7);
  }
}

TEST_CASE("overlay: a bound where a surface folds, stands upright or has no area", "[decimate]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 60; ++round) {
    std::vector<DVec3> ring;
    for (int i = 0; i < 3 + round % 6; ++i) ring.emplace_back(any(random), any(random), any(random));
    if (round % 4 == 0) ring[1] = ring[0];
    const Faces one = fan(ring, {any(random), any(random), any(random)}),
                other =
                    round % 3 == 0 ? fan(ring, ring[2]) : fan(ring, {any(random), any(random), any(random)});
    const std::vector<double> forth = bounds(one, other);
    for (std::size_t i = 0; i < one.size(); ++i) CHECK(forth[i] >= farthest(one[i], other) * (1 - 1e-12));
  }
}

TEST_CASE("overlay: stops when it is told to", "[decimate]") {
  const Faces one = fan({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0.2, 0.2, 0.5});
  int calls = 0;
  CHECK_FALSE(
      Overlay().cut(one, one, {0, 0, 1}, [&](std::size_t, std::size_t, double) { return ++calls < 2; }));
  CHECK(calls == 2);
}

}  // namespace
}  // namespace vkmesh::detail
