// vkmesh voronoi, on a few points.
#include <algorithm>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/repair/consolidate.h>

#include "output.h"
#include "program.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("voronoi divides a box among points, and tells how") {
  const Scratch scratch;
  const std::string in = scratch.file("in.csv", "x,y\n0,0\n2,0\n0,2\n2,2\n2,2\n9,9\n"),
                    out = scratch.path("out.ply");
  const Outcome run = vkmesh_run({"voronoi", in, out, "--box", "-1,-1,3,3", "--json"});
  REQUIRE(run.code == 0);
  CHECK(run.json().at("command") == "voronoi");
  const auto result = run.json().at("result");
  CHECK(result.at("sites") == 5);
  CHECK(result.at("duplicates") == 1);
  CHECK(result.at("cells") == 4);
  CHECK(result.at("empty_cells") == 1);
  CHECK(result.at("vertices") == 9);
  CHECK(result.at("edges") == 12);
  CHECK(result.at("area").at("sum") == 16);
  CHECK(result.at("area").at("least") == 4);
  const IndexedFaceSet cells = mesh_in(out);
  CHECK(cells.face_count() == 4);
  CHECK(diagnose(cells).value().manifold());
  const Channel* const site = find_channel(cells.face_channels, "site");
  REQUIRE(site != nullptr);
  std::vector<std::uint32_t> sites = std::get<std::vector<std::uint32_t>>(site->values);
  std::sort(sites.begin(), sites.end());
  CHECK(sites == std::vector<std::uint32_t>{0, 1, 2, 3});
  CHECK(find_channel(cells.face_channels, "color") != nullptr);
}

TEST_CASE("voronoi writes formats of triangles, sites, and pictures") {
  const Scratch scratch;
  const std::string in =
      scratch.file("in.xyz", "500000 5400000\n500004 5400000\n500000 5400004\n500003 5400003\n");
  for (const char* name : {"a.stl", "a.glb", "a.off", "a.obj", "a.iv"}) {
    INFO(name);
    REQUIRE(vkmesh_run({"voronoi", in, scratch.path(name)}).code == 0);
    const IndexedFaceSet mesh = mesh_in(scratch.path(name));
    CHECK(mesh.face_count() >= 4);
  }
  REQUIRE(vkmesh_run({"voronoi", in, scratch.path("sites.xyz"), "--lloyd", "3"}).code == 0);
  CHECK(mesh_in(scratch.path("sites.xyz")).points.size() == 4);
  REQUIRE(vkmesh_run({"voronoi", in, scratch.path("a.svg"), "--dots"}).code == 0);
  const std::string svg = content_of(scratch.path("a.svg"));
  CHECK(occurrences(svg, "<polygon ") == 4);
  CHECK(occurrences(svg, "<circle ") == 4);
  CHECK_THAT(svg, Contains("cx=\"500004\" cy=\"5400000\""));  // where the file has it
  CHECK_THAT(svg, Contains("viewBox=\""));
  const Outcome triangles =
      vkmesh_run({"delaunay", in, scratch.path("b.svg"), "--dots", "--circumcircles", "--json"});
  REQUIRE(triangles.code == 0);
  CHECK(triangles.json().at("output").at("format") == "svg");
  CHECK(triangles.json().at("output").at("circles") == triangles.json().at("result").at("triangles"));
  const std::string drawn = content_of(scratch.path("b.svg"));
  CHECK(occurrences(drawn, "<polygon ") == 2);
  CHECK(occurrences(drawn, "<circle ") == 6);
}

TEST_CASE("voronoi clips to the polygon of a file, relative to the same offset") {
  const Scratch scratch;
  const std::string in = scratch.file("in.csv", "\"X\";\"Y\"\n500000;5400000\n500004;5400000\n"),
                    out = scratch.path("out.off");
  const std::string points = scratch.file("clip.xyz", "500001 5400000\n500002 5400004\n499999 5400001\n");
  const std::string face = scratch.file(
      "clip.off", "OFF\n4 1 0\n0 0 0\n500001 5400000 0\n500002 5400004 0\n499999 5400001 0\n3 1 2 3\n");
  for (const std::string& clip : {points, face}) {
    const Outcome run = vkmesh_run({"voronoi", in, out, "--clip", clip, "--json"});
    REQUIRE(run.code == 0);
    CHECK(run.json().at("result").at("area").at("sum") == 4.5);
    CHECK(run.json().at("result").at("empty_cells") == 1);
  }
}

TEST_CASE("voronoi says what it cannot use") {
  const Scratch scratch;
  const std::string in = scratch.file("in.xyz", "0 0 0\n1 1 0\n"), out = scratch.path("out.ply");
  CHECK_THAT(vkmesh_run({"voronoi", in, out, "--box", "0,0,0,1"}).err, Contains("--box: the first corner"));
  CHECK_THAT(vkmesh_run({"voronoi", in, out, "--box", "0,0,1"}).err,
             Contains("--box: '0,0,1' is not 4 numbers"));
  CHECK_THAT(vkmesh_run({"voronoi", in, out, "--dots"}).err, Contains("--dots goes with a picture"));
  const std::string bow = scratch.file("bow.xyz", "0 0\n1 1\n1 0\n0 1\n");
  const Outcome refused = vkmesh_run({"voronoi", in, out, "--clip", bow});
  CHECK(refused.code == 4);
  CHECK_THAT(refused.err, Contains("not convex"));
  CHECK(vkmesh_run({"voronoi", in, out, "--clip", bow, "--box", "0,0,1,1"}).code == 2);
  CHECK(vkmesh_run({"voronoi", in, scratch.path("no/where.svg")}).code == 7);
  CHECK(vkmesh_run({"delaunay", in, out, "--circumcircles"}).code == 2);
  CHECK(vkmesh_run({"delaunay", in, scratch.path("a.svg"), "--z"}).code == 2);
}

TEST_CASE("Points of two numbers are read where heights are not asked for, and else refused in words") {
  const Scratch scratch;
  const std::string out = scratch.path("out.ply");
  for (const char* text : {"0 0\n1 0\n0 1\n", "0,0\n1,0\n0,1\n", "x,y\n0,0\n1,0\n0,1\n",
                           "X\tY\n0\t0\n1\t0\n0\t1\n", "\"x\";\"y\"\r\n0;0\r\n1;0\r\n0;1\r\n",
                           "x,y,z\n0,0,5\n1,0,5\n0,1,5\n", "//X Y Z\n0 0 0\n1 0 0\n0 1 0\n"}) {
    INFO(text);
    for (const char* name : {"in.xyz", "in.csv", "in.txt"}) {
      const std::string in = scratch.file(name, text);
      CHECK(vkmesh_run({"delaunay", in, out}).code == 0);
      CHECK(mesh_in(out).face_count() == 1);
    }
  }
  const Outcome refused = vkmesh_run({"convert", scratch.file("a.csv", "x,y\n0,0\n1,0\n"), out});
  CHECK(refused.code == 3);
  CHECK_THAT(refused.err,
             Contains("a.csv:2: expected 3 to 10 numbers of a point, found 2: points in the plane"));
  CHECK_THAT(vkmesh_run({"delaunay", scratch.file("b.xyz", "0 0\n1\n"), out}).err,
             Contains("b.xyz:2: expected 2 numbers of a point, found 1"));
  CHECK_THAT(vkmesh_run({"delaunay", scratch.file("c.xyz", "0 0\nx 1\n"), out}).err,
             Contains("c.xyz:2: expected 2 numbers of a point, found 'x'"));
  CHECK_THAT(vkmesh_run({"delaunay", scratch.file("d.xyz", "id,y\n0 0\n"), out}).err,
             Contains("found 'id,y'"));
}
