// vkmesh optimize: edge swaps.
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "meshes.h"
#include "output.h"
#include "program.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

/// A bent sheet of n by n squares, all diagonals of which run the same, long way; the half with x < n / 2 is
/// of another material, with texture coordinates of its own.
std::string sheared_obj(int n, bool seam) {
  std::string text = "mtllib none.mtl\n";
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double x = j + 0.8 * i, y = i, z = 0.02 * (i * i + j * j + 3 * i * j) / n;
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
        text += "vt " + std::to_string(0.4 * j / n + 0.5 * side) + " " + std::to_string(1.0 * i / n) + "\n";
  for (int side = 0; side < 2; ++side) {
    text += "usemtl m" + std::to_string(side) + "\n";
    for (int i = 0; i < n; ++i)
      for (int j = side * n / 2; j < (side + 1) * n / 2; ++j) {
        const int a = i * (n + 1) + j + 1, b = a + 1, d = a + n + 1, c = d + 1;
        const auto corner = [&](int v) {
          return " " + std::to_string(v) + (seam ? "/" + std::to_string(v + side * (n + 1) * (n + 1)) : "");
        };
        text += "f" + corner(a) + corner(b) + corner(c) + "\nf" + corner(a) + corner(c) + corner(d) + "\n";
      }
  }
  return text;
}

}  // namespace

TEST_CASE("optimize swaps by every criterion, and tells what became better") {
  const Scratch scratch;
  const std::string in = scratch.file("sheet.obj", sheared_obj(8, false)), out = scratch.path("out.ply");
  for (const char* criterion :
       {"max-min-angle", "aspect-ratio", "delaunay", "mean-curvature", "squared-curvature", "curvature",
        "curvature=mean", "curvature=squared", "curvature=absolute", "dihedral-angle", "valence"}) {
    CAPTURE(criterion);
    const Outcome run = vkmesh_run({"optimize", in, out, "--criterion", criterion, "--json"});
    REQUIRE(run.code == 0);
    const auto result = run.json()["result"];
    CHECK(result["stop"] == "no gain");
    CHECK(result["cost_after"] <= result["cost_before"]);
    if (std::string(criterion) == "max-min-angle") {
      CHECK(result["swaps"] > 30);
      CHECK(result["angles_after"]["mean_least"] > result["angles_before"]["mean_least"]);
    }
    CHECK(vkmesh_run({"info", out, "--json"}).json()["result"]["faces"] == 128);
  }
  const Outcome both =
      vkmesh_run({"optimize", in, out, "--criterion", "valence=0.1", "--criterion", "max-min-angle=2"});
  CHECK(both.code == 0);
  CHECK_THAT(both.out, Contains("swapped"));
  CHECK_THAT(both.out, Contains("angles after"));
}

TEST_CASE("optimize leaves seams and borders of materials unless told otherwise") {
  const Scratch scratch;
  const std::string in = scratch.file("sheet.obj", sheared_obj(8, true)), out = scratch.path("out.obj");
  const Outcome kept = vkmesh_run({"optimize", in, out, "--json"});
  REQUIRE(kept.code == 0);
  const auto result = kept.json()["result"];
  CHECK(result["held"]["seam"].get<int>() + result["held"]["material_border"].get<int>() >= 0);
  const auto boundary = [](const std::string& file) {
    return vkmesh_run({"info", file, "--json"}).json()["result"]["boundary_edges"];
  };
  CHECK(boundary(out) == boundary(in));
  // Every face has the texture coordinates of its side.
  const std::string text = content_of(out);
  CHECK_THAT(text, Contains("usemtl m0") && Contains("usemtl m1") && Contains("vt "));
  const Outcome free = vkmesh_run({"optimize", in, out, "--no-seams", "--no-material-borders", "--json"});
  REQUIRE(free.code == 0);
  CHECK(free.json()["result"]["swaps"] >= result["swaps"]);
  CHECK(free.json()["result"]["held"]["seam"] == 0);
  CHECK(free.json()["result"]["held"]["material_border"] == 0);
}

TEST_CASE("optimize takes texture coordinates that are no numbers") {
  const Scratch scratch;
  const int n = 12;
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex " + std::to_string((n + 1) * (n + 1)) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(2 * n * n) +
      "\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n";
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) text += std::to_string(j + 0.8 * i) + " " + std::to_string(i) + " 0\n";
  int number = 0;
  const auto face = [&](int a, int b, int c) {
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " 6";
    for (int k = 0; k < 6; ++k)
      text += number++ % 3 == 0 ? " nan" : " " + std::to_string(number * 7919 % 101);
    text += "\n";
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + 1, d = a + n + 1, c = d + 1;
      face(a, b, c);
      face(a, c, d);
    }
  const std::string in = scratch.file("nan.ply", text);
  const Outcome run = vkmesh_run({"optimize", in, scratch.path("out.ply"), "--json"});
  REQUIRE(run.code == 0);
  CHECK(run.json()["result"]["swaps"] == 0);  // every edge is a seam
  CHECK(vkmesh_run({"optimize", in, scratch.path("free.ply"), "--no-seams", "--json"})
            .json()["result"]["swaps"] > 30);
}

TEST_CASE("optimize obeys its bounds, and refuses what does not go together") {
  const Scratch scratch;
  const std::string in = scratch.file("sheet.obj", sheared_obj(8, false)), out = scratch.path("out.ply");
  const auto swaps = [&](std::vector<std::string> options) {
    std::vector<std::string> arguments = {"optimize", in, out, "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome run = vkmesh_run(arguments);
    REQUIRE(run.code == 0);
    return run.json()["result"]["swaps"].get<int>();
  };
  const int all = swaps({});
  CHECK(swaps({"--max-swaps", "3"}) == 3);
  CHECK(swaps({"--max-deviation", "1e-5"}) < all);
  CHECK(swaps({"--max-relative-deviation", "1e-7"}) < all);
  CHECK(swaps({"--max-dihedral-change", "0.001"}) < all);
  CHECK(swaps({"--keep-creases", "0.001"}) < all);
  CHECK(swaps({"--time-limit", "0"}) == 0);
  const auto refused = [&](std::vector<std::string> options, int code, const std::string& word) {
    std::vector<std::string> arguments = {"optimize", in, out};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome run = vkmesh_run(arguments);
    CHECK(run.code == code);
    CHECK_THAT(run.err, Contains(word));
  };
  refused({"--criterion", "beauty"}, 2, "max-min-angle");
  refused({"--criterion", "valence=0"}, 2, "weight");
  refused({"--criterion", "normals"}, 4, "normals");
  refused({"--rounds", "--criterion", "valence"}, 2, "--rounds");
  refused({"--rounds", "--max-swaps", "3"}, 2, "--rounds");
  refused({"--max-deviation", "1", "--max-relative-deviation", "1"}, 2, "--max");
  const std::string cloud = scratch.file("cloud.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  const Outcome run = vkmesh_run({"optimize", cloud, out});
  CHECK(run.code == 4);
  CHECK_THAT(run.err, Contains("point cloud"));
}

TEST_CASE("optimize in rounds gives the same bytes on a device", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("sheet.obj", sheared_obj(10, true));
  std::vector<std::string> contents;
  for (const char* device : {"cpu", "llvmpipe"}) {
    const std::string out = scratch.path(std::string(device) + ".ply");
    const Outcome run =
        vkmesh_run({"optimize", in, out, "--rounds", "--keep-creases", "60", "--device", device, "--json"});
    REQUIRE(run.code == 0);
    const auto result = run.json()["result"];
    CHECK(result["swaps"] > 20);
    CHECK(result["stop"] == "no gain");
    contents.push_back(content_of(out));
  }
  CHECK(contents[0] == contents[1]);
  const Outcome one =
      vkmesh_run({"optimize", in, scratch.path("one.ply"), "--rounds", "1", "--device", "cpu", "--json"});
  REQUIRE(one.code == 0);
  CHECK(one.json()["result"]["rounds"] == 1);
  CHECK(one.json()["result"]["stop"] == "number of rounds");
}
