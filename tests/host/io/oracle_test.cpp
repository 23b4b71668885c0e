// Readers against slow ones that share nothing with them: the C library's strtod(), strips unrolled one
// corner at a time.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "io/io_support.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

/// A number in one of the ways in which programs write it.
std::string number_in_some_way(std::mt19937& random) {
  const auto printed = [&](const char* format, double value) {
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return std::string(text.data());
  };
  const double value =
      std::ldexp(std::uniform_real_distribution<double>(-1, 1)(random), static_cast<int>(random() % 40) - 20);
  switch (random() % 13) {
    case 0:
      return printed("%.3f", value);
    case 1:
      return printed("%.9g", value);
    case 2:
      return printed("%.17g", value);
    case 3:
      return printed("%e", value);
    case 4:
      return printed("%.1E", value);
    case 5:
      return printed("%+.4f", value);
    case 6:
      return printed("%.0f.", value);
    case 7:
      return printed("%.0f", value);
    case 8:
      return "." + std::to_string(random() % 1000);
    case 9:
      return printed("%.40f", value);
    case 10:
      return "-000" + std::to_string(random() % 1000) + ".5e+2";
    case 11:
      return "1e-" + std::to_string(30 + random() % 300);
    default:
      return "-0";
  }
}

/// Points as text, and as strtod() reads them.
struct TextPoints {
  std::vector<std::array<std::string, 3>> text;
  std::vector<Vec3> exact;

  explicit TextPoints(std::mt19937& random, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      text.emplace_back();
      exact.emplace_back(0.0f);
      for (int axis = 0; axis < 3; ++axis) {
        std::string& number = text.back()[static_cast<std::size_t>(axis)] = number_in_some_way(random);
        exact.back()[axis] = static_cast<float>(std::strtod(number.c_str(), nullptr));
      }
    }
  }
};

}  // namespace

TEST_CASE("numbers in any style are what strtod() reads, in every text format", "[io][oracle]") {
  std::mt19937 random(2020);
  for (int round = 0; round < 60; ++round) {
    const std::size_t faces = 1 + random() % 6;
    const TextPoints points(random, 3 * faces);
    const std::string end = random() % 2 == 0 ? "\n" : "\r\n";
    const auto blank = [&] { return std::string(1 + random() % 3, random() % 3 == 0 ? '\t' : ' '); };
    const auto comment = [&] { return random() % 3 == 0 ? blank() + "# 1 2 {[\"" + end : end; };
    std::string obj = "# first" + end, off = "OFF" + comment(), ply = "ply" + end + "format ascii 1.0" + end,
                xyz, stl = "solid a" + end;
    std::string iv = "#Inventor V2.1 ascii" + end + "Coordinate3 { point [" + comment(),
                wrl = "#VRML V2.0 utf8" + end +
                      "Shape { geometry IndexedFaceSet { coord Coordinate { point [" + comment();
    const std::string count = std::to_string(3 * faces), face_count = std::to_string(faces);
    off += count + blank() + face_count + " 0" + comment();
    ply += "element vertex " + count + end;
    for (const char* axis : {"x", "y", "z"}) ply += std::string("property double ") + axis + end;
    ply += "element face " + face_count + end + "property list uchar int vertex_indices" + end +
           "end_header" + end;
    for (std::size_t i = 0; i < 3 * faces; ++i) {
      const auto& p = points.text[i];
      const std::string line = p[0] + blank() + p[1] + blank() + p[2];
      obj += "v" + blank() + line + comment();
      off += line + comment();
      ply += line + end;
      xyz += line + end;
      iv += line + (random() % 2 == 0 ? "," : "") + comment();
      wrl += line + (random() % 2 == 0 ? " , " : " ") + comment();
      if (i % 3 == 0) stl += "facet normal 0 0 0" + end + "outer loop" + end;
      stl += "vertex" + blank() + line + end;
      if (i % 3 == 2) stl += "endloop" + end + "endfacet" + end;
    }
    stl += "endsolid a" + end;
    iv += "] }" + comment() + "FaceSet { numVertices [";
    wrl += "] } coordIndex [";
    for (std::size_t f = 0; f < faces; ++f) {
      const auto corner = [&](std::size_t k) { return std::to_string(3 * f + k); };
      obj += "f " + corner(1) + blank() + corner(2) + blank() + corner(3) + comment();
      off += "3" + blank() + corner(0) + blank() + corner(1) + " " + corner(2) + comment();
      ply += "3 " + corner(0) + " " + corner(1) + blank() + corner(2) + end;
      iv += " 3" + comment();
      wrl += corner(0) + "," + corner(1) + " " + corner(2) + " -1" + comment();
    }
    iv += "] }" + end;
    wrl += "] } }" + end;
    const std::pair<const char*, const std::string&> files[] = {
        {"a.obj", obj}, {"a.off", off}, {"a.ply", ply}, {"a.xyz", xyz},
        {"a.stl", stl}, {"a.iv", iv},   {"a.wrl", wrl}};
    for (const auto& [name, content] : files) {
      INFO(name << "\n" << content);
      const MeshFile file = parse_file(content, name);
      std::vector<Vec3> found;
      if (const auto* soup = std::get_if<PolygonSoup>(&file.geometry))
        found = soup->corners;
      else
        found = std::get<IndexedFaceSet>(file.geometry).points;
      REQUIRE(found.size() == points.exact.size());
      REQUIRE(std::memcmp(found.data(), points.exact.data(), found.size() * sizeof(Vec3)) == 0);
      if (const auto* mesh = std::get_if<IndexedFaceSet>(&file.geometry);
          mesh != nullptr && std::string(name) != "a.xyz") {
        REQUIRE(mesh->corners.size() == 3 * faces);
        for (std::uint32_t c = 0; c < mesh->corners.size(); ++c) REQUIRE(mesh->corners[c] == c);
      }
    }
  }
}

TEST_CASE("triangle strips of PLY are those unrolled one corner at a time", "[io][oracle]") {
  std::mt19937 random(6);
  for (int round = 0; round < 200; ++round) {
    constexpr int kPoints = 9;
    std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n";
    const std::size_t lists = 1 + random() % 3;
    ply +=
        "element tristrips " + std::to_string(lists) + "\nproperty list int int vertex_indices\nend_header\n";
    for (int p = 0; p < kPoints; ++p) ply += std::to_string(p) + " " + std::to_string(p * p) + " 0\n";
    std::vector<std::array<int, 3>> expected;
    for (std::size_t l = 0; l < lists; ++l) {
      std::vector<int> list;
      for (std::size_t i = random() % 14; i > 0; --i)
        list.push_back(random() % 5 == 0 ? -1 : static_cast<int>(random() % kPoints));
      ply += std::to_string(list.size());
      for (const int p : list) ply += " " + std::to_string(p);
      ply += "\n";
      // Every second triangle of a strip is turned; those that repeat a point turn, but are no faces.
      std::vector<int> strip;
      for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i] < 0) {
          strip.clear();
          continue;
        }
        strip.push_back(list[i]);
        const std::size_t n = strip.size();
        if (n < 3) continue;
        std::array<int, 3> t = {strip[n - 3], strip[n - 2], strip[n - 1]};
        if (n % 2 == 0) std::swap(t[0], t[1]);
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        expected.push_back(t);
      }
    }
    INFO(ply);
    if (expected.empty()) continue;
    const IndexedFaceSet mesh = parse(ply, "a.ply");
    std::vector<std::array<int, 3>> found;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.face(f);
      REQUIRE(face.size() == 3);
      std::array<int, 3> t = {static_cast<int>(face[0]), static_cast<int>(face[1]),
                              static_cast<int>(face[2])};
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      found.push_back(t);
    }
    REQUIRE(found == expected);
  }
}
