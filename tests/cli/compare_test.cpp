// vkmesh compare: distances that are known beforehand.
#include <cmath>

#include <catch2/catch.hpp>

#include "meshes.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

TEST_CASE("compare measures planes that are apart by a known length") {
  const Scratch scratch;
  IndexedFaceSet raised = grid(3, 4);
  for (Vec3& p : raised.points) p.z = 0.25f;
  const std::string a = scratch.file("a.off", off_of(grid(3, 4))), b = scratch.file("b.off", off_of(raised));
  const Outcome outcome = vkmesh_run({"compare", a, b, "--json"});
  REQUIRE(outcome.code == 0);
  const auto result = outcome.json().at("result");
  CHECK(result.at("diagonal") == 5.0);
  CHECK(result.at("first").at("points") == 20);
  CHECK(result.at("second").at("faces") == 24);
  for (const char* way : {"two_sided", "first_to_second", "second_to_first"})
    for (const char* measure : {"mean", "root_mean_square", "maximum", "hausdorff_low"})
      CHECK(result.at(way).at(measure).get<double>() == Approx(0.25));
  for (const char* way : {"two_sided", "first_to_second", "second_to_first"}) {
    CHECK(result.at(way).at("hausdorff_high") >= 0.25);
    CHECK(result.at(way).at("hausdorff_high") <= 0.2525);
  }
  CHECK(result.at("two_sided").at("mean_normal_angle") == 0.0);
  CHECK_THAT(vkmesh_run({"compare", a, b}).out, Contains("mean") && Contains("0.25 (5 % of the diagonal)"));
}

TEST_CASE("compare refuses what has no surface, and names the file that cannot be read") {
  const Scratch scratch;
  const std::string a = scratch.file("a.off", kCubeOff);
  const std::string cloud = scratch.file("cloud.off", "OFF\n1 0 0\n0 0 0\n");
  CHECK(vkmesh_run({"compare", a, cloud}).code == 4);
  const Outcome missing = vkmesh_run({"compare", a, scratch.path("none.ply")});
  CHECK(missing.code == 3);
  CHECK_THAT(missing.err, Contains("none.ply"));
  CHECK(vkmesh_run({"compare", a}).code == 2);
  CHECK(vkmesh_run({"compare", a, a, "--tolerance", "-1"}).code == 2);
}

TEST_CASE("compare tells at once that surfaces coincide, whichever way they are cut into triangles") {
  const Scratch scratch;
  const std::string a = scratch.file("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"),
                    b = scratch.file("b.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 4\nf 2 3 4\n");
  const auto result = vkmesh_run({"compare", a, b, "--json"}).json().at("result");
  for (const char* way : {"two_sided", "first_to_second", "second_to_first"}) {
    CHECK(result.at(way).at("hausdorff_low") == 0.0);
    CHECK(result.at(way).at("hausdorff_high") <= 1e-9 * std::sqrt(2.0));
  }
}

TEST_CASE("compare --tolerance 0 says nothing about the Hausdorff distance but what the samples show") {
  const Scratch scratch;
  IndexedFaceSet raised = grid(3, 4);
  for (Vec3& p : raised.points) p.z = 0.25f;
  const std::string a = scratch.file("a.off", off_of(grid(3, 4))), b = scratch.file("b.off", off_of(raised));
  const auto result = vkmesh_run({"compare", a, b, "--tolerance", "0", "--json"}).json().at("result");
  for (const char* way : {"two_sided", "first_to_second", "second_to_first"}) {
    CHECK(result.at(way).at("hausdorff_low").get<double>() == Approx(0.25));
    CHECK(result.at(way).at("hausdorff_high").is_null());
  }
  CHECK_THAT(vkmesh_run({"compare", a, b, "--tolerance", "0"}).out, Contains("at least 0.25"));
}
