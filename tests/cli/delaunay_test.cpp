// vkmesh delaunay, on a few points.
#include <fstream>
#include <iterator>
#include <string>

#include <catch2/catch.hpp>

#include <vkmesh/repair/consolidate.h>

#include "output.h"
#include "program.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

TEST_CASE("delaunay triangulates the points of a file, and tells how many there are") {
  const Scratch scratch;
  const std::string in = scratch.file("in.xyz", "0 0 5\n4 0 6\n4 3 7\n0 3 8\n1 1 9\n4 3 1\n"),
                    out = scratch.path("out.ply");
  const Outcome run = vkmesh_run({"delaunay", in, out, "--json"});
  REQUIRE(run.code == 0);
  CHECK(run.json().at("command") == "delaunay");
  const auto result = run.json().at("result");
  CHECK(result.at("vertices") == 5);
  CHECK(result.at("duplicates") == 1);
  CHECK(result.at("triangles") == 4);
  CHECK(result.at("hull_edges") == 4);
  CHECK(result.at("angles").at("least").get<double>() > 0);
  const IndexedFaceSet flat = mesh_in(out);
  CHECK(flat.points.size() == 5);
  CHECK(flat.face_count() == 4);
  for (const Vec3& p : flat.points) CHECK(p.z == 0.0f);
  CHECK(diagnose(flat).value().manifold());

  REQUIRE(vkmesh_run({"delaunay", in, out, "--z"}).code == 0);
  float sum = 0;
  for (const Vec3& p : mesh_in(out).points) sum += p.z;
  CHECK(sum == 5.0f + 6 + 7 + 8 + 9);  // the first of the two at (4, 3)
}

TEST_CASE("delaunay gives the same file for any order of the points") {
  const Scratch scratch;
  const std::string one = scratch.path("one.ply"), two = scratch.path("two.ply");
  std::string ascending, descending;
  for (int i = 0; i < 100; ++i) {
    const int k = 99 - i;
    const auto line = [](int n, const char* between) {
      return std::to_string(n % 10) + between + std::to_string(n / 10) + between + "0\n";
    };
    ascending += line(i, " ");
    descending += line(k, ",");
  }
  REQUIRE(vkmesh_run({"delaunay", scratch.file("a.xyz", ascending), one}).code == 0);
  REQUIRE(vkmesh_run({"delaunay", scratch.file("b.xyz", descending), two}).code == 0);
  std::ifstream a(one, std::ios::binary), b(two, std::ios::binary);
  CHECK(std::string(std::istreambuf_iterator<char>(a), {}) ==
        std::string(std::istreambuf_iterator<char>(b), {}));
  CHECK(mesh_in(one).face_count() == 162);
}

TEST_CASE("delaunay says what it cannot use") {
  const Scratch scratch;
  const std::string out = scratch.path("out.ply");
  const Outcome line = vkmesh_run({"delaunay", scratch.file("line.xyz", "0 0 0\n1 1 0\n2 2 0\n"), out});
  CHECK(line.code == 0);
  CHECK_THAT(line.out, Contains("all points lie on one line"));
  CHECK(mesh_in(out).points.size() == 3);
  const Outcome heights = vkmesh_run({"delaunay", scratch.file("h.xyz", "0 0 0\n1 1 1\n2 0 0\n"), out});
  CHECK(heights.code == 0);
  CHECK_THAT(heights.out, Contains("--z keeps them"));
  const Outcome twice =
      vkmesh_run({"delaunay", scratch.file("t.xyz", "0 0 0\n1 1 1\n2 0 0\n2 0 3\n"), out, "--z"});
  CHECK(twice.code == 0);
  CHECK_THAT(twice.out, Contains("1 point above or below another"));
  CHECK(vkmesh_run({"delaunay", scratch.path("none.xyz"), out}).code == 3);
  CHECK(vkmesh_run({"delaunay", scratch.path("h.xyz"), scratch.path("no/where.ply")}).code == 7);
  CHECK(vkmesh_run({"delaunay", scratch.path("h.xyz"), out, "--weld"}).code == 2);
}
