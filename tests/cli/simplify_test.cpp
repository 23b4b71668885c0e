// What simplify makes of attributes, materials and sheets that meet, and what it says of what it could not
// do.
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
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

std::string number(double x) {
  return std::to_string(x) + " ";
}

/// A sheet of n by n squares over the unit square, bent a little. What the coordinates of each point are, x,
/// y and a third of its own, are its texture coordinates and its colour, too.
std::string sheet_ply(int n, const std::string& more_header = {}, const std::string& more_values = {}) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex " + std::to_string((n + 1) * (n + 1)) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n" +
      more_header + "element face " + std::to_string(2 * n * n) +
      "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double x = 1.0 * j / n, y = 1.0 * i / n;
      text += number(x) + number(y) + number(0.05 * std::sin(5 * x) * std::cos(4 * y)) + number(x) +
              number(y) + std::to_string(std::lround(255 * x)) + " " + std::to_string(std::lround(255 * y)) +
              " 7 " + more_values + "\n";
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
      for (const auto& [p, q, r] : {std::array{a, b, d}, std::array{a, d, c}})
        text += "3 " + std::to_string(p) + " " + std::to_string(q) + " " + std::to_string(r) + "\n";
    }
  return text;
}

/// A flat square of n by n squares with a disc of another material, or a third of the square.
std::string materials_obj(int n, bool disc) {
  std::string text;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) text += "v " + number(1.0 * j / n) + number(1.0 * i / n) + "0\n";
  std::string last;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = (j + 0.5) / n - 0.5, y = (i + 0.5) / n - 0.5;
      const std::string name = (disc ? std::hypot(x, y) < 0.3 : x < -0.2) ? "red" : "grey";
      if (name != last) text += "usemtl " + name + "\n";
      last = name;
      const int a = i * (n + 1) + j + 1, b = a + 1, c = a + n + 1, d = c + 1;
      for (const auto& [p, q, r] : {std::array{a, b, d}, std::array{a, d, c}})
        text += "f " + std::to_string(p) + " " + std::to_string(q) + " " + std::to_string(r) + "\n";
    }
  return text;
}

/// The area of the faces of one material.
double area_of_material(const IndexedFaceSet& mesh, const std::string& name) {
  const Channel* channel = find_channel(mesh.face_channels, "material");
  REQUIRE(channel != nullptr);
  double sum = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto number =
        std::visit([&](const auto& v) { return static_cast<std::size_t>(v[f]); }, channel->values);
    if (channel->labels[number] != name) continue;
    const Vec3 a = mesh.points[mesh.face(f)[0]], b = mesh.points[mesh.face(f)[1]] - a,
               c = mesh.points[mesh.face(f)[2]] - a;
    sum += 0.5 * static_cast<double>(std::fabs(b.x * c.y - b.y * c.x));
  }
  return sum;
}

/// The values of a channel of points, of any type.
std::vector<float> values_of(const IndexedFaceSet& mesh, const std::string& name) {
  const Channel* channel = find_channel(mesh.point_channels, name);
  REQUIRE(channel != nullptr);
  return std::visit([](const auto& v) { return std::vector<float>(v.begin(), v.end()); }, channel->values);
}

}  // namespace

TEST_CASE("simplify makes what points have fit where they are moved to, seam or none") {
  const Scratch scratch;
  const std::string in = scratch.file("in.ply", sheet_ply(30)), out = scratch.path("out.ply");
  const auto object = vkmesh_run({"simplify", in, out, "--ratio", "0.1", "--json"}).json();
  CHECK(object.at("result").at("attributes") == std::vector<std::string>{"color", "uv"});
  const IndexedFaceSet mesh = mesh_in(out);
  const auto uv = values_of(mesh, "uv"), color = values_of(mesh, "color");
  REQUIRE(uv.size() == 2 * mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    for (int k = 0; k < 2; ++k) {
      const auto i = static_cast<std::size_t>(k);
      CHECK(std::fabs(uv[2 * v + i] - mesh.points[v][k]) < 0.01f);
      CHECK(std::fabs(color[3 * v + i] - 255 * mesh.points[v][k]) < 4);
    }

  // The same values at corners, of which none differ at a point.
  std::string obj;
  const IndexedFaceSet sheet = mesh_in(in);
  for (const Vec3& p : sheet.points)
    obj += "v " + number(p.x) + number(p.y) + number(p.z) + "\nvt " + number(p.x) + number(p.y) + "\n";
  for (std::size_t f = 0; f < sheet.face_count(); ++f) {
    obj += "f";
    for (const std::uint32_t v : sheet.face(f))
      obj += " " + std::to_string(v + 1) + "/" + std::to_string(v + 1);
    obj += "\n";
  }
  const auto same = vkmesh_run({"simplify", scratch.file("in.obj", obj), scratch.path("out.obj"), "--ratio",
                                "0.1", "--json"})
                        .json();
  CHECK(same.at("result").at("attributes") == std::vector<std::string>{"uv"});

  // What numbers things is never mixed: it stays that of some point.
  const std::string labelled =
      scratch.file("labelled.ply", sheet_ply(12, "property int part\nproperty uchar kind\n", "40 9"));
  const Outcome told = vkmesh_run({"simplify", labelled, out, "--ratio", "0.3"});
  REQUIRE(told.code == 0);
  CHECK_THAT(told.out, Contains("each has the part, kind of a point that it stands for"));
  for (const float x : values_of(mesh_in(out), "part")) CHECK(x == 40);

  // Attributes that were dropped are gone, and the result is that of a mesh without.
  REQUIRE(vkmesh_run(
              {"simplify", in, out, "--ratio", "0.1", "--drop-attribute", "uv", "--drop-attribute", "color"})
              .code == 0);
  CHECK(mesh_in(out).point_channels.empty());
  const Outcome unknown = vkmesh_run({"simplify", in, out, "--ratio", "0.1", "--drop-attribute", "st"});
  CHECK(unknown.code == 2);
  CHECK_THAT(unknown.err, Contains("--drop-attribute st"));
}

TEST_CASE("simplify keeps the borders of materials, unless it is told to let them go") {
  const Scratch scratch;
  const std::string in = scratch.file("in.obj", materials_obj(40, true)), out = scratch.path("out.obj");
  const double whole = area_of_material(mesh_in(in), "red");
  for (const std::string operation : {"edge-collapse", "half-edge-collapse", "vertex-removal"}) {
    CAPTURE(operation);
    REQUIRE(vkmesh_run({"simplify", in, out, "--ratio", "0.02", "--operation", operation}).code == 0);
    CHECK(mesh_in(out).face_count() <= 64);
    CHECK(area_of_material(mesh_in(out), "red") == Approx(whole).epsilon(0.05));
  }
  REQUIRE(vkmesh_run({"simplify", in, out, "--faces", "6", "--no-material-borders"}).code == 0);
  CHECK(mesh_in(out).face_count() <= 6);

  // A value of its own for each face makes no borders, and what makes some is named where nothing can go.
  std::string
      colours =
          "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 8\nproperty list uchar int vertex_indices\nproperty uchar red\n"
          "property uchar green\nproperty uchar blue\nend_header\n",
      parts =
          "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 8\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n";
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (std::string* text : {&colours, &parts}) *text += number(i) + number(j) + "0\n";
  for (int f = 0; f < 8; ++f) {
    const int a = f / 4 * 3 + f / 2 % 2, b = a + 3, c = b + 1, d = a + 1;
    const std::string face =
        f % 2 == 0 ? "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c)
                   : "3 " + std::to_string(a) + " " + std::to_string(c) + " " + std::to_string(d);
    colours += face + " " + std::to_string(30 * f) + " 0 0\n";
    parts += face + " " + std::to_string(f) + "\n";
  }
  const Outcome free = vkmesh_run({"simplify", scratch.file("colours.ply", colours), out, "--faces", "2"});
  CHECK_THAT(free.out, Contains("changes from face to face"));
  CHECK(mesh_in(out).face_count() == 2);
  const Outcome held = vkmesh_run({"simplify", scratch.file("parts.ply", parts), out, "--faces", "2"});
  CHECK_THAT(held.out, Contains("--no-material-borders"));
  CHECK(mesh_in(out).face_count() == 8);
}

TEST_CASE("simplify names the option that frees seams where nothing can go") {
  const Scratch scratch;
  const std::string in = scratch.file("in.obj", octahedron_of_seams()), out = scratch.path("a.off");
  const Outcome held = vkmesh_run({"simplify", in, out, "--ratio", "0.5"});
  REQUIRE(held.code == 0);
  CHECK(mesh_in(out).face_count() == 8);
  CHECK_THAT(held.out, Contains("(a seam would break)") && Contains("--drop-attribute uv"));
  REQUIRE(vkmesh_run({"simplify", in, out, "--ratio", "0.5", "--drop-attribute", "uv"}).code == 0);
  CHECK(mesh_in(out).face_count() <= 4);
}

TEST_CASE("simplify leaves no gap where three sheets meet") {
  const Scratch scratch;
  constexpr int kLength = 20, kWidth = 10;
  IndexedFaceSet mesh;
  const auto at = [&](int sheet, int i, int j) {  // j == 0: on the curve that all share
    return static_cast<std::uint32_t>(j == 0 ? i : (kLength + 1) * (1 + sheet * kWidth + j - 1) + i);
  };
  mesh.points.resize((kLength + 1) * (1 + 3 * kWidth));
  for (int sheet = 0; sheet < 3; ++sheet)
    for (int j = 0; j <= kWidth; ++j)
      for (int i = 0; i <= kLength; ++i) {
        const double angle = 2.1 * sheet, r = 0.1 * j;
        mesh.points[at(sheet, i, j)] =
            Vec3(0.1 * i, r * std::cos(angle) + 0.2 * std::sin(0.3 * i), r * std::sin(angle));
      }
  std::string text =
      "OFF\n" + std::to_string(mesh.points.size()) + " " + std::to_string(3 * 2 * kLength * kWidth) + " 0\n";
  for (const Vec3& p : mesh.points) text += number(p.x) + number(p.y) + number(p.z) + "\n";
  for (int sheet = 0; sheet < 3; ++sheet)
    for (int j = 0; j < kWidth; ++j)
      for (int i = 0; i < kLength; ++i) {
        const auto a = at(sheet, i, j), b = at(sheet, i + 1, j), c = at(sheet, i + 1, j + 1),
                   d = at(sheet, i, j + 1);
        for (const auto& [p, q, r] : {std::array{a, b, c}, std::array{a, c, d}})
          text += "3 " + std::to_string(p) + " " + std::to_string(q) + " " + std::to_string(r) + "\n";
      }
  const std::string in = scratch.file("in.off", text), out = scratch.path("out.off");
  const Outcome outcome = vkmesh_run({"simplify", in, out, "--ratio", "0.3"});
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.out, Contains("or gaps would open between them"));
  const IndexedFaceSet after = mesh_in(out);
  CHECK(after.face_count() <= 360);
  std::map<std::array<float, 3>, int> copies;
  for (const Vec3& p : after.points) ++copies[{p.x, p.y, p.z}];
  for (int i = 0; i <= kLength; ++i) {
    const Vec3 p = mesh_in(in).points[static_cast<std::size_t>(i)];
    CHECK(copies[{p.x, p.y, p.z}] == 3);
  }
}

TEST_CASE("simplify answers in the words and units that were typed") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff), out = scratch.path("o.off");
  const auto error = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"simplify", in, out, "--ratio", "0.5"});
    const Outcome outcome = vkmesh_run(more);
    CHECK(outcome.code == 2);
    return outcome.err;
  };
  CHECK_THAT(error({"--max-normal-deviation", "180"}),
             Contains("--max-normal-deviation") && Contains("is no number between 0.001 and 180"));
  CHECK_THAT(error({"--max-valence", "2"}), Contains("--max-valence"));
  CHECK_THAT(error({"--criterion", "quadric=0"}), Contains("--criterion"));
}
