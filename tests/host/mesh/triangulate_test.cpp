#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/triangulate.h>

#include "support/data.h"
#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

using Polygon = std::vector<std::pair<double, double>>;

/// One face in a tilted plane, so that no coordinate is constant; or in z = 0 with its exact coordinates.
IndexedFaceSet face_of(const Polygon& polygon, bool tilted) {
  IndexedFaceSet mesh;
  for (const auto& [x, y] : polygon) {
    const DVec3 p = tilted ? DVec3(x, 0.6 * y + 0.2 * x, 0.8 * y - 0.3 * x) : DVec3(x, y, 0);
    mesh.corners.push_back(static_cast<std::uint32_t>(mesh.points.size()));
    mesh.points.emplace_back(p);
  }
  mesh.face_offsets = {0, static_cast<std::uint32_t>(polygon.size())};
  return mesh;
}

/// Twice the area vector of a polygon: half of what Newell's formula sums.
DVec3 area_vector(const IndexedFaceSet& mesh, std::span<const std::uint32_t> corners) {
  DVec3 sum(0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const DVec3 a(mesh.points[corners[i]]), b(mesh.points[corners[(i + 1) % corners.size()]]);
    sum += DVec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  }
  return sum;
}

IndexedFaceSet triangulated(const IndexedFaceSet& mesh) {
  auto result = triangulate(mesh);
  if (!result) FAIL(result.error().describe());
  REQUIRE(result->source_face.size() == result->mesh.face_count());
  return std::move(result->mesh);
}

/// A triangulation covers its polygon without overlap exactly when its triangles all turn the polygon's way
/// and their areas sum to the polygon's, and their edges are those of the polygon plus diagonals used once in
/// each direction.
void require_covers(const IndexedFaceSet& mesh, double smallest_area) {
  const std::size_t n = mesh.corners.size();
  const IndexedFaceSet out = triangulated(mesh);
  REQUIRE(out.is_triangles());
  REQUIRE(out.face_count() == n - 2);
  const DVec3 whole = area_vector(mesh, mesh.face(0));
  double total = 0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t f = 0; f < out.face_count(); ++f) {
    const auto corners = out.face(f);
    const DVec3 part = area_vector(out, corners);
    const double turned = (part.x * whole.x + part.y * whole.y + part.z * whole.z) / length(whole);
    CHECK(turned > smallest_area);
    total += length(part);
    for (std::size_t i = 0; i < 3; ++i) CHECK(edges.emplace(corners[i], corners[(i + 1) % 3]).second);
  }
  CHECK(total == Approx(length(whole)).epsilon(1e-5));
  for (std::size_t i = 0; i < n; ++i)
    CHECK(edges.erase({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>((i + 1) % n)}) == 1);
  for (const auto& [a, b] : edges) CHECK(edges.contains({b, a}));
}

Polygon star(int points) {
  Polygon p;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = std::numbers::pi * i / points, radius = i % 2 == 0 ? 1.0 : 0.3;
    p.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return p;
}

/// Two arms side by side, wound `turns` times.
Polygon spiral(int vertices, double turns) {
  Polygon p;
  const int half = vertices / 2;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < half; ++i) {
      const double t = static_cast<double>(side == 0 ? i : half - 1 - i) / (half - 1);
      const double angle = 2 * std::numbers::pi * turns * t, radius = 1 + turns * t + (side == 0 ? 0.5 : 0.0);
      p.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  return p;
}

}  // namespace

TEST_CASE("simple polygons are covered by ears", "[triangulate]") {
  const std::vector<Polygon> polygons = {
      {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
      {{0, 0}, {4, 0}, {1, 1}, {0, 4}},                                  // A concave quad.
      {{1, 1}, {0, 4}, {0, 0}, {4, 0}},                                  // The same from its concave corner.
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},                  // L
      {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}},  // U
      star(5),
      star(17),
      spiral(200, 3)};
  for (const Polygon& polygon : polygons)
    for (const bool tilted : {false, true}) {
      INFO(polygon.size() << " corners" << (tilted ? ", tilted" : ""));
      require_covers(face_of(polygon, tilted), 0);
      Polygon reversed(polygon.rbegin(), polygon.rend());
      require_covers(face_of(reversed, tilted), 0);
    }
}

TEST_CASE("large polygons are cut as small ones are", "[triangulate]") {
  // The same corners, so few that each is looked at, and so many that a tree finds those within an ear.
  require_covers(face_of(star(700), true), 0);
  require_covers(face_of(spiral(2000, 9), true), 0);
  std::mt19937 random(3);
  for (int round = 0; round < 10; ++round) {
    Polygon polygon;
    for (int i = 0; i < 400; ++i) {
      const double angle = 2 * std::numbers::pi * i / 400,
                   radius = 1 + static_cast<double>(random() % 1000) / 250;
      polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    require_covers(face_of(polygon, false), 0);
  }
  // A quadratic search takes minutes.
  const int count = test::kSanitized ? 20000 : 100000;
  CHECK(triangulated(face_of(star(count / 2), false)).face_count() == static_cast<std::size_t>(count) - 2);
  Polygon round;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    round.emplace_back(100 * std::cos(angle), 100 * std::sin(angle));
  }
  CHECK(triangulated(face_of(round, false)).face_count() == static_cast<std::size_t>(count) - 2);
}

TEST_CASE("which triangles a polygon becomes does not depend on its first corner", "[triangulate]") {
  const auto sorted_triangles = [](const IndexedFaceSet& mesh) {
    std::set<std::set<std::uint32_t>> found;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      found.insert({mesh.face(f)[0], mesh.face(f)[1], mesh.face(f)[2]});
    return found;
  };
  for (const Polygon& polygon : {Polygon{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, star(7), spiral(120, 3)}) {
    IndexedFaceSet mesh = face_of(polygon, true);
    const auto expected = sorted_triangles(triangulated(mesh));
    for (std::size_t first = 1; first < polygon.size(); ++first) {
      std::rotate(mesh.corners.begin(), mesh.corners.begin() + 1, mesh.corners.end());
      CHECK(sorted_triangles(triangulated(mesh)) == expected);
    }
  }
}

TEST_CASE("a diagonal that is an edge or another's diagonal is not cut along", "[triangulate]") {
  const auto edges_of = [](const IndexedFaceSet& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = mesh.face(f);
      for (std::size_t i = 0; i < corners.size(); ++i)
        ++uses[std::minmax(corners[i], corners[(i + 1) % corners.size()])];
    }
    return uses;
  };
  const auto largest = [&](const IndexedFaceSet& mesh) {
    int most = 0;
    for (const auto& [edge, count] : edges_of(mesh)) most = std::max(most, count);
    return most;
  };
  // Two quads that share two edges in a row, in every order of their corners, and with the edge that either
  // would be cut along in a triangle of its own.
  IndexedFaceSet pair;
  pair.points = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {-1, 2, 0}, {0.5f, 1, 1}, {0, 0, 3}};
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      std::vector<std::uint32_t> one = {0, 1, 2, 3}, two = {2, 1, 0, 4};
      std::rotate(one.begin(), one.begin() + a, one.end());
      std::rotate(two.begin(), two.begin() + b, two.end());
      pair.corners = one;
      pair.corners.insert(pair.corners.end(), two.begin(), two.end());
      pair.face_offsets = {0, 4, 8};
      CHECK(largest(triangulated(pair)) == 2);
      pair.corners.insert(pair.corners.end(), {0, 2, 5});
      pair.face_offsets.push_back(11);
      CHECK(largest(triangulated(pair)) == 2);
      pair.face_offsets.pop_back();
    }
  // Three quads on six points, of which no edge has three faces: where some choice of the diagonals gives no
  // edge more than two faces, the cut nearly always finds one.
  std::mt19937 random(11);
  int solvable = 0, free_of_conflict = 0;
  for (int round = 0; round < 3000; ++round) {
    IndexedFaceSet mesh;
    for (int p = 0; p < 6; ++p)
      mesh.points.emplace_back(static_cast<float>(random() % 100), static_cast<float>(random() % 100),
                               static_cast<float>(random() % 100));
    mesh.face_offsets = {0};
    for (int f = 0; f < 3; ++f) {
      std::vector<std::uint32_t> corners = {0, 1, 2, 3, 4, 5};
      std::shuffle(corners.begin(), corners.end(), random);
      mesh.corners.insert(mesh.corners.end(), corners.begin(), corners.begin() + 4);
      mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    if (largest(mesh) > 2) continue;
    int best = 9;
    for (int choice = 0; choice < 8; ++choice) {
      IndexedFaceSet cut;
      for (std::size_t f = 0; f < 3; ++f) {
        const auto c = mesh.face(f);
        if ((choice >> f & 1) != 0)
          cut.corners.insert(cut.corners.end(), {c[0], c[1], c[2], c[0], c[2], c[3]});
        else
          cut.corners.insert(cut.corners.end(), {c[1], c[2], c[3], c[1], c[3], c[0]});
      }
      best = std::min(best, largest(cut));
    }
    const int found = largest(triangulated(mesh));
    // One quad is cut after another: where only one choice of all at once is free, it may be missed.
    free_of_conflict += best <= 2 && found <= 2;
    solvable += best <= 2;
  }
  CHECK(solvable > 500);
  CHECK(free_of_conflict > 0.9 * solvable);
}

TEST_CASE("collinear corners make no triangle without area", "[triangulate]") {
  // Whole coordinates in z = 0 are exact, so the areas must be positive and not just no smaller than
  // rounding.
  require_covers(face_of({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}}, false), 0.5);
  require_covers(face_of({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, false), 0.5);
  require_covers(face_of({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}}, false), 0.5);
}

TEST_CASE("polygons without ears still give n - 2 triangles", "[triangulate]") {
  const std::vector<Polygon> polygons = {
      {{0, 0}, {1, 1}, {1, 0}, {0, 1}},                  // Crosses itself.
      {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}},          // No area at all.
      {{0, 0}, {0, 0}, {0, 0}, {0, 0}},                  // One point.
      {{0, 0}, {2, 0}, {2, 0}, {2, 2}, {2, 2}, {0, 2}},  // Corners repeated.
      {{0, 0}, {4, 0}, {2, 0}, {2, 2}, {2, 0}, {0, 3}}   // A spike.
  };
  for (const Polygon& polygon : polygons)
    CHECK(triangulated(face_of(polygon, false)).face_count() == polygon.size() - 2);
  // Random chains cross themselves everywhere.
  std::mt19937 random(7);
  for (std::size_t n = 4; n < 60; ++n) {
    Polygon polygon;
    for (std::size_t i = 0; i < n; ++i)
      polygon.emplace_back(static_cast<double>(random() % 16), static_cast<double>(random() % 16));
    CHECK(triangulated(face_of(polygon, false)).face_count() == n - 2);
  }
}

TEST_CASE("a polygon with a hole joined by a bridge keeps its area", "[triangulate]") {
  IndexedFaceSet mesh = face_of({{0, 0}, {6, 0}, {6, 6}, {0, 6}, {2, 4}, {4, 4}, {4, 2}, {2, 2}}, false);
  mesh.corners = {0, 1, 2, 3, 4, 5, 6, 7, 4, 3};
  mesh.face_offsets = {0, 10};
  const IndexedFaceSet out = triangulated(mesh);
  REQUIRE(out.face_count() == 8);
  double total = 0;
  for (std::size_t f = 0; f < 8; ++f) {
    const double z = area_vector(out, out.face(f)).z;
    CHECK(z >= 0);
    total += z / 2;
  }
  CHECK(total == 36 - 4);
}

TEST_CASE("a polygon that is not planar is cut by its projection", "[triangulate]") {
  IndexedFaceSet mesh = face_of(star(9), false);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) mesh.points[i].z = i % 3 == 0 ? 0.2f : -0.1f;
  const IndexedFaceSet out = triangulated(mesh);
  REQUIRE(out.face_count() == 16);
  double total = 0;
  for (std::size_t f = 0; f < out.face_count(); ++f) {
    const double z = area_vector(out, out.face(f)).z;
    CHECK(z > 0);
    total += z;
  }
  CHECK(total == Approx(area_vector(mesh, mesh.face(0)).z).epsilon(1e-5));
}

TEST_CASE("faces keep their order, and channels follow", "[triangulate]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0.5f, 0}};
  mesh.corners = {1, 4, 2, 0, 1, 2, 3};
  mesh.face_offsets = {0, 3, 7};
  mesh.point_channels = {{"quality", 1, std::vector<float>{1, 2, 3, 4, 5}}};
  mesh.corner_channels = {
      {"uv", 2, std::vector<float>{0, .1f, 1, .1f, 2, .1f, 3, .2f, 4, .2f, 5, .2f, 6, .2f}}};
  mesh.face_channels = {{"part", 1, std::vector<std::int32_t>{-7, 9}}};
  const auto result = triangulate(mesh);
  REQUIRE(result);
  const IndexedFaceSet& out = result->mesh;
  CHECK(out.corners == std::vector<std::uint32_t>{1, 4, 2, 0, 1, 2, 0, 2, 3});
  CHECK(result->source_face == std::vector<std::uint32_t>{0, 1, 1});
  CHECK(out.points == mesh.points);
  CHECK(out.point_channels[0].values == mesh.point_channels[0].values);
  CHECK(out.face_channels[0].values == ChannelValues(std::vector<std::int32_t>{-7, 9, 9}));
  CHECK(out.corner_channels[0].values ==
        ChannelValues(
            std::vector<float>{0, .1f, 1, .1f, 2, .1f, 3, .2f, 4, .2f, 5, .2f, 3, .2f, 5, .2f, 6, .2f}));

  const auto same = triangulate(icosphere(1));
  REQUIRE(same);
  CHECK(same->mesh.corners == icosphere(1).corners);
  CHECK(same->source_face.back() == 79);
}
