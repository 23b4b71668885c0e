#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/polygon_soup.h>

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
