// Polylines as OBJ text.
#include <catch2/catch.hpp>

#include "io/io_support.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

const std::vector<Vec3> kPolylinePoints = {{0, 0, 0}, {1, 0.1f, 0}, {9, 9, 9}, {-2.5f, 0, 1e-9f}};
using Lines = std::vector<std::vector<std::uint32_t>>;

}  // namespace

TEST_CASE("polylines are lines of the points that they name, in the order in which they name them", "[io]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.obj";
  // A loop is closed by its first point.
  REQUIRE(write_polylines(path, kPolylinePoints, Lines{{3, 1}, {1, 0, 3, 1}}));
  CHECK(read_bytes(path) == "v -2.5 0 1e-09\nv 1 0.1 0\nv 0 0 0\nl 1 2\nl 2 3 1 2\n");
  REQUIRE(write_polylines(path, kPolylinePoints, Lines{}));
  CHECK(read_bytes(path).empty());
  CHECK(folder.entries() == 1);
}

TEST_CASE("polylines of many points come whole", "[io]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.obj";
  std::vector<Vec3> points;
  Lines lines(1);
  std::string expected, line = "l";
  for (std::uint32_t i = 0; i < 100000; ++i) {
    points.emplace_back(static_cast<float>(i), 0.5f, -1.0f);
    lines[0].push_back(i);
    expected += "v " + std::to_string(i) + " 0.5 -1\n";
    line += " " + std::to_string(i + 1);
  }
  REQUIRE(write_polylines(path, points, lines));
  CHECK((read_bytes(path) == expected + line + "\n"));
}

TEST_CASE("polylines that cannot be written leave no file, and the one before as it was", "[io]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.obj";
  CHECK(write_polylines(path, kPolylinePoints, Lines{{0, 1}, {1, 4}}).error().code == ErrorCode::kUsage);
  CHECK(folder.entries() == 0);
  write_bytes(path, "before");
  CHECK(write_polylines(path, kPolylinePoints, Lines{{0xffffffffu}}).error().code == ErrorCode::kUsage);
  CHECK(read_bytes(path) == "before");
  CHECK(folder.entries() == 1);
  CHECK(write_polylines(folder.path() / "none" / "a.obj", kPolylinePoints, Lines{{0, 1}}).error().code ==
        ErrorCode::kNotWritable);
  CHECK(write_polylines(folder.path(), kPolylinePoints, Lines{{0, 1}}).error().code ==
        ErrorCode::kNotWritable);
  CHECK(folder.entries() == 1);
}
