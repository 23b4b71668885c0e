#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/repair/weld.h>

#include "support/shapes.h"

using namespace vkmesh;

TEST_CASE("welding numbers points by first appearance", "[weld]") {
  PolygonSoup soup;
  soup.corners = {{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 1, 0}, {-0.0f, 0, -0.0f}, {0, 0, 1}};
  soup.face_channels = {{"attribute", 1, std::vector<std::uint16_t>{3, 4}}};
  const auto mesh = weld(soup);
  REQUIRE(mesh);
  CHECK(mesh->points == std::vector<Vec3>{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  CHECK(mesh->corners == std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3});
  CHECK(mesh->is_triangles());
  REQUIRE(mesh->face_channels.size() == 1);
  CHECK(mesh->face_channels[0].values == soup.face_channels[0].values);
}

TEST_CASE("welding is exact", "[weld]") {
  PolygonSoup soup;
  const float next = std::nextafter(1.0f, 2.0f);
  soup.corners = {{1, 1, 1}, {next, 1, 1}, {1, next, 1}, {1, 1, next}};
  soup.face_offsets = {0, 4};
  const auto mesh = weld(soup);
  REQUIRE(mesh);
  CHECK(mesh->points == soup.corners);
  CHECK(mesh->face_offsets == soup.face_offsets);
}

TEST_CASE("welding a soup of many corners agrees with an ordered map", "[weld]") {
  IndexedFaceSet shape = test::torus(60, 50);
  PolygonSoup soup;
  for (const std::uint32_t c : shape.corners) soup.corners.push_back(shape.points[c]);
  const auto mesh = weld(soup);
  REQUIRE(mesh);
  std::map<std::tuple<float, float, float>, std::uint32_t> seen;
  std::vector<std::uint32_t> expected;
  for (const Vec3& p : soup.corners)
    expected.push_back(
        seen.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(seen.size())).first->second);
  CHECK(mesh->corners == expected);
  CHECK(mesh->points.size() == seen.size());
  for (std::size_t c = 0; c < soup.corners.size(); ++c)
    REQUIRE(mesh->points[mesh->corners[c]] == soup.corners[c]);
}

TEST_CASE("an empty soup welds to an empty mesh", "[weld]") {
  const auto mesh = weld(PolygonSoup{});
  REQUIRE(mesh);
  CHECK(mesh->points.empty());
  CHECK(mesh->face_count() == 0);
}

namespace {

Welded welded(const IndexedFaceSet& mesh, const WeldOptions& options = {}) {
  auto result = weld(mesh, options);
  if (!result) FAIL(result.error().describe());
  return *std::move(result);
}

/// Points of a lattice, each several times with small moves.
IndexedFaceSet noisy_lattice(std::mt19937& random, float noise) {
  IndexedFaceSet mesh;
  const auto shake = [&] { return noise * (static_cast<float>(random() % 1001) / 500.0f - 1.0f); };
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y)
      for (int z = 0; z < 6; ++z)
        for (int copy = 0; copy < 4; ++copy)
          mesh.points.emplace_back(static_cast<float>(x) + shake(), static_cast<float>(y) + shake(),
                                   static_cast<float>(z) + shake());
  return mesh;
}

/// Which points hang together, by comparing all pairs.
std::vector<std::uint32_t> clusters_of(const IndexedFaceSet& mesh, double tolerance) {
  std::vector<std::uint32_t> cluster(mesh.points.size());
  for (std::uint32_t p = 0; p < cluster.size(); ++p) cluster[p] = p;
  for (bool again = true; again;) {
    again = false;
    for (std::size_t p = 0; p < cluster.size(); ++p)
      for (std::size_t q = 0; q < p; ++q) {
        const DVec3 d = DVec3(mesh.points[p]) - DVec3(mesh.points[q]);
        if (cluster[p] == cluster[q] || d.x * d.x + d.y * d.y + d.z * d.z > tolerance * tolerance) continue;
        const std::uint32_t from = std::max(cluster[p], cluster[q]), to = std::min(cluster[p], cluster[q]);
        for (std::uint32_t& c : cluster)
          if (c == from) c = to;
        again = true;
      }
  }
  return cluster;
}

}  // namespace

TEST_CASE("welding within a tolerance agrees with comparing all pairs", "[weld]") {
  std::mt19937 random(7);
  for (const double tolerance : {0.01, 0.05, 0.2, 0.7, 1.2, 20.0}) {
    CAPTURE(tolerance);
    const IndexedFaceSet mesh = noisy_lattice(random, 0.06f);
    const Welded result = welded(mesh, {Length::absolute(tolerance)});
    const std::vector<std::uint32_t> expected = clusters_of(mesh, tolerance);
    std::map<std::uint32_t, std::uint32_t> name;
    std::map<std::uint32_t, Vec3> lowest;
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      const auto [it, fresh] = name.try_emplace(expected[p], static_cast<std::uint32_t>(name.size()));
      REQUIRE(result.point_of[p] == it->second);
      Vec3& low = lowest.try_emplace(expected[p], mesh.points[p]).first->second;
      if (std::tie(mesh.points[p].x, mesh.points[p].y, mesh.points[p].z) < std::tie(low.x, low.y, low.z))
        low = mesh.points[p];
    }
    CHECK(result.merged_points == mesh.points.size() - name.size());
    double largest = 0;
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      REQUIRE(result.mesh.points[result.point_of[p]] == lowest.at(expected[p]));
      const DVec3 d = DVec3(mesh.points[p]) - DVec3(lowest.at(expected[p]));
      largest = std::max(largest, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
    }
    CHECK(result.largest_move == largest);
  }
}

TEST_CASE("welding does not depend on the order of the points", "[weld]") {
  std::mt19937 random(8);
  const IndexedFaceSet mesh = noisy_lattice(random, 0.06f);
  std::vector<std::uint32_t> order(mesh.points.size());
  for (std::uint32_t p = 0; p < order.size(); ++p) order[p] = p;
  std::shuffle(order.begin(), order.end(), random);
  IndexedFaceSet shuffled;
  for (const std::uint32_t p : order) shuffled.points.push_back(mesh.points[p]);
  const Welded a = welded(mesh, {Length::absolute(0.1)}), b = welded(shuffled, {Length::absolute(0.1)});
  for (std::size_t i = 0; i < order.size(); ++i)
    REQUIRE(b.mesh.points[b.point_of[i]] == a.mesh.points[a.point_of[order[i]]]);
  CHECK(a.merged_points == b.merged_points);
}

TEST_CASE("a relative tolerance is a share of the diagonal", "[weld]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {3, 4, 0}, {0.04f, 0, 0}, {0.06f, 4, 0}};  // Diagonal 5.
  CHECK(welded(mesh, {Length::relative(0.009)}).merged_points == 1);
  CHECK(welded(mesh, {Length::relative(0.007)}).merged_points == 0);
}

TEST_CASE("tolerances far below the extent find their neighbours still", "[weld]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1e-20f, 0, 0}, {3e-20f, 0, 0}, {1e20f, 0, 0}, {-1e20f, 1e20f, 5}};
  const Welded result = welded(mesh, {Length::absolute(1.5e-20)});
  CHECK(result.point_of == std::vector<std::uint32_t>{0, 0, 1, 2, 3});
}

TEST_CASE("attributes: equal values stay with points, different ones become seams of corners", "[weld]") {
  // Two triangles side by side that share no points.
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}};
  mesh.corners = {0, 1, 2, 3, 4, 5};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.point_channels = {{"same", 1, std::vector<float>{0, 1, nan, nan, 1, 5}},
                         {"uv", 2, std::vector<float>{0, 0, 1, 0, 0, 1, 9, 9, 8, 8, 7, 7}},
                         {"both", 1, std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6}}};
  mesh.corner_channels = {{"both", 1, std::vector<std::uint8_t>{10, 20, 30, 40, 50, 60}}};
  const Welded result = welded(mesh);
  CHECK(result.mesh.corners == std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3});
  CHECK(result.seams == std::vector<std::string>{"uv"});
  REQUIRE(result.mesh.point_channels.size() == 2);
  CHECK(result.mesh.point_channels[0].name == "same");
  CHECK(result.mesh.point_channels[0].scalar_count() == 4);
  CHECK(result.mesh.point_channels[1].values == ChannelValues(std::vector<std::uint8_t>{1, 2, 3, 6}));
  REQUIRE(result.mesh.corner_channels.size() == 2);
  CHECK(result.mesh.corner_channels[0].values == mesh.corner_channels[0].values);
  CHECK(result.mesh.corner_channels[1].values == mesh.point_channels[1].values);
}

TEST_CASE("splitting at seams gives each point one copy for each row of values", "[weld]") {
  std::mt19937 random(5);
  IndexedFaceSet mesh = test::torus(12, 9);
  mesh.points.push_back({7, 7, 7});  // of no face
  std::vector<float> uv;
  std::vector<std::uint8_t> side;
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    uv.insert(uv.end(), {static_cast<float>(random() % 2), 0.5f});
    side.push_back(static_cast<std::uint8_t>(random() % 2));
  }
  std::vector<float> number(mesh.points.size());
  std::iota(number.begin(), number.end(), 0.0f);
  mesh.point_channels = {{"number", 1, number}};
  mesh.corner_channels = {{"uv", 2, uv}, {"kept", 1, side}, {"side", 1, side}};
  const std::vector<std::string> names = {"uv", "side", "missing"};
  const auto split = split_at_seams(mesh, names);
  REQUIRE(split);

  CHECK(split->corner_channels.size() == 1);
  REQUIRE(split->point_channels.size() == 3);
  const auto& split_number = std::get<std::vector<float>>(split->point_channels[0].values);
  const auto& split_uv = std::get<std::vector<float>>(split->point_channels[1].values);
  const auto& split_side = std::get<std::vector<std::uint8_t>>(split->point_channels[2].values);
  CHECK(std::ranges::is_sorted(split_number));
  CHECK(split_number.back() == number.back());
  std::map<std::tuple<float, float, int>, std::uint32_t> copies;
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const std::uint32_t copy = split->corners[c];
    REQUIRE(split->points[copy] == mesh.points[mesh.corners[c]]);
    REQUIRE(split_number[copy] == number[mesh.corners[c]]);
    REQUIRE(split_uv[2 * copy] == uv[2 * c]);
    REQUIRE(split_side[copy] == side[c]);
    REQUIRE(copies.try_emplace({number[mesh.corners[c]], uv[2 * c], side[c]}, copy).first->second == copy);
  }
  CHECK(copies.size() + 1 == split->points.size());

  // The way back.
  const Welded again = welded(*split);
  CHECK(again.mesh.points.size() == mesh.points.size());
  CHECK(again.seams == std::vector<std::string>{"uv", "side"});
  CHECK(find_channel(again.mesh.corner_channels, "uv")->values == mesh.corner_channels[0].values);
  CHECK(find_channel(again.mesh.corner_channels, "side")->values == mesh.corner_channels[2].values);
}

TEST_CASE("without seams, splitting changes nothing; corners that name no point are an error", "[weld]") {
  IndexedFaceSet mesh = test::cube();
  mesh.corner_channels = {{"uv", 1, std::vector<float>(36)}};
  const std::vector<std::string> names = {"uv"};
  const auto split = split_at_seams(mesh, names);
  REQUIRE(split);
  CHECK(split->points == mesh.points);
  CHECK(split->corners == mesh.corners);
  CHECK(split->point_channels[0].scalar_count() == 8);
  mesh.corners[0] = 8;
  CHECK(split_at_seams(mesh, names).error().code == ErrorCode::kUsage);
}

TEST_CASE("what cannot be welded is a usage error", "[weld]") {
  IndexedFaceSet mesh = test::tetrahedron();
  CHECK(weld(mesh, {Length::absolute(-1.0)}).error().code == ErrorCode::kUsage);
  CHECK(weld(mesh, {Length::relative(std::numeric_limits<double>::quiet_NaN())}).error().code ==
        ErrorCode::kUsage);
  mesh.points[0].x = std::numeric_limits<float>::infinity();
  CHECK(weld(mesh, {Length::absolute(0.1)}).error().code == ErrorCode::kUsage);
  mesh = test::tetrahedron();
  mesh.corners[0] = 77;
  CHECK(weld(mesh).error().code == ErrorCode::kUsage);
}

TEST_CASE("faces come back from a soup of them", "[weld]") {
  IndexedFaceSet quads = test::quad_cube();
  quads.face_channels = {{"id", 1, std::vector<std::int32_t>{1, 2, 3, 4, 5, 6}}};
  for (const IndexedFaceSet& mesh : {quads, test::torus(7, 5)}) {
    const IndexedFaceSet back = weld(to_polygon_soup(mesh).value()).value();
    CHECK(back.face_offsets == mesh.face_offsets);
    CHECK(back.points.size() == mesh.points.size());
    REQUIRE(back.corners.size() == mesh.corners.size());
    for (std::size_t c = 0; c < mesh.corners.size(); ++c)
      CHECK(back.points[back.corners[c]] == mesh.points[mesh.corners[c]]);
    REQUIRE(back.face_channels.size() == mesh.face_channels.size());
    for (std::size_t i = 0; i < mesh.face_channels.size(); ++i)
      CHECK(back.face_channels[i].values == mesh.face_channels[i].values);
  }
  IndexedFaceSet bad = test::tetrahedron();
  bad.corners[0] = 4;
  CHECK(to_polygon_soup(bad).error().code == ErrorCode::kUsage);
}
