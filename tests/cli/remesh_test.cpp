// vkmesh remesh, on small meshes.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/consolidate.h>

#include "meshes.h"
#include "output.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

TEST_CASE("remesh makes edges of the length that is asked for, and says what it did") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(3))), out = scratch.path("out.ply");
  const auto object = vkmesh_run({"remesh", in, out, "--edge-length", "0.3", "--json"}).json();
  CHECK(object.at("command") == "remesh");
  const auto result = object.at("result");
  CHECK(result.at("stop") == "done");
  CHECK(result.at("edge_length").get<double>() == Approx(0.3));
  CHECK(result.at("mean_edge_length").get<double>() == Approx(0.3).epsilon(0.1));
  CHECK(result.at("collapses").get<int>() > 100);
  CHECK(result.at("largest_distance").get<double>() < 1e-5);
  CHECK(result.at("angles_after").at("mean_least").get<double>() > 48);
  CHECK(result.at("angles_after").at("below_30") == 0);
  CHECK(result.at("angles_before").at("least").get<double>() > 40);
  const IndexedFaceSet mesh = mesh_in(out);
  CHECK(mesh.face_count() < 500);
  CHECK(diagnose(mesh).value().manifold());
  // Without a length edges become as long as they are; --faces counts them.
  const auto own = vkmesh_run({"remesh", in, out, "--json"}).json().at("result");
  CHECK(own.at("edge_length").get<double>() == Approx(0.15).epsilon(0.1));
  REQUIRE(vkmesh_run({"remesh", in, out, "--faces", "600"}).code == 0);
  CHECK(static_cast<double>(mesh_in(out).face_count()) == Approx(600).epsilon(0.06));
  REQUIRE(vkmesh_run({"remesh", in, out, "--adaptive", "0.02", "--max-edge-length", "0.2"}).code == 0);
  CHECK(mesh_in(out).face_count() > 600);
}

TEST_CASE("remesh keeps creases, seams and the places of what is locked") {
  const Scratch scratch;
  const std::string cube = scratch.file("cube.off", kCubeOff), out = scratch.path("out.ply");
  REQUIRE(vkmesh_run({"remesh", cube, out, "--edge-length", "0.2", "--keep-creases", "40"}).code == 0);
  const IndexedFaceSet mesh = mesh_in(out);
  CHECK(mesh.face_count() > 200);
  for (const Vec3& p : mesh.points)
    CHECK((p.x == 0.0f || p.x == 1.0f || p.y == 0.0f || p.y == 1.0f || p.z == 0.0f || p.z == 1.0f));

  // Texture coordinates are those of the places, on either side of a seam: u jumps by 10 at x = 2.
  IndexedFaceSet plane = grid(4, 4);
  std::vector<float> uv;
  for (std::size_t f = 0; f < plane.face_count(); ++f)
    for (const std::uint32_t c : plane.face(f)) {
      const bool right = f / 2 % 4 >= 2;
      uv.insert(uv.end(), {plane.points[c].x + (right ? 10.0f : 0.0f), plane.points[c].y});
    }
  plane.corner_channels = {{"uv", 2, uv}};
  const std::string in = scratch.path("plane.obj");
  REQUIRE(write_mesh(in, plane, write_options_for(in).value()));
  REQUIRE(vkmesh_run({"remesh", in, scratch.path("out.obj"), "--edge-length", "0.4"}).code == 0);
  const IndexedFaceSet made = mesh_in(scratch.path("out.obj"));
  CHECK(made.face_count() > 100);
  const Channel* channel = find_channel(made.corner_channels, "uv");
  REQUIRE(channel != nullptr);
  const auto& values = std::get<std::vector<float>>(channel->values);
  std::set<bool> sides;
  for (std::size_t f = 0; f < made.face_count(); ++f) {
    float middle = 0;
    for (const std::uint32_t c : made.face(f)) middle += made.points[c].x / 3;
    sides.insert(middle > 2);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p = made.points[made.face(f)[i]];
      CHECK(values[2 * (3 * f + i)] == Approx(p.x + (middle > 2 ? 10 : 0)).margin(1e-4));
      CHECK(values[2 * (3 * f + i) + 1] == Approx(p.y).margin(1e-4));
    }
  }
  CHECK(sides.size() == 2);
}

TEST_CASE("remesh refuses what is out of range, and says so") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff), out = scratch.path("out.ply");
  struct Case {
    std::vector<std::string> more;
    std::string says;
    int code = 2;
  };
  for (const Case& one :
       {Case{{"--edge-length", "0"}, "--edge-length"}, Case{{"--edge-length", "-1"}, "--edge-length"},
        Case{{"--edge-length", "nan"}, "--edge-length"}, Case{{"--faces", "x"}, "--faces"},
        Case{{"--faces", "0"}, "--faces"}, Case{{"--edge-length", "1", "--faces", "5"}, "--edge-length"},
        Case{{"--max-deviation", "0"}, "--max-deviation"},
        Case{{"--max-deviation", "1", "--max-relative-deviation", "1"}, "--max-relative-deviation"},
        Case{{"--min-edge-length", "1"}, "--min-edge-length"}, Case{{"--lock", "mark"}, "mark"},
        Case{{"--boundary", "free"}, "--boundary"}, Case{{"--edge-length", "1e-9"}, "hundred million", 4}}) {
    std::vector<std::string> arguments = {"remesh", in, out};
    arguments.insert(arguments.end(), one.more.begin(), one.more.end());
    const Outcome outcome = vkmesh_run(arguments);
    CAPTURE(one.says, outcome.err);
    CHECK(outcome.code == one.code);
    CHECK_THAT(outcome.err, Contains(one.says));
  }
  CHECK(scratch.names().size() == 1);
}
