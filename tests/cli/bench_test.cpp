// vkmesh bench: which passes it times, on which sizes.
#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "meshes.h"
#include "output.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

void check_rows(const std::string& device, std::size_t count) {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(torus(12, 8)));
  const Outcome outcome =
      vkmesh_run({"bench", in, "--splits", "1", "--repetitions", "2", "--device", device, "--json"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto result = outcome.json().at("result");
  std::set<std::string> passes, again;
  for (const auto& row : result.at("rows")) {
    CHECK(row.at("milliseconds").size() == 2);
    CHECK(row.at("median_ms") > 0.0);
    CHECK(row.at("bytes") > 0);
    CHECK(row.at("times_copy") > 0.0);
    // A split makes 4n vertices and 8n faces of n and 2n.
    if (row.at("triangles") == 192) {
      CHECK(row.at("vertices") == 96);
      CHECK(passes.insert(row.at("pass")).second);
    } else {
      CHECK(row.at("triangles") == 768);
      CHECK(row.at("vertices") == 384);
      CHECK(again.insert(row.at("pass")).second);
    }
  }
  CHECK(passes.size() == count);
  CHECK(passes == again);
  CHECK(result.at("growth").size() == count);
  for (const auto& growth : result.at("growth")) CHECK(growth >= 1.0);
}

}  // namespace

TEST_CASE("bench times passes and decimation on the mesh and on its split") {
  check_rows("cpu", 14);
}

TEST_CASE("bench times the same passes on a device", "[device]") {
  check_rows("llvmpipe", 11);
}

TEST_CASE("bench needs a mesh with faces, and takes the passes that are named") {
  const Scratch scratch;
  CHECK(vkmesh_run({"bench"}).code == 2);
  const std::string cloud = scratch.file("cloud.obj", "v 0 0 0\nv 1 0 0\n");
  const Outcome none = vkmesh_run({"bench", cloud, "--device", "cpu"});
  CHECK(none.code == 4);
  CHECK_THAT(none.err, Contains("no faces to measure with"));
  const std::string cube = scratch.file("cube.off", kCubeOff);
  const Outcome some =
      vkmesh_run({"bench", cube, "--device", "cpu", "--only", "normals", "--repetitions", "1", "--json"});
  REQUIRE(some.code == 0);
  CHECK(some.json().at("result").at("rows").size() == 3);
}
