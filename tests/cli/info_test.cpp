// vkmesh info: counts that are known beforehand.
#include <catch2/catch.hpp>

#include "meshes.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh::test;
using nlohmann::json;

namespace {

json info_of(const std::string& content, const std::string& name = "in.off") {
  const Scratch scratch;
  const Outcome outcome = vkmesh_run({"info", scratch.file(name, content), "--json"});
  CAPTURE(outcome.err);
  REQUIRE(outcome.code == 0);
  return outcome.json();
}

struct Expected {
  std::string name;
  std::string off;
  int points, faces, edges, boundary_edges, components, loops, euler;
  json genus;
};

}  // namespace

TEST_CASE("info counts what is there") {
  // Euler: v - e + f = 2 - 2g for a closed component, 1 for a disc, 0 for a tube and a torus.
  const std::vector<Expected> cases = {
      {"tetrahedron", kTetrahedronOff, 4, 4, 6, 0, 1, 0, 2, 0},
      {"cube of quads", kCubeOff, 8, 6, 12, 0, 1, 0, 2, 0},
      {"icosphere", off_of(icosphere(2)), 162, 320, 480, 0, 1, 0, 2, 0},
      {"torus", off_of(torus(8, 6)), 48, 96, 144, 0, 1, 0, 0, 1},
      {"grid", off_of(grid(3, 2)), 12, 12, 23, 10, 1, 1, 1, 0},
      {"cylinder", off_of(cylinder(2, 6)), 18, 24, 42, 12, 1, 2, 0, 0},
      {"two triangles apart", "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 5\n1 0 5\n0 1 5\n3 0 1 2\n3 3 4 5\n", 6,
       2, 6, 6, 2, 2, 2, 0},
      {"Möbius strip", off_of(mobius(8)), 16, 16, 32, 16, 1, 1, 0, nullptr},
  };
  for (const Expected& expected : cases) {
    CAPTURE(expected.name);
    const json object = info_of(expected.off);
    CHECK(object.at("input").at("points") == expected.points);
    CHECK(object.at("input").at("faces") == expected.faces);
    CHECK(object.at("result").at("edges") == expected.edges);
    CHECK(object.at("result").at("boundary_edges") == expected.boundary_edges);
    CHECK(object.at("result").at("manifold") == true);
    CHECK(object.at("result").at("components") == expected.components);
    CHECK(object.at("result").at("boundary_loops") == expected.loops);
    CHECK(object.at("result").at("euler_characteristic") == expected.euler);
    CHECK(object.at("result").at("genus") == expected.genus);
  }
}

TEST_CASE("info measures") {
  const json cube = info_of(kCubeOff).at("result");
  CHECK(cube.at("area") == 6.0);
  CHECK(cube.at("bounds").at("min") == json({0.0, 0.0, 0.0}));
  CHECK(cube.at("bounds").at("max") == json({1.0, 1.0, 1.0}));
  CHECK(cube.at("triangles") == 0);
  CHECK(cube.at("largest_face") == 4);
}

TEST_CASE("info counts defects, and leaves isolated points out of the topology") {
  const json fin = info_of(kFinOff);
  CHECK(fin.at("result").at("non_manifold_edges") == 1);
  CHECK(fin.at("result").at("non_manifold_vertices") == 2);
  CHECK(fin.at("result").at("manifold") == false);
  CHECK(fin.at("result").at("genus").is_null());
  CHECK(info_of(off_of(bow_tie())).at("result").at("non_manifold_vertices") == 1);
  CHECK(info_of(off_of(mobius(8))).at("result").at("misoriented_edges") > 0);

  const json lonely =
      info_of("OFF\n5 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  CHECK(lonely.at("result").at("isolated_points") == 1);
  CHECK(lonely.at("result").at("components") == 1);
  CHECK(lonely.at("result").at("euler_characteristic") == 2);
  CHECK(lonely.at("result").at("genus") == 0);
}

TEST_CASE("info tells everything that programs ask, of the file as it was read") {
  // A cube of quads, a face twice, one of two points, a point that no face uses and one that is there twice.
  const json result =
      info_of(
          "OFF\n10 8 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n0 0 0\n9 9 9\n"
          "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n4 2 3 1 0\n3 0 1 0\n")
          .at("result");
  const json expected = {{"points", 10},
                         {"edges", 12},
                         {"faces", 8},
                         {"triangles", 1},
                         {"boundary_edges", 0},
                         {"boundary_loops", 0},
                         {"non_manifold_edges", 4},
                         {"non_manifold_vertices", 4},
                         {"components", 1},
                         {"euler_characteristic", 3},
                         {"genus", nullptr},
                         {"orientable", true},
                         {"oriented", true},
                         {"closed", true},
                         {"manifold", false},
                         {"degenerate_faces", 1},
                         {"duplicate_faces", 1},
                         {"duplicate_points", 1},
                         {"isolated_points", 2},
                         {"volume", nullptr}};
  for (const auto& [name, value] : expected.items()) {
    CAPTURE(name);
    CHECK(result.at(name) == value);
  }
  CHECK(info_of(kCubeOff).at("result").at("volume") == 1.0);
  CHECK(info_of(off_of(grid(2, 2))).at("result").at("volume").is_null());

  const json tori = info_of(off_of(tori_sharing_a_point())).at("result");
  CHECK(tori.at("components") == 2);
  CHECK(tori.at("genus").is_null());
  for (const json& one : tori.at("component_topology")) CHECK(one.at("genus") == 1);
}

TEST_CASE("info welds the corners of an STL") {
  const std::string stl =
      "solid two\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
      "0\nendloop\nendfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
      "two\n";
  const json object = info_of(stl, "in.stl");
  CHECK(object.at("input").at("format") == "stl");
  CHECK(object.at("input").at("points") == 4);
  CHECK(object.at("result").at("edges") == 5);
}

TEST_CASE("The JSON object has the documented parts") {
  const json object = info_of(kCubeOff);
  for (const char* part :
       {"command", "version", "device", "input", "output", "report", "timings_ms", "result", "notes"})
    CHECK(object.contains(part));
  CHECK(object.at("command") == "info");
  CHECK(object.at("version") == VKMESH_VERSION);
  for (const char* part : {"name", "driver", "type"}) CHECK(object.at("device").at(part).is_string());
  for (const char* part : {"read", "consolidate", "upload", "device", "compute", "write", "total"})
    CHECK(object.at("timings_ms").contains(part));
  CHECK(object.at("timings_ms").at("read").is_number());
  CHECK(object.at("timings_ms").at("device").is_null());
}

TEST_CASE("The dragon is counted as its makers count it") {
  const std::string path = std::string(VKMESH_DATA_DIR) + "/dragon/dragon_vrip.ply.gz";
  const json object = vkmesh_run({"info", path, "--json"}).json();
  CHECK(object.at("input").at("points") == 437645);
  CHECK(object.at("input").at("faces") == 871414);
  CHECK(object.at("input").at("gzip") == true);
}
