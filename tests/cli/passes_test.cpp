// vkmesh normals, curvature, creases, smooth and simplify on the host, on meshes with known answers.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "meshes.h"
#include "output.h"
#include "program.h"
#include "support/shapes.h"
#include "support/vectors.h"

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

TEST_CASE("normals of a cube of quads are its diagonals") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff), out = scratch.path("out.ply");
  for (const char* weights : {"area", "angle", "uniform"}) {
    REQUIRE(vkmesh_run({"normals", in, out, "--device", "cpu", "--weights", weights}).code == 0);
    const IndexedFaceSet mesh = mesh_in(out);
    REQUIRE_FALSE(mesh.is_triangles());
    for (const float n : floats_of(mesh, "normal")) CHECK(std::abs(n) == Approx(1 / std::sqrt(3.0)));
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

TEST_CASE("curvature of a sphere is 1/r and 1/r squared, of the dihedral kind unless told otherwise") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(3, 2.0f)));
  const std::string out = scratch.path("out.ply");
  struct Kind {
    std::string name, unit;
    double value;
  };
  // Coordinates have six digits in the file, on edges of 0.3; the formulas come within 0.002 here.
  for (const Kind& kind : {Kind{"mean", "1 / length", 0.5}, Kind{"gaussian", "1 / length^2", 0.25}}) {
    const auto result = vkmesh_run({"curvature", in, out, "--kind", kind.name, "--device", "cpu", "--json"})
                            .json()
                            .at("result");
    CHECK(result.at("kind") == kind.name);
    CHECK(result.at("unit") == kind.unit);
    const std::vector<float> values = floats_of(mesh_in(out), "quality");
    REQUIRE(values.size() == 642);
    for (const float value : values) CHECK(static_cast<double>(value) == Approx(kind.value).epsilon(0.01));
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    CHECK(result.at("smallest") == static_cast<double>(*least));
    CHECK(result.at("largest") == static_cast<double>(*most));
    CHECK(result.at("mean").get<double>() == Approx(kind.value).epsilon(0.005));
  }
  const auto usual = vkmesh_run({"curvature", in, out, "--device", "cpu", "--json"}).json().at("result");
  CHECK(usual.at("kind") == "dihedral");
}

TEST_CASE("creases of a cube are twelve lines, or one loop of what is left of a side") {
  const Scratch scratch;
  const std::string cube = scratch.file("cube.off", kCubeOff), out = scratch.path("out.obj");
  const auto run = [&](const std::string& in, std::vector<std::string> more) {
    more.insert(more.begin(), {"creases", in, "--device", "cpu", "--json"});
    const Outcome outcome = vkmesh_run(more);
    REQUIRE(outcome.code == 0);
    return outcome.json();
  };
  const auto object = run(cube, {out});
  CHECK(object.at("command") == "creases");
  CHECK(object.at("result") ==
        nlohmann::json({{"creases", 12}, {"loops", 0}, {"edges", 12}, {"length", 12.0}}));
  const std::string text = content_of(out);
  CHECK(std::count(text.begin(), text.end(), 'v') == 8);
  CHECK(std::count(text.begin(), text.end(), 'l') == 12);
  // Without OUT they are counted; with - they go to standard output.
  CHECK(run(cube, {}).at("result").at("creases") == 12);
  CHECK(vkmesh_run({"creases", cube, "-", "--device", "cpu"}).out == text);

  CHECK(run(cube, {"--kind", "convex"}).at("result").at("edges") == 12);
  CHECK(run(cube, {"--kind", "concave"}).at("result").at("edges") == 0);
  CHECK(run(cube, {"--sharp", "89.9", "--soft", "89.9"}).at("result").at("edges") == 12);
  CHECK(run(cube, {"--sharp", "90.1"}).at("result").at("edges") == 0);
  CHECK(run(cube, {"--sharp", "180", "--soft", "180"}).at("result").at("edges") == 0);
  // No edge of a cube has a free end.
  CHECK(run(cube, {"--min-length", "2"}).at("result").at("creases") == 12);

  const std::string plane = scratch.file("plane.off", off_of(grid(3, 2)));
  CHECK(run(plane, {}).at("result").at("creases") == 0);
  const auto loop = run(plane, {out, "--with-boundary"}).at("result");
  CHECK(loop == nlohmann::json({{"creases", 1}, {"loops", 1}, {"edges", 10}, {"length", 10.0}}));
  CHECK_THAT(content_of(out), Catch::EndsWith(" 1\n") && Contains("\nl 1 "));
  CHECK(run(plane, {"--with-boundary", "--min-length", "11"}).at("result").at("creases") == 0);
}

TEST_CASE(
    "smooth by laplacian moves each point of a tetrahedron by lambda of the way to the mean of the others") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff), out = scratch.path("out.ply");
  const IndexedFaceSet before = mesh_in(in);
  const auto step = [](const std::vector<DVec3>& points, double share) {
    std::vector<DVec3> moved = points;
    for (std::size_t i = 0; i < 4; ++i) {
      DVec3 mean(0.0);
      for (std::size_t j = 0; j < 4; ++j)
        if (j != i) mean += points[j] / 3.0;
      moved[i] += share * (mean - points[i]);
    }
    return moved;
  };
  const auto check = [&](const std::vector<DVec3>& expected) {
    const IndexedFaceSet after = mesh_in(out);
    for (std::size_t i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k)
        CHECK(std::abs(static_cast<double>(after.points[i][k]) - expected[i][k]) < 1e-6);
  };
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(),
                {"smooth", in, out, "--lambda", "0.25", "--iterations", "1", "--device", "cpu", "--json"});
    const Outcome outcome = vkmesh_run(more);
    REQUIRE(outcome.code == 0);
    return outcome.json().at("result");
  };
  const std::vector<DVec3> start(before.points.begin(), before.points.end());
  const auto plain = run({"--method", "laplacian"});
  CHECK(plain.at("method") == "laplacian");
  CHECK(plain.at("iterations") == 1);
  CHECK(plain.at("lambda") == 0.25);
  CHECK(plain.at("mu") == 0.0);
  CHECK(plain.at("weights") == "uniform");
  CHECK(plain.at("boundary") == "fixed");
  CHECK(plain.at("keep_volume") == false);
  check(step(start, 0.25));
  // Taubin, which is the default, goes back by a little more: -lambda / (1 - 0.1 lambda).
  const auto taubin = run({});
  CHECK(taubin.at("method") == "taubin");
  CHECK(taubin.at("mu").get<double>() == Approx(-0.25 / 0.975).epsilon(1e-6));
  check(step(step(start, 0.25), -0.25 / 0.975));
  CHECK(run({"--mu", "-0.75"}).at("mu") == -0.75);
  check(step(step(start, 0.25), -0.75));
}

TEST_CASE("smooth by bilateral leaves a plane alone, and takes noise off a sphere") {
  const Scratch scratch;
  const std::string out = scratch.path("out.ply");
  const auto run = [&](const std::string& in, std::vector<std::string> more) {
    more.insert(more.begin(), {"smooth", in, out, "--method", "bilateral", "--device", "cpu", "--json"});
    const Outcome outcome = vkmesh_run(more);
    REQUIRE(outcome.code == 0);
    return outcome.json().at("result");
  };
  const auto plane = run(scratch.file("plane.off", off_of(grid(5, 5))), {});
  CHECK(plane.at("largest_move") == 0.0);
  CHECK(plane.at("spatial") == 4.0);
  CHECK(plane.at("influence") == 1.0);
  IndexedFaceSet sphere = icosphere(4);
  jitter(sphere, 0.01f, 1);
  const auto result =
      run(scratch.file("sphere.off", off_of(sphere)), {"--spatial", "2.5", "--influence", "0.5"});
  CHECK(result.at("method") == "bilateral");
  CHECK(result.at("spatial") == 2.5);
  CHECK(result.at("influence") == 0.5);
  CHECK(result.at("mean_edge_length").get<double>() == Approx(0.075).epsilon(0.1));
  const auto roughness = [](const IndexedFaceSet& mesh) {
    double sum = 0, square = 0;
    for (const Vec3& p : mesh.points) {
      const DVec3 d(p);
      const double radius = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
      sum += radius;
      square += radius * radius;
    }
    const double n = static_cast<double>(mesh.points.size());
    return std::sqrt(square / n - sum / n * (sum / n));
  };
  CHECK(roughness(mesh_in(out)) < 0.6 * roughness(sphere));
}

TEST_CASE("smooth --keep-volume keeps it, of closed surfaces only") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(3))), out = scratch.path("out.ply");
  const auto volume = [](const std::string& path) {
    return vkmesh_run({"info", path, "--json"}).json().at("result").at("volume").get<double>();
  };
  const double before = volume(in);
  for (const std::string method : {"laplacian", "taubin", "bilateral"}) {
    CAPTURE(method);
    std::vector<std::string> arguments = {"smooth", in, out, "--method", method, "--device", "cpu", "--json"};
    arguments.push_back("--no-keep-volume");
    REQUIRE(vkmesh_run(arguments).code == 0);
    // One part in ten thousand is far more than float sums of a sphere are off.
    CHECK(volume(out) != Approx(before).epsilon(1e-4));
    arguments.back() = "--keep-volume";
    const Outcome outcome = vkmesh_run(arguments);
    REQUIRE(outcome.code == 0);
    CHECK(outcome.json().at("result").at("keep_volume") == true);
    CHECK(volume(out) == Approx(before).epsilon(1e-4));
  }
  const std::string open = scratch.file("open.off", off_of(grid(3, 3))), none = scratch.path("none.ply");
  for (const std::string method : {"laplacian", "taubin", "bilateral"}) {
    const Outcome outcome =
        vkmesh_run({"smooth", open, none, "--method", method, "--keep-volume", "--device", "cpu"});
    CHECK(outcome.code == 4);
    CHECK_THAT(outcome.err, Contains("closed"));
  }
  CHECK(scratch.names() == std::vector<std::string>{"in.off", "open.off", "out.ply"});
}

TEST_CASE("smooth by bilateral keeps the volume of what is closed, and says that it does") {
  // Alone it moves a sphere of these widths outward by more than a hundredth.
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(3))), out = scratch.path("out.ply");
  const auto radius = [&](std::vector<std::string> more, bool keeps) {
    more.insert(more.begin(), {"smooth", in, out, "--method", "bilateral", "--device", "cpu", "--json"});
    const Outcome outcome = vkmesh_run(more);
    REQUIRE(outcome.code == 0);
    CHECK(outcome.json().at("result").at("keep_volume") == keeps);
    double sum = 0;
    const IndexedFaceSet mesh = mesh_in(out);
    for (const Vec3& p : mesh.points) sum += length(DVec3(p));
    return sum / static_cast<double>(mesh.points.size());
  };
  CHECK(radius({}, true) == Approx(1).epsilon(1e-3));
  CHECK(radius({"--no-keep-volume"}, false) > 1.01);
  // An open surface has none to keep.
  const std::string open = scratch.file("open.off", off_of(grid(3, 3)));
  const Outcome outcome =
      vkmesh_run({"smooth", open, out, "--method", "bilateral", "--device", "cpu", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.json().at("result").at("keep_volume") == false);
}

TEST_CASE("smooth refuses a lambda and mu that make noise grow, and tells of shapes that grow") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(2))), out = scratch.path("out.ply");
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"smooth", in, out, "--device", "cpu", "--json"});
    return vkmesh_run(more);
  };
  for (const std::vector<std::string>& pair : {std::vector<std::string>{"--lambda", "1"},
                                               {"--lambda", "0.8"},
                                               {"--lambda", "0.1", "--mu", "-1"},
                                               {"--lambda", "0", "--mu", "-0.5"}}) {
    const Outcome outcome = run(pair);
    CHECK(outcome.code == 2);
    CHECK_THAT(outcome.err, Contains("--lambda " + pair[1] + " with --mu") && Contains("1/lambda + 1/mu"));
  }
  CHECK_FALSE(std::filesystem::exists(out));
  for (const std::vector<std::string>& pair :
       {std::vector<std::string>{"--lambda", "0.69", "--iterations", "50"},
        {"--lambda", "1", "--method", "laplacian"},
        {"--lambda", "0.6307", "--mu", "-0.6732"}}) {
    const Outcome outcome = run(pair);
    REQUIRE(outcome.code == 0);
    CHECK(outcome.json().at("notes").empty());
    for (const Vec3& p : mesh_in(out).points) CHECK(length(DVec3(p)) < 1.2);
  }
  // (1 - 0.5 k)(1 + 0.5263 k) is largest at k = 0.05, where it is 1.000658.
  CHECK_THAT(run({"--iterations", "1000"}).json().at("notes").dump(), Contains("by up to 1.93"));
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

TEST_CASE("What a command leaves out has a code, and --on-loss fail refuses it") {
  const Scratch scratch;
  const std::string in = scratch.file(
                        "in.obj",
                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.2 0.2 1\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n"
                        "f 1//1 3//1 2//1\nf 1//2 2//2 4//2\nf 2//3 3//3 4//3\nf 3//3 1//3 4//3\n"),
                    out = scratch.path("out.ply");
  const std::vector<std::pair<std::vector<std::string>, std::string>> commands = {
      {{"smooth", in, out, "--device", "cpu"}, "dropped.normal"},
      {{"simplify", in, out, "--faces", "4"}, "dropped.normal"},
      {{"optimize", in, out}, "dropped.normal"},
      {{"remesh", in, out, "--edge-length", "1"}, "dropped.normal"},
      {{"delaunay", in, out}, "dropped.heights"},
      {{"delaunay", in, out, "--z"}, "dropped.faces"},
      {{"voronoi", in, out}, "dropped.faces"}};
  for (auto [arguments, code] : commands) {
    CAPTURE(arguments);
    arguments.insert(arguments.end(), {"--on-loss", "fail"});
    const Outcome refused = vkmesh_run(arguments);
    CHECK(refused.code == 4);
    CHECK_THAT(refused.err, Contains("(dropped."));
    CHECK_FALSE(std::filesystem::exists(out));
    arguments.back() = "ignore";
    arguments.push_back("--json");
    const Outcome told = vkmesh_run(arguments);
    REQUIRE(told.code == 0);
    CHECK_THAT(told.json().at("losses").dump(), Contains(code));
    CHECK_THAT(told.json().at("notes").dump(), !Contains("left out"));
    std::filesystem::remove(out);
  }
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
  CHECK_THAT(bound.out, Contains("the error of 1e-09 holds what is left: 1,920 (the error is too large)"));
  const auto object = vkmesh_run({"simplify", sphere, out, "--error", "0.01", "--json"}).json();
  CHECK(object.at("result").at("stop") == "error bound");
  CHECK(object.at("result").at("error") <= 0.01);
  CHECK(object.at("output").at("faces") < 1280);
  // Any collapse would lay the last two faces of a tetrahedron on one another.
  const Outcome stuck =
      vkmesh_run({"simplify", scratch.file("t.off", kTetrahedronOff), out, "--ratio", "0.5"});
  CHECK(stuck.code == 0);
  CHECK_THAT(stuck.out, Contains("what is left is illegal: 6 (the manifold would break)"));
}

TEST_CASE("simplify takes criteria, and tells how far both surfaces are apart") {
  const Scratch scratch;
  const std::string out = scratch.path("out.ply");
  const std::string sphere = scratch.file("sphere.off", off_of(icosphere(4)));
  const auto object =
      vkmesh_run({"simplify", sphere, out, "--ratio", "0.01", "--max-distance", "0.01", "--json"}).json();
  const auto& result = object.at("result");
  CHECK(result.at("distance_bound") <= 0.01);
  CHECK(result.at("distance_bound") > 0.005);
  CHECK(result.at("held").at("criterion") > 0);
  CHECK(result.at("rejected_criterion") > 0);
  const auto compared = vkmesh_run({"compare", sphere, out, "--json"}).json();
  CHECK(compared.at("result").at("two_sided").at("hausdorff_low") <= result.at("distance_bound"));
  const Outcome told = vkmesh_run({"simplify", sphere, out, "--ratio", "0.1", "--watch-distance"});
  CHECK_THAT(told.out, Contains("no point of either surface is farther than"));
  CHECK(vkmesh_run({"simplify", sphere, out, "--ratio", "0.1", "--json"})
            .json()
            .at("result")
            .at("distance_bound")
            .is_null());
  const auto faces_by = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"simplify", sphere, out, "--ratio", "0.01", "--json"});
    return vkmesh_run(more).json().at("output").at("faces").get<int>();
  };
  const int all = faces_by({});
  CHECK(faces_by({"--max-original-normal-deviation", "15"}) > all);
  CHECK(faces_by({"--max-edge-length", "0.2"}) > all);
  CHECK(faces_by({"--max-aspect-ratio", "1.5"}) > all);
  CHECK(faces_by({"--max-valence", "5"}) > all);
  CHECK(faces_by({"--max-relative-distance", "0.001"}) > all);
  CHECK(faces_by({"--criterion", "density=1", "--criterion", "quadric=0", "--criterion", "aspect-ratio"}) ==
        all);
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
  const std::string kept = scratch.path("kept.obj");
  REQUIRE(vkmesh_run({"simplify", obj, kept, "--ratio", "1"}).code == 0);
  CHECK(corner_floats_of(mesh_in(kept), "uv") == corner_floats_of(mesh_in(obj), "uv"));
}

TEST_CASE("simplify keeps seams, and the points of the file where it is told to") {
  const Scratch scratch;
  // A tube of quads, unrolled, with a material for each half of its length and a normal for each quad.
  std::string text;
  constexpr int kRings = 30, kSides = 24;
  const auto number = [](double x) { return std::to_string(x) + " "; };
  for (int i = 0; i <= kRings; ++i)
    for (int j = 0; j <= kSides; ++j) {
      const double angle = 2 * std::numbers::pi * j / kSides;
      if (j < kSides)
        text += "v " + number(std::cos(angle)) + number(std::sin(angle)) + number(0.1 * i) + "\n";
      text += "vt " + number(1.0 * j / kSides) + number(1.0 * i / kRings) + "\n";
    }
  for (int j = 0; j < kSides; ++j)
    text += "vn " + number(std::cos(2 * std::numbers::pi * (j + 0.5) / kSides)) +
            number(std::sin(2 * std::numbers::pi * (j + 0.5) / kSides)) + "0\n";
  for (int i = 0; i < kRings; ++i) {
    if (i % (kRings / 2) == 0) text += "usemtl half" + std::to_string(2 * i / kRings) + "\n";
    for (int j = 0; j < kSides; ++j) {
      text += "f";
      for (const auto& [di, dj] : {std::pair{0, 0}, std::pair{0, 1}, std::pair{1, 1}, std::pair{1, 0}})
        text += " " + std::to_string((i + di) * kSides + (j + dj) % kSides + 1) + "/" +
                std::to_string((i + di) * (kSides + 1) + j + dj + 1) + "/" + std::to_string(j + 1);
      text += "\n";
    }
  }
  const std::string in = scratch.file("in.obj", text), out = scratch.path("out.obj");
  const auto object = vkmesh_run({"simplify", in, out, "--ratio", "0.2", "--json"}).json();
  CHECK(object.at("result").at("attributes") == std::vector<std::string>{"uv"});
  CHECK_THAT(object.at("notes").dump(), Contains("normal of corners was left out"));
  const IndexedFaceSet mesh = mesh_in(out);
  CHECK(mesh.face_count() <= 288);
  REQUIRE(find_channel(mesh.face_channels, "material") != nullptr);
  CHECK(find_channel(mesh.face_channels, "material")->labels == std::vector<std::string>{"half0", "half1"});
  const auto uv = corner_floats_of(mesh, "uv");
  REQUIRE(uv.size() == 2 * mesh.corners.size());
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    float low = 1, high = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float u = uv[6 * f + 2 * k], v = uv[6 * f + 2 * k + 1];
      low = std::min(low, u);
      high = std::max(high, u);
      CHECK(std::abs(v - mesh.points[face[k]].z / 3) < 0.01f);
    }
    CHECK(high - low < 0.5f);
  }

  // Normals of quads: nothing can move but along the quads' edges that run along the tube.
  const auto flat =
      vkmesh_run({"simplify", in, out, "--ratio", "0.2", "--attribute", "normal=0.1", "--json"}).json();
  CHECK(flat.at("result").at("attributes").size() == 2);
  const IndexedFaceSet sides = mesh_in(out);
  CHECK(sides.face_count() <= 288);
  const auto normals = corner_floats_of(sides, "normal");
  REQUIRE(normals.size() == 3 * sides.corners.size());
  for (std::size_t c = 0; c < sides.corners.size(); c += 3)
    for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(normals[3 * c + k] - normals[3 * c + 3 + k]) < 1e-4f);

  REQUIRE(
      vkmesh_run({"simplify", in, out, "--ratio", "0.2", "--operation", "half-edge-collapse", "--index-only"})
          .code == 0);
  const IndexedFaceSet all = mesh_in(in), level = mesh_in(out);
  CHECK(level.points == all.points);
  CHECK(level.face_count() <= 288);
  std::set<std::array<float, 3>> known;
  const auto before = corner_floats_of(all, "uv"), after = corner_floats_of(level, "uv");
  for (std::size_t c = 0; c < all.corners.size(); ++c)
    known.insert({static_cast<float>(all.corners[c]), before[2 * c], before[2 * c + 1]});
  for (std::size_t c = 0; c < level.corners.size(); ++c)
    CHECK(known.count({static_cast<float>(level.corners[c]), after[2 * c], after[2 * c + 1]}) == 1);

  const auto removed = vkmesh_run({"simplify", in, out, "--ratio", "0.2", "--operation", "vertex-removal",
                                   "--attribute", "uv=0.05", "--json"})
                           .json();
  CHECK(removed.at("result").at("attributes") == std::vector<std::string>{"uv"});
  const IndexedFaceSet rest = mesh_in(out);
  CHECK(rest.face_count() <= 288);
  const auto rest_uv = corner_floats_of(rest, "uv");
  REQUIRE(rest_uv.size() == 2 * rest.corners.size());
  for (std::size_t c = 0; c < rest.corners.size(); ++c) {
    const auto v = std::find(all.points.begin(), all.points.end(), rest.points[rest.corners[c]]);
    REQUIRE(v != all.points.end());
    CHECK(known.count({static_cast<float>(v - all.points.begin()), rest_uv[2 * c], rest_uv[2 * c + 1]}) == 1);
    CHECK(std::abs(rest_uv[2 * c] - rest_uv[2 * (c / 3 * 3)]) < 0.5f);  // no face runs over the seam
  }

  const auto error = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"simplify", in, out, "--ratio", "0.2"});
    const Outcome outcome = vkmesh_run(more);
    CHECK(outcome.code != 0);
    return outcome.err;
  };
  CHECK_THAT(error({"--index-only"}), Contains("add --operation half-edge-collapse"));
  CHECK_THAT(error({"--attribute", "colour"}), Contains("neither points nor corners"));
  CHECK_THAT(error({"--attribute", "uv=x"}), Contains("a number of at least 0"));
}

TEST_CASE("simplify leaves what is locked, and prunes what is small") {
  const Scratch scratch;
  const std::string out = scratch.path("out.ply");
  IndexedFaceSet mesh = icosphere(3);
  const std::size_t sphere = mesh.points.size();
  mesh = both(mesh, icosphere(0, 0.01f), Vec3(2.0f));
  std::string ply = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.points.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar mark\n"
                    "element face " +
                    std::to_string(mesh.face_count()) +
                    "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& p : mesh.points) {
    const bool mark = p.z > 0.5f && p.z < 1.5f;
    ply += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) +
           (mark ? " 1\n" : " 0\n");
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    ply += "3 " + std::to_string(mesh.face(f)[0]) + " " + std::to_string(mesh.face(f)[1]) + " " +
           std::to_string(mesh.face(f)[2]) + "\n";
  const std::string in = scratch.file("in.ply", ply);
  const Outcome outcome =
      vkmesh_run({"simplify", in, out, "--faces", "4", "--lock", "mark", "--prune-size", "0.1", "--json"});
  REQUIRE(outcome.code == 0);
  CHECK(outcome.json().at("result").at("pruned_components") == 1);
  CHECK(outcome.json().at("result").at("pruned_faces") == 20);
  const IndexedFaceSet left = mesh_in(out), before = mesh_in(in);
  CHECK(left.points.size() < sphere / 2);
  for (std::size_t v = 0; v < before.points.size(); ++v) {
    const bool is_left =
        std::find(left.points.begin(), left.points.end(), before.points[v]) != left.points.end();
    if (before.points[v].z > 0.5f && before.points[v].z < 1.5f) CHECK(is_left);
    if (v >= sphere) CHECK(!is_left);
  }
}
