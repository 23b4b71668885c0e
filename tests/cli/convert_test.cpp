// vkmesh convert, and what files go through every subcommand with: gzip, standard streams, attributes.
#include <catch2/catch.hpp>

#include "meshes.h"
#include "output.h"
#include "program.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

TEST_CASE("Every format comes back with the same points and faces") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff);
  const IndexedFaceSet cube = mesh_in(in);
  for (const std::string name : {"a.ply", "a.obj", "a.off", "a.ply.gz", "a.obj.gz", "a.off.gz"}) {
    CAPTURE(name);
    const Outcome outcome = vkmesh_run({"convert", in, scratch.path(name)});
    CAPTURE(outcome.err);
    REQUIRE(outcome.code == 0);
    const IndexedFaceSet back = mesh_in(scratch.path(name));
    CHECK(back.points == cube.points);
    CHECK(back.corners == cube.corners);
    CHECK(back.face_offsets == cube.face_offsets);
    const bool gzip = content_of(scratch.path(name)).substr(0, 2) == "\x1f\x8b";
    CHECK(gzip == (name.find(".gz") != std::string::npos));
  }
}

TEST_CASE("STL takes polygons once they are triangles") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff);
  const Outcome refused = vkmesh_run({"convert", in, scratch.path("a.stl")});
  CHECK(refused.code == 4);
  CHECK_THAT(refused.err, Contains("--triangulate"));
  CHECK(scratch.names() == std::vector<std::string>{"in.off"});

  const Outcome outcome = vkmesh_run({"convert", in, scratch.path("a.stl"), "--triangulate", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.json().at("output").at("faces") == 12);
  const IndexedFaceSet back = mesh_in(scratch.path("a.stl"));
  CHECK(back.face_count() == 12);
  CHECK(back.points.size() == 8);
}

TEST_CASE("--ascii writes text") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  REQUIRE(vkmesh_run({"convert", in, scratch.path("a.ply"), "--ascii"}).code == 0);
  CHECK_THAT(content_of(scratch.path("a.ply")), Contains("format ascii 1.0") && Contains("element vertex 4"));
  REQUIRE(vkmesh_run({"convert", in, scratch.path("b.ply")}).code == 0);
  CHECK_THAT(content_of(scratch.path("b.ply")), Contains("format binary_little_endian 1.0"));
  REQUIRE(vkmesh_run({"convert", in, scratch.path("a.stl"), "--ascii"}).code == 0);
  CHECK_THAT(content_of(scratch.path("a.stl")), Catch::StartsWith("solid"));
}

TEST_CASE("Standard input and output hold meshes") {
  const Scratch scratch;
  RunOptions options;
  options.input = kTetrahedronOff;
  const Outcome outcome = vkmesh_run({"convert", "-", "-"}, options);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.out, Catch::StartsWith("ply\n"));
  CHECK_THAT(outcome.err, Contains("4 faces"));  // The table makes way.
  const IndexedFaceSet back = mesh_in(scratch.file("out.ply", outcome.out));
  CHECK(back.face_count() == 4);

  RunOptions again;
  again.input = outcome.out;
  CHECK(vkmesh_run({"info", "-", "--json"}, again).json().at("input").at("points") == 4);
}

TEST_CASE("Input and output may be the same file") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff);
  REQUIRE(vkmesh_run({"convert", in, in, "--triangulate"}).code == 0);
  CHECK(mesh_in(in).face_count() == 12);
  CHECK(scratch.names() == std::vector<std::string>{"in.off"});
}

TEST_CASE("Attributes are carried, and what a format cannot hold is named") {
  const Scratch scratch;
  const std::string in = scratch.file(
      "in.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 1.5\n1 0 0 2.5\n0 1 0 3.5\n3 0 1 2\n");
  REQUIRE(vkmesh_run({"normals", in, scratch.path("out.ply"), "--device", "cpu"}).code == 0);
  CHECK(floats_of(mesh_in(scratch.path("out.ply")), "heat") == std::vector<float>{1.5f, 2.5f, 3.5f});
  const Outcome stl = vkmesh_run({"convert", in, scratch.path("out.stl"), "--json"});
  REQUIRE(stl.code == 0);
  CHECK_THAT(stl.json().at("notes").dump(), Contains("heat"));
}
