// vkmesh normals, curvature, smooth and simplify on the host, on meshes with known answers.
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "meshes.h"
#include "output.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

TEST_CASE("normals of a sphere point outwards, and are named nx ny nz") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(3)));
  const Outcome outcome = vkmesh_run({"normals", in, scratch.path("out.ply"), "--device", "cpu", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.json().at("result").at("normals") == 642);
  CHECK(outcome.json().at("result").at("undefined") == 0);
  CHECK_THAT(content_of(scratch.path("out.ply")),
             Contains("property float nx\nproperty float ny\nproperty float nz\n"));
  const IndexedFaceSet mesh = mesh_in(scratch.path("out.ply"));
  const std::vector<float> n = floats_of(mesh, "normal");
  REQUIRE(n.size() == 3 * mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3 p = mesh.points[i];
    // Faces span about 8 degrees here, so the mean of those around a point strays by far less than cos 0.99.
    CHECK(p.x * n[3 * i] + p.y * n[3 * i + 1] + p.z * n[3 * i + 2] > 0.99f);
  }
}

TEST_CASE("Polygons stay polygons") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff);
  for (const std::string command : {"normals", "curvature", "smooth"}) {
    CAPTURE(command);
    REQUIRE(vkmesh_run({command, in, scratch.path("out.ply"), "--device", "cpu"}).code == 0);
    const IndexedFaceSet mesh = mesh_in(scratch.path("out.ply"));
    CHECK(mesh.face_count() == 6);
    CHECK(mesh.corners == mesh_in(in).corners);
  }
}

TEST_CASE("curvature of a cube is a right angle, of a plane nothing") {
  const Scratch scratch;
  const std::string cube = scratch.file("cube.off", kCubeOff);
  const Outcome outcome =
      vkmesh_run({"curvature", cube, scratch.path("out.ply"), "--device", "cpu", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.json().at("result").at("unit") == "radians");
  for (const float angle : floats_of(mesh_in(scratch.path("out.ply")), "quality"))
    CHECK(std::abs(angle - std::numbers::pi_v<float> / 2) < 1e-6f);
  const std::string plane = scratch.file("plane.off", off_of(grid(3, 3)));
  REQUIRE(vkmesh_run({"curvature", plane, scratch.path("out.ply"), "--device", "cpu"}).code == 0);
  for (const float angle : floats_of(mesh_in(scratch.path("out.ply")), "quality")) CHECK(angle == 0.0f);
}

TEST_CASE("smooth moves each point of a tetrahedron by lambda of the way to the mean of the others") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  const Outcome outcome = vkmesh_run({"smooth", in, scratch.path("out.ply"), "--lambda", "0.25",
                                      "--iterations", "1", "--device", "cpu", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.json().at("result").at("iterations") == 1);
  const IndexedFaceSet before = mesh_in(in), after = mesh_in(scratch.path("out.ply"));
  for (std::size_t i = 0; i < 4; ++i) {
    DVec3 mean(0.0);
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) mean += DVec3(before.points[j]) / 3.0;
    const DVec3 expected = DVec3(before.points[i]) + 0.25 * (mean - DVec3(before.points[i]));
    for (int k = 0; k < 3; ++k) CHECK(std::abs(static_cast<double>(after.points[i][k]) - expected[k]) < 1e-6);
  }
}

TEST_CASE("smooth keeps the boundary unless told otherwise") {
  const Scratch scratch;
  IndexedFaceSet mesh = grid(4, 4);
  jitter(mesh, 0.2f, 7);
  const std::string in = scratch.file("in.off", off_of(mesh));
  const auto moved = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"smooth", in, scratch.path("out.ply"), "--device", "cpu"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    REQUIRE(vkmesh_run(arguments).code == 0);
    return mesh_in(scratch.path("out.ply")).points[0] != mesh_in(in).points[0];  // A corner of the grid.
  };
  CHECK_FALSE(moved({}));
  CHECK(moved({"--boundary", "free"}));
}

TEST_CASE("smooth leaves normals out that no longer fit, and says so") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  REQUIRE(vkmesh_run({"normals", in, scratch.path("n.ply"), "--device", "cpu"}).code == 0);
  const Outcome outcome =
      vkmesh_run({"smooth", scratch.path("n.ply"), scratch.path("s.ply"), "--device", "cpu", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.json().at("notes").dump(), Contains("normals"));
  CHECK(mesh_in(scratch.path("s.ply")).point_channels.empty());
}

TEST_CASE("simplify reaches its target, and its counts are those of the file") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(4)));
  const std::string out = scratch.path("out.ply");
  const auto object = vkmesh_run({"simplify", in, out, "--ratio", "0.1", "--json"}).json();
  CHECK(object.at("input").at("faces") == 5120);
  CHECK(object.at("output").at("faces") == 512);
  CHECK(object.at("result").at("stop") == "target reached");
  CHECK(object.at("result").at("ratio") == 0.1);
  // Each collapse on a closed surface takes two faces and one point.
  CHECK(object.at("result").at("collapses") == (5120 - 512) / 2);
  CHECK(object.at("output").at("points") == 2562 - (5120 - 512) / 2);
  CHECK(object.at("result").at("error") > 0.0);
  CHECK(mesh_in(out).face_count() == 512);
  CHECK(vkmesh_run({"info", out, "--json"}).json().at("result").at("genus") == 0);

  const auto faces = vkmesh_run({"simplify", in, out, "--faces", "100", "--json"}).json();
  CHECK(faces.at("output").at("faces") == 100);
}

TEST_CASE("simplify says in words why it stopped") {
  const Scratch scratch;
  const std::string out = scratch.path("out.ply");
  const std::string sphere = scratch.file("sphere.off", off_of(icosphere(3)));
  const Outcome bound = vkmesh_run({"simplify", sphere, out, "--error", "1e-9"});
  CHECK(bound.code == 0);
  CHECK_THAT(bound.out, Contains("would exceed the error of 1e-09"));
  const auto object = vkmesh_run({"simplify", sphere, out, "--error", "0.01", "--json"}).json();
  CHECK(object.at("result").at("stop") == "error bound");
  CHECK(object.at("result").at("error") <= 0.01);
  CHECK(object.at("output").at("faces") < 1280);
  // Any collapse would lay the last two faces of a tetrahedron on one another.
  const Outcome stuck =
      vkmesh_run({"simplify", scratch.file("t.off", kTetrahedronOff), out, "--ratio", "0.5"});
  CHECK(stuck.code == 0);
  CHECK_THAT(stuck.out, Contains("no collapse is left"));
}

TEST_CASE("simplify keeps point attributes with their points, and names what it drops") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(2)));
  const std::string normals = scratch.path("n.ply"), out = scratch.path("out.ply");
  REQUIRE(vkmesh_run({"normals", in, normals, "--device", "cpu"}).code == 0);
  REQUIRE(
      vkmesh_run({"simplify", normals, out, "--ratio", "0.5", "--operation", "half-edge-collapse"}).code ==
      0);
  const IndexedFaceSet before = mesh_in(normals), after = mesh_in(out);
  const auto all = floats_of(before, "normal"), few = floats_of(after, "normal");
  for (std::size_t i = 0; i < after.points.size(); ++i) {
    const auto at = std::find(before.points.begin(), before.points.end(), after.points[i]);
    REQUIRE(at != before.points.end());
    const auto v = static_cast<std::size_t>(at - before.points.begin());
    for (std::size_t k = 0; k < 3; ++k) CHECK(few[3 * i + k] == all[3 * v + k]);
  }

  const std::string obj = scratch.file("in.obj",
                                       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                       "f 1/1 2/2 3/3\nf 1/4 3/2 4/1\n");
  const Outcome dropped = vkmesh_run({"simplify", obj, out, "--ratio", "1", "--json"});
  REQUIRE(dropped.code == 0);
  CHECK_THAT(dropped.json().at("notes").dump(), Contains("uv"));
}
