// vkmesh digest: what it prints can be checked, and a difference is told. The committed digests are checked
// by tests of their own (CMakeLists.txt).
#include <catch2/catch.hpp>

#include "meshes.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh::test;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

std::size_t rows_that_say(const std::string& report, const std::string& what) {
  std::size_t rows = 0;
  for (std::size_t at = report.find(what); at != std::string::npos; at = report.find(what, at + 1)) ++rows;
  return rows;
}

}  // namespace

TEST_CASE("digests are checked against the list that was printed") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(torus(8, 6))), fin = scratch.file("fin.off", kFinOff);
  const Outcome printed = vkmesh_run({"digest", in, fin, "--device", "cpu"});
  REQUIRE(printed.code == 0);
  CHECK_THAT(printed.out, Contains("  vertex-normals  ") && Contains("  " + in + "\n"));
  const std::string list = scratch.file("list.txt", printed.out);
  const Outcome report = vkmesh_run({"digest", "--check", list, "--device", "cpu"});
  CHECK(report.code == 0);
  CHECK(rows_that_say(report.out, "the same bytes, 2 meshes") == 18);
  CHECK_THAT(report.out,
             StartsWith("device ") && Contains("\nprogram ") && Contains("vkmesh " VKMESH_VERSION "; Linux"));

  // The digest of something else in the place of the first.
  std::string changed = printed.out;
  const std::size_t at = changed.find("  vertex-normals") - 16;
  changed[at] = changed[at] == '0' ? '1' : '0';
  const Outcome refused =
      vkmesh_run({"digest", "--check", scratch.file("changed.txt", changed), "--device", "cpu"});
  CHECK(refused.code == 4);
  CHECK_THAT(refused.err, Contains("1 digest of ") && Contains("differs: vertex-normals of " + in));
  // The report comes all the same.
  CHECK(rows_that_say(refused.out, "the same bytes, 2 meshes") == 17);
  CHECK(rows_that_say(refused.out, "DIFFERS for 1 of 2 meshes, first " + in) == 1);
}

TEST_CASE("digest says that a point cloud has no faces, and which file it is") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(torus(8, 6)));
  const std::string cloud = scratch.file("cloud.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  const std::string list =
      scratch.file("list.txt", std::string(16, '0') + "  vertex-normals  " + cloud + "\n");
  for (const std::vector<std::string>& named :
       {std::vector{cloud}, std::vector{in, cloud}, std::vector<std::string>{"--check", list}}) {
    std::vector<std::string> arguments = {"digest", "--device", "cpu"};
    arguments.insert(arguments.end(), named.begin(), named.end());
    const Outcome outcome = vkmesh_run(arguments);
    CHECK(outcome.code == 4);
    CHECK_THAT(outcome.err,
               Contains(cloud) && Contains("a point cloud has no faces for the passes: give files"));
  }
}

TEST_CASE("a digest is that of the bytes: one moved point changes all of them") {
  const Scratch scratch;
  const std::string off = off_of(torus(8, 6));
  std::string moved = off;
  moved[moved.find("1.4")] = '2';
  const auto digests = [&](const std::string& name, const std::string& content) {
    const Outcome outcome = vkmesh_run({"digest", scratch.file(name, content), "--device", "cpu", "--json"});
    REQUIRE(outcome.code == 0);
    return outcome.json().at("result").at("digests");
  };
  const auto a = digests("a.off", off), b = digests("b.off", moved), again = digests("a.off", off);
  REQUIRE(a.size() == b.size());
  CHECK(a == again);
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i].at("digest") != b[i].at("digest"));
}

TEST_CASE("digest says what is wrong with its arguments") {
  const Scratch scratch;
  CHECK(vkmesh_run({"digest"}).code == 2);
  CHECK(vkmesh_run({"digest", "--check", scratch.path("none.txt")}).code == 3);
  const Outcome empty = vkmesh_run({"digest", "--check", scratch.file("empty.txt", "# nothing\n")});
  CHECK(empty.code == 3);
  CHECK_THAT(empty.err, Contains("holds no digests"));
  const Outcome missing = vkmesh_run({"digest", scratch.path("none.ply"), "--device", "cpu"});
  CHECK(missing.code == 3);
  CHECK_THAT(missing.err, Contains("none.ply"));
}
