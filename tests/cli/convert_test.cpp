// vkmesh convert, and what files go through every subcommand with: gzip, standard streams, attributes.
#include <catch2/catch.hpp>

#include "meshes.h"
#include "output.h"
#include "program.h"
#include "support/shapes.h"

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

TEST_CASE("convert mends what is no manifold, and tells; --strict refuses; --as-is passes it through") {
  const Scratch scratch;
  const std::string in = scratch.file("fin.off", kFinOff);
  const Outcome mended = vkmesh_run({"convert", in, scratch.path("a.ply"), "--json"});
  REQUIRE(mended.code == 0);
  const auto report = mended.json().at("report");
  CHECK(report.at("non_manifold_edges") == 1);
  CHECK(report.at("split_edges") == 1);
  CHECK(report.at("added_points") == 2);
  CHECK(report.at("manifold") == false);
  CHECK(mesh_in(scratch.path("a.ply")).points.size() == 7);
  CHECK_THAT(vkmesh_run({"convert", in, scratch.path("b.ply")}).out,
             Contains("1 edge of three or more faces split"));
  CHECK(vkmesh_run({"convert", scratch.path("a.ply"), scratch.path("c.ply"), "--strict"}).code == 0);

  const Outcome refused = vkmesh_run({"convert", in, scratch.path("d.ply"), "--strict"});
  CHECK(refused.code == 4);
  CHECK_THAT(refused.err, Contains("1 edge with three or more faces") && Contains("fin.off"));
  CHECK(vkmesh_run({"convert", in, scratch.path("e.ply"), "--as-is"}).code == 0);
  CHECK(mesh_in(scratch.path("e.ply")).points.size() == 5);
  CHECK(vkmesh_run({"normals", in, scratch.path("f.ply"), "--device", "cpu", "--strict"}).code == 4);
  CHECK(vkmesh_run({"normals", in, scratch.path("f.ply"), "--device", "cpu"}).code == 0);
}

TEST_CASE("--weld takes a length, or a share of the diagonal") {
  const Scratch scratch;
  // Two triangles with a gap of 0.01 between them; the diagonal is about 1.414.
  const std::string in = scratch.file(
      "gap.off", "OFF\n7 2 0\n0 0 0\n1 0 0\n0 1 0\n0 1.01 0\n1 0.01 0\n1 1 0\n1 1 0\n3 0 1 2\n3 3 4 5\n");
  const auto welded = [&](const std::string& tolerance) {
    const Outcome outcome = vkmesh_run({"convert", in, scratch.path("a.ply"), "--weld", tolerance, "--json"});
    REQUIRE(outcome.code == 0);
    return outcome.json().at("report").at("welded_points").get<int>();
  };
  CHECK(welded("0") == 1);
  CHECK(welded("0.02") == 3);
  CHECK(welded("0.1%") == 1);
  CHECK(welded("1%") == 3);
  for (const std::string bad : {"-1", "x", "1%%", "nan", "%"}) {
    CAPTURE(bad);
    const Outcome outcome = vkmesh_run({"convert", in, scratch.path("a.ply"), "--weld=" + bad});
    CHECK(outcome.code == 2);
    CHECK_THAT(outcome.err, Contains("is no length, nor a share of the diagonal"));
  }
  CHECK(vkmesh_run({"convert", in, scratch.path("b.ply"), "--drop-isolated"}).code == 0);
  CHECK(mesh_in(scratch.path("b.ply")).points.size() == 6);
  const std::string strip = scratch.file("strip.off", off_of(mobius(9)));
  CHECK(vkmesh_run({"convert", strip, scratch.path("c.ply"), "--refuse-non-orientable"}).code == 4);
}

TEST_CASE("Every format that can be written is read back, whatever its name says") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(torus(8, 6)));
  for (const std::string name : {"a.glb", "a.gltf", "a.iv", "a.wrl", "a.vrml1", "a.stl", "a.obj.gz"}) {
    CAPTURE(name);
    REQUIRE(vkmesh_run({"convert", in, scratch.path(name)}).code == 0);
    const std::string content = content_of(scratch.path(name));
    const Outcome info = vkmesh_run({"info", scratch.file("any.bin", content), "--json"});
    REQUIRE(info.code == 0);
    CHECK(info.json().at("result").at("faces") == 96);
    CHECK(info.json().at("result").at("genus") == 1);
  }
}
