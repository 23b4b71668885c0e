// vkmesh lod, on small meshes.
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/io/mesh_io.h>
#include <vkmesh/lod/lod_chain.h>

#include "meshes.h"
#include "output.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

TEST_CASE("lod writes a file for each level, whose points are the first of those before") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(3)));
  const auto object = vkmesh_run({"lod", in, scratch.path("out.ply"), "--levels", "4", "--operation",
                                  "half-edge-collapse", "--measure", "--json"})
                          .json();
  CHECK(object.at("command") == "lod");
  CHECK(scratch.names() ==
        std::vector<std::string>{"in.off", "out_lod0.ply", "out_lod1.ply", "out_lod2.ply", "out_lod3.ply"});
  CHECK(object.at("output").at("files").size() == 4);
  const auto levels = object.at("result").at("levels");
  REQUIRE(levels.size() == 4);
  std::vector<IndexedFaceSet> files;
  for (std::size_t k = 0; k < 4; ++k) {
    files.push_back(mesh_in(scratch.path("out_lod" + std::to_string(k) + ".ply")));
    CHECK(levels[k].at("faces") == files.back().face_count());
    CHECK(levels[k].at("points") == files.back().points.size());
    CHECK(levels[k].at("boundary_loops") == 0);
    if (k == 0) continue;
    CHECK(files[k].face_count() == std::size_t{1280} >> k);
    CHECK(std::equal(files[k].points.begin(), files[k].points.end(), files[k - 1].points.begin()));
    CHECK(levels[k].at("error") >= levels[k - 1].at("error"));
    CHECK(levels[k].at("measured").at("mean").get<double>() > 0);
    CHECK(levels[k].at("screen_coverage") <= levels[k - 1].at("screen_coverage"));
  }
  const Outcome table = vkmesh_run({"lod", in, scratch.path("two.obj"), "--ratios", "0.5,0.1"});
  CHECK(table.code == 0);
  CHECK_THAT(table.out, Contains("level 0") && Contains("level 2") && Contains("128 triangles"));
}

TEST_CASE("lod writes one glTF file, of nodes or by MSFT_lod") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(torus(24, 12)));
  for (const std::string layout : {"nodes", "msft"}) {
    const std::string out = scratch.path("torus.glb");
    REQUIRE(vkmesh_run({"lod", in, out, "--relative-errors", "5e-3,3e-2", "--layout", layout}).code == 0);
    const MeshFile file = read_mesh(out).value();
    CHECK(file.levels == 3);
    CHECK(to_indexed_face_set(file).value().face_count() == 576);
    CHECK_THAT(content_of(out), Contains("torus_LOD2"));
  }
}

TEST_CASE("lod refuses what does not fit, and leaves nothing behind") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(1))), out = scratch.path("out.ply");
  const auto refused = [&](std::vector<std::string> more, int code, const std::string& why) {
    more.insert(more.begin(), {"lod", in});
    const Outcome outcome = vkmesh_run(more);
    CHECK(outcome.code == code);
    CHECK_THAT(outcome.err, Contains(why));
    CHECK(scratch.names() == std::vector<std::string>{"in.off"});
  };
  refused({out}, 2, "say which levels");
  refused({out, "--levels", "3", "--ratios", "0.5"}, 2, "one way");
  refused({out, "--ratios", "0.2,0.5"}, 2, "must fall");
  refused({out, "--levels", "3", "--layout", "msft"}, 2, "--layout msft");
  refused({out, "--levels", "3", "--vertices", "shared"}, 2, "--vertices shared");
  refused({"-", "--levels", "3"}, 2, "need a name");
  refused({scratch.path("no/out.ply"), "--levels", "3"}, 7, "does not exist");
  refused({out, "--levels", "3", "--attribute", "none"}, 2, "--attribute none");
  if (!has_vertex_cache_order()) refused({out, "--levels", "3", "--vertex-cache"}, 2, "meshoptimizer");
  // As deep as it goes: the last row says why.
  const Outcome end = vkmesh_run({"lod", in, out, "--levels", "20"});
  CHECK(end.code == 0);
  CHECK_THAT(end.out, Contains("stopped") && Contains("no legal collapse"));
}
