// vkmesh convert, and what files go through every subcommand with: gzip, standard streams, attributes.
#include <cmath>
#include <filesystem>

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

TEST_CASE("convert repairs what is no manifold, and tells; --strict refuses; --as-is passes it through") {
  const Scratch scratch;
  const std::string in = scratch.file("fin.off", kFinOff);
  const Outcome repaired = vkmesh_run({"convert", in, scratch.path("a.ply"), "--json"});
  REQUIRE(repaired.code == 0);
  const auto report = repaired.json().at("report");
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

TEST_CASE("Options that cannot act on a point cloud, or with --as-is, are refused") {
  const Scratch scratch;
  const std::string cloud = scratch.file("cloud.obj", "v 0 0 0\nv 0 0 0\nv 0.01 0 0\nv 5 0 0\n");
  const Outcome welded = vkmesh_run({"convert", cloud, scratch.path("a.ply"), "--weld", "0.1", "--json"});
  REQUIRE(welded.code == 0);
  CHECK(welded.json().at("report").at("welded_points") == 2);
  CHECK(mesh_in(scratch.path("a.ply")).points.size() == 2);
  for (const std::string option : {"--strict", "--drop-isolated", "--refuse-non-orientable"}) {
    CAPTURE(option);
    const Outcome refused = vkmesh_run({"convert", cloud, scratch.path("b.ply"), option});
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains(option + " cannot act"));
    const std::string in = scratch.file("in.off", kCubeOff);
    CHECK(vkmesh_run({"convert", in, scratch.path("b.ply"), option, "--as-is"}).code == 2);
  }
  CHECK(vkmesh_run({"convert", cloud, scratch.path("b.ply"), "--weld", "0", "--as-is"}).code == 2);
  CHECK(vkmesh_run({"convert", cloud, scratch.path("b.stl")}).code == 4);
  CHECK(vkmesh_run({"simplify", cloud, scratch.path("b.ply"), "--ratio", "0.5"}).code == 4);
  CHECK_FALSE(std::filesystem::exists(scratch.path("b.ply")));
  CHECK_FALSE(std::filesystem::exists(scratch.path("b.stl")));
}

TEST_CASE("Losses have codes, and --on-loss says what they do") {
  const Scratch scratch;
  const std::string in =
      scratch.file("in.obj", "mtllib a.mtl\nfoo 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  const std::string out = scratch.path("out.off");
  const Outcome noted = vkmesh_run({"convert", in, out, "--json"});
  REQUIRE(noted.code == 0);
  const auto losses = noted.json().at("losses");
  REQUIRE(losses.size() == 3);
  CHECK(losses[0].at("code") == "skipped.keyword");
  CHECK(losses[0].at("file") == in);
  CHECK(losses[1].at("code") == "dropped.material_libraries");
  CHECK(losses[2].at("code") == "dropped.material");
  CHECK(losses[2].at("file") == out);
  CHECK(noted.json().at("notes").size() == 3);
  const Outcome ignored = vkmesh_run({"convert", in, out, "--json", "--on-loss", "ignore"});
  REQUIRE(ignored.code == 0);
  CHECK(ignored.json().at("losses").size() == 3);
  CHECK(ignored.json().at("notes").empty());
  std::filesystem::remove(out);
  const Outcome failed = vkmesh_run({"convert", in, out, "--on-loss", "fail"});
  CHECK(failed.code == 4);
  CHECK_THAT(failed.err, Contains("skipped.keyword"));
  const std::string whole = scratch.file("whole.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  CHECK(vkmesh_run({"convert", whole, out, "--on-loss", "fail"}).code == 4);
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK(vkmesh_run({"convert", whole, scratch.path("out.obj"), "--on-loss", "fail"}).code == 0);
}

TEST_CASE("Map coordinates come back, and info shows them") {
  const Scratch scratch;
  const std::string in = scratch.file(
      "in.obj", "v 500000.1 4649776.3 10.2\nv 500000.3 4649776.3 10.2\nv 500000.1 4649776.5 10.4\nf 1 2 3\n");
  for (const std::string name : {"a.obj", "a.off", "a.ply", "a.glb", "a.wrl", "a.iv"}) {
    CAPTURE(name);
    REQUIRE(vkmesh_run({"convert", in, scratch.path(name)}).code == 0);
    REQUIRE(vkmesh_run({"convert", scratch.path(name), scratch.path("back.obj")}).code == 0);
    CHECK_THAT(content_of(scratch.path("back.obj")),
               Contains("v 500000.1 4649776.3 10.2\nv 500000.3 4649776.3 10.2\nv 500000.1 4649776.5 10.4\n"));
  }
  const Outcome info = vkmesh_run({"info", in, "--json"});
  REQUIRE(info.code == 0);
  CHECK(info.json().at("result").at("bounds").at("max")[1].get<double>() == Approx(4649776.5).epsilon(1e-15));
  CHECK(info.json().at("result").at("area").get<double>() == Approx(0.5 * 0.2 * std::hypot(0.2, 0.2)));
  CHECK_THAT(vkmesh_run({"info", in}).out,
             Contains("(500000.1, 4649776.3, 10.2) to (500000.3, 4649776.5, 10.4)"));
  // The second surface of a comparison is read relative to the first's offset.
  const std::string other = scratch.file(
      "b.obj", "v 500000.1 4649776.3 10.3\nv 500000.3 4649776.3 10.3\nv 500000.1 4649776.5 10.5\nf 1 2 3\n");
  const Outcome compared = vkmesh_run({"compare", in, other, "--json"});
  REQUIRE(compared.code == 0);
  CHECK_THAT(compared.out, Contains("0.07"));  // The planes are 0.1 / √2 apart.
  CHECK(vkmesh_run({"smooth", in, scratch.path("s.obj"), "--device", "cpu"}).code == 0);
  CHECK_THAT(content_of(scratch.path("s.obj")), Contains("v 500000."));
}

TEST_CASE("simplify keeps points that no face uses, and their attributes") {
  const Scratch scratch;
  const std::string in = scratch.file(
      "in.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "property float heat\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "9 9 9 7\n0 0 0 1.5\n1 0 0 2.5\n0 1 0 3.5\n1 1 0 4.5\n3 1 2 3\n3 2 4 3\n");
  const Outcome kept = vkmesh_run({"simplify", in, scratch.path("a.ply"), "--ratio", "1"});
  REQUIRE(kept.code == 0);
  CHECK_THAT(kept.out, Contains("1 point that no face uses kept"));
  const IndexedFaceSet mesh = mesh_in(scratch.path("a.ply"));
  REQUIRE(mesh.points.size() == 5);
  CHECK(mesh.points[4] == Vec3(9, 9, 9));
  CHECK(floats_of(mesh, "heat")[4] == 7);
  REQUIRE(vkmesh_run({"simplify", in, scratch.path("b.ply"), "--ratio", "1", "--drop-isolated"}).code == 0);
  CHECK(mesh_in(scratch.path("b.ply")).points.size() == 4);
}

TEST_CASE("simplify lets attributes of corners go whose weight is 0, and their seams with them") {
  const Scratch scratch;
  const std::string in = scratch.file("in.obj", octahedron_of_seams());
  const Outcome outcome =
      vkmesh_run({"simplify", in, scratch.path("a.off"), "--ratio", "0.5", "--attribute", "uv=0"});
  REQUIRE(outcome.code == 0);
  CHECK(mesh_in(scratch.path("a.off")).face_count() <= 4);
  CHECK_THAT(outcome.out, Contains("uv of corners was left out"));
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
