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

TEST_CASE("delaunay takes constraints, keeps what outlines wind around, and refines") {
  const Scratch scratch;
  const std::string out = scratch.path("out.ply");
  // A square with a square hole, a point in the hole, one outside, and a line from corner to corner.
  const std::string plan =
      scratch.file("plan.obj",
                   "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nv 3 3 0\nv 6 3 0\nv 6 6 0\nv 3 6 0\n"
                   "v 5 5 0\nv 20 20 0\nl 1 2 3 4 1\nf 5 6 7 8\nl 1 5\n");
  const Outcome inside =
      vkmesh_run({"delaunay", plan, out, "--constraints", plan, "--inside", "even-odd", "--json"});
  REQUIRE(inside.code == 0);
  auto result = inside.json().at("result");
  CHECK(result.at("vertices") == 8);
  CHECK(result.at("triangles") == 8);
  CHECK(result.at("boundary_edges") == 8);
  CHECK(result.at("constraints").at("segments") == 9);
  CHECK(result.at("constraints").at("edges") == 9);
  CHECK(mesh_in(out).points.size() == 8);
  const Outcome refined = vkmesh_run({"delaunay", plan, out, "--constraints", plan, "--inside", "even-odd",
                                      "--min-angle", "30", "--max-area", "0.5", "--json"});
  REQUIRE(refined.code == 0);
  result = refined.json().at("result");
  CHECK(result.at("refinement").at("added") > 100);
  CHECK(result.at("refinement").at("left").at("max_points") == 0);
  CHECK(result.at("angles").at("least").get<double>() >= 29.99);
  CHECK(diagnose(mesh_in(out)).value().manifold());
  // Points in one file, pairs of their numbers in another; heights of points that were added lie between.
  const std::string points = scratch.file("points.xyz", "0 0 4\n2 0 4\n2 2 8\n0 2 4\n"),
                    pairs = scratch.file("pairs.txt", "# both diagonals\n0 2\n3, 1\n");
  const Outcome crossing = vkmesh_run({"delaunay", points, out, "--constraints", pairs});
  CHECK(crossing.code == 4);
  CHECK_THAT(crossing.err, Contains("constraint 0 crosses constraint 1"));
  const Outcome split =
      vkmesh_run({"delaunay", points, out, "--constraints", pairs, "--split-crossings", "--z", "--json"});
  REQUIRE(split.code == 0);
  CHECK(split.json().at("result").at("constraints").at("crossings") == 1);
  const IndexedFaceSet heights = mesh_in(out);
  REQUIRE(heights.points.size() == 5);
  CHECK((heights.points[4].x == 1 && heights.points[4].y == 1));
  CHECK((heights.points[4].z == 4 || heights.points[4].z == 6));
  // Points of a file of constraints are added to those of the input.
  const std::string line = scratch.file("line.obj", "v 0.5 0.5 0\nv 1.5 1 0\nl 1 -1\n");
  const Outcome added = vkmesh_run({"delaunay", points, out, "--constraints", line, "--json"});
  REQUIRE(added.code == 0);
  CHECK(added.json().at("result").at("vertices") == 6);
}

TEST_CASE("delaunay names the lines of constraints that it cannot use") {
  const Scratch scratch;
  const std::string points = scratch.file("points.xyz", "0 0 0\n2 0 0\n2 2 0\n0 2 0\n"),
                    out = scratch.path("out.ply");
  const auto refused = [&](const std::string& file, const std::string& why, int code) {
    const Outcome run = vkmesh_run({"delaunay", points, out, "--constraints", file});
    INFO(run.err);
    CHECK(run.code == code);
    CHECK_THAT(run.err, Contains(why));
  };
  refused(scratch.path("none.txt"), "cannot be opened", 3);
  refused(scratch.file("a.txt", "0 1\n1 x\n"), "a.txt:2: expected the numbers of two points", 3);
  refused(scratch.file("b.txt", "0 1\n0 4\n"), "constraint 1 ends at point 4, and there are 4", 4);
  refused(scratch.file("c.obj", "v 0 0\nl 1 2\n"), "c.obj:2: '2' is none of the 1 points above", 3);
  refused(scratch.file("d.obj", "v 0 0\nl 1\n"), "d.obj:2: a line has two points or more", 3);
  CHECK(vkmesh_run({"delaunay", points, out, "--inside", "nonzero"}).code == 2);
  CHECK(vkmesh_run({"delaunay", points, out, "--max-points", "5"}).code == 2);
  CHECK(vkmesh_run({"delaunay", points, out, "--min-angle", "60"}).code == 2);
  CHECK(vkmesh_run({"delaunay", points, out, "--max-area", "0"}).code == 2);
}
