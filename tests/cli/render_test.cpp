// vkmesh render: pictures, contact sheets, and what is refused.
#ifdef VKMESH_HAS_VULKAN

#include <algorithm>

#include <catch2/catch.hpp>

#include <vkmesh/picture/png.h>
#include <vkmesh/view/picture.h>

#include "meshes.h"
#include "program.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

Picture picture_in(const std::string& path) {
  const std::string bytes = content_of(path);
  auto picture = decode_png(std::as_bytes(std::span(bytes)));
  if (!picture) FAIL(picture.error().describe());
  return *std::move(picture);
}

std::ptrdiff_t count(const Picture& picture, Color color) {
  return std::count(picture.pixels().begin(), picture.pixels().end(), color);
}

constexpr Color kWhite{255, 255, 255, 255};

}  // namespace

TEST_CASE("render draws a mesh", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff), out = scratch.path("out.png");
  const auto object = vkmesh_run({"render", in, out, "--size", "200x100", "--json"}).json();
  CHECK(object.at("command") == "render");
  CHECK(object.at("input").at(0).at("points") == 8);
  CHECK(object.at("input").at(0).at("faces") == 6);
  CHECK(object.at("result").at("width") == 200);
  CHECK(object.at("result").at("height") == 100);
  CHECK(object.at("timings_ms").at("device").is_number());
  const Picture picture = picture_in(out);
  REQUIRE(picture.width() == 200);
  REQUIRE(picture.height() == 100);
  CHECK(picture.at(100, 50) != kWhite);
  CHECK(picture.at(2, 2) == kWhite);
  CHECK(scratch.names() == std::vector<std::string>{"in.off", "out.png"});
}

TEST_CASE("render writes the same bytes again, and to standard output", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff), out = scratch.path("out.png");
  CHECK(vkmesh_run({"render", in, out, "--size", "64x48", "--quiet"}).code == 0);
  const Outcome piped = vkmesh_run({"render", in, "-", "--size", "64x48", "--quiet"});
  CHECK(piped.code == 0);
  CHECK(piped.out == content_of(out));
}

TEST_CASE("render refuses a file without points, and writes no picture", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", "OFF\n0 0 0\n"), out = scratch.path("out.png");
  const Outcome outcome = vkmesh_run({"render", in, out, "--size", "64x48"});
  CHECK(outcome.code == 3);
  CHECK_THAT(outcome.err, Catch::Matchers::Contains("in.off: the file holds no"));
  CHECK(scratch.names() == std::vector<std::string>{"in.off"});
}

TEST_CASE("render refuses sizes, outputs and devices that make no picture", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff), out = scratch.path("out.png");
  const auto run = [&](std::vector<std::string> more, const std::string& to) {
    std::vector<std::string> arguments = {"render", in, to};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return vkmesh_run(arguments);
  };
  for (const std::string size :
       {"0x0", "0x10", "10x0", "-5x5", "10", "10x10x10", "axb", "1.5x10", "nanx10"}) {
    CAPTURE(size);
    CHECK(run({"--size", size}, out).code == 2);
  }
  const Outcome large = run({"--size", "100000x100000"}, out);
  CHECK(large.code == 2);
  CHECK_THAT(large.err, Contains("at most") && Contains("100000"));
  CHECK(run({}, scratch.path("no/folder/out.png")).code == 7);
  CHECK(run({}, scratch.path("out.jpg")).code == 2);
  CHECK(run({"--device", "no such device"}, out).code == 5);
  CHECK(run({"--device", "cpu"}, out).code == 5);
  CHECK(run({"--color", "temperature"}, out).code == 4);
  CHECK(run({"--style", "glossy"}, out).code == 2);
  CHECK(run({"--range", "3:1"}, out).code == 2);
  CHECK(run({"--target", "0,0,0"}, out).code == 2);
  CHECK(run({"--eye", "0,0,5", "--target", "0,0,5"}, out).code == 2);
  CHECK(run({"--caption", "a", "--caption", "b"}, out).code == 2);
  CHECK(vkmesh_run({"render", in}).code == 2);
  CHECK(vkmesh_run({"render", scratch.path("none.off"), out}).code == 3);
  const std::string bad = scratch.file("bad.off", "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n");
  CHECK(vkmesh_run({"render", bad, out}).code == 3);
  CHECK(scratch.names() == std::vector<std::string>{"bad.off", "in.off"});
}

TEST_CASE("render looks from where it is told", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kCubeOff), out = scratch.path("out.png");
  const auto drawn = [&](const std::string& eye, const std::string& target) {
    CHECK(vkmesh_run({"render", in, out, "--size", "64x48", "--eye", eye, "--target", target, "--quiet"})
              .code == 0);
    return 64 * 48 - count(picture_in(out), kWhite);
  };
  CHECK(drawn("0.5,0.5,6", "0.5,0.5,0") > 100);
  CHECK(drawn("0.5,0.5,6", "0.5,0.5,9") == 0);          // behind the camera
  CHECK(drawn("0.5,0.5,0.5", "0.5,0.5,0") == 64 * 48);  // inside
}

TEST_CASE("render shows what is wrong with a mesh", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("fin.off", kFinOff), out = scratch.path("out.png");
  const auto object = vkmesh_run({"render", in, out, "--size", "200x200", "--style", "wireframe",
                                  "--show-boundary", "--show-non-manifold", "--json"})
                          .json();
  CHECK(object.at("result").at("pictures").at(0).at("boundary_edges") == 6);
  CHECK(object.at("result").at("pictures").at(0).at("non_manifold_edges") == 1);
  const Picture picture = picture_in(out);
  // The swatches of the legend have 49 pixels each.
  CHECK(count(picture, {240, 130, 0, 255}) > 200);
  CHECK(count(picture, {220, 20, 30, 255}) > 100);
}

TEST_CASE("render makes a contact sheet with errors in its captions", "[device]") {
  const Scratch scratch;
  const std::string a = scratch.file("a.off", kCubeOff), b = scratch.file("b.off", kTetrahedronOff);
  const std::string out = scratch.path("out.png");
  const auto object =
      vkmesh_run({"render", a, b, a, out, "--size", "120x90", "--columns", "3", "--error", "--color",
                  "none,quality,valence", "--style", "flat", "--no-legend", "--json"})
          .json();
  const auto& pictures = object.at("result").at("pictures");
  REQUIRE(pictures.size() == 3);
  CHECK(pictures.at(1).at("error").get<double>() > 0.01);
  CHECK(pictures.at(2).at("error").get<double>() < 1e-9);
  // One camera for all.
  CHECK(pictures.at(0).at("eye") == pictures.at(1).at("eye"));
  const Picture sheet = picture_in(out);
  CHECK(sheet.width() == 360);
  CHECK(sheet.height() > 90 + 20);
  // Each has its picture above and its caption below.
  for (const std::uint32_t column : {0u, 1u, 2u}) {
    std::size_t above = 0, below = 0;
    for (std::uint32_t y = 0; y < sheet.height(); ++y)
      for (std::uint32_t x = 120 * column; x < 120 * (column + 1); ++x)
        if (sheet.at(x, y) != kWhite) ++(y < 90 ? above : below);
    CHECK(above > 500);
    CHECK(below > 100);
  }
}

TEST_CASE("render draws clouds as splats, and colours by attributes", "[device]") {
  const Scratch scratch;
  const std::string in =
      scratch.file("in.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                   "property float z\nproperty float heat\nend_header\n"
                   "0 0 0 1\n1 0 0 2\n0 1 0 3\n1 1 0 4\n");
  const std::string out = scratch.path("out.png");
  const auto object = vkmesh_run({"render", in, out, "--size", "120x120", "--color", "heat", "--azimuth", "0",
                                  "--elevation", "0", "--json"})
                          .json();
  CHECK(object.at("result").at("pictures").at(0).at("range") == nlohmann::json({1.0, 4.0}));
  CHECK(120 * 120 - count(picture_in(out), kWhite) > 1000);
  // The attribute named is not there, but the message names the one that is.
  CHECK_THAT(vkmesh_run({"render", in, out, "--color", "cold"}).err, Contains("heat"));
  CHECK(vkmesh_run({"render", in, out, "--color", "quality"}).code == 4);
}

#endif
