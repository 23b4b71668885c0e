// Files that repeat points along seams of texture coordinates, normals and materials.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/consolidate.h>
#include <vkmesh/repair/weld.h>

#include "output.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh;
using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kRings = 48, kSides = 32;

/// Writes a torus with texture coordinates that jump along two circles, where its points are repeated.
std::string torus_file(const Scratch& scratch, const std::string& name) {
  IndexedFaceSet mesh = torus(kRings, kSides);
  std::vector<float> uv, normals;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::size_t ring = f / 2 / kSides, side = f / 2 % kSides;
    for (const std::uint32_t c : mesh.face(f)) {
      const std::size_t i = c / kSides, j = c % kSides;
      const std::size_t u = ring + 1 == kRings && i == 0 ? kRings : i;
      const std::size_t v = side + 1 == kSides && j == 0 ? kSides : j;
      uv.insert(uv.end(), {static_cast<float>(u) / kRings, static_cast<float>(v) / kSides});
    }
  }
  mesh.corner_channels = {{"uv", 2, uv}};
  const std::vector<std::string> names = {"uv"};
  const IndexedFaceSet split = split_at_seams(mesh, names).value();
  REQUIRE(split.points.size() == (kRings + 1) * (kSides + 1));
  const std::string path = scratch.path(name);
  REQUIRE(write_mesh(path, split, write_options_for(path).value()));
  return path;
}

/// Edges without a partner once points at equal places are one.
std::size_t open_edges(const IndexedFaceSet& mesh) {
  return diagnose(weld(mesh).value().mesh).value().boundary_edges;
}

using Place = std::tuple<float, float, float>;

Place place_of(const Vec3& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

TEST_CASE("simplify closes what is closed but for seams, and repeats points again where attributes differ") {
  const std::string file = GENERATE("torus.glb", "torus.ply");
  const std::string operation = GENERATE("edge-collapse", "half-edge-collapse", "vertex-removal");
  CAPTURE(file, operation);
  const Scratch scratch;
  const std::string in = torus_file(scratch, file), out = scratch.path("out-" + file);
  const auto object =
      vkmesh_run({"simplify", in, out, "--ratio", "0.3", "--operation", operation, "--json"}).json();
  CHECK(object.at("report").at("welded_points") == kRings + kSides + 1);
  const IndexedFaceSet mesh = mesh_in(out);
  CHECK(mesh.face_count() <= 922);
  CHECK(mesh.corner_channels.empty());
  REQUIRE(find_channel(mesh.point_channels, "uv") != nullptr);
  CHECK(open_edges(mesh) == 0);
  // The seams are there: points that are repeated, with coordinates that differ by the whole picture.
  const IndexedFaceSet welded = weld(mesh).value().mesh;
  CHECK(welded.points.size() < mesh.points.size());
  CHECK(find_channel(welded.corner_channels, "uv") != nullptr);

  // The old way: seams are boundaries, which move apart.
  vkmesh_run({"simplify", in, out, "--ratio", "0.3", "--operation", operation, "--keep-splits"});
  CHECK(diagnose(mesh_in(out)).value().boundary_edges > 0);
}

TEST_CASE("simplify --index-only keeps the vertices of the file, and closes what is closed but for seams") {
  const std::string operation = GENERATE("half-edge-collapse", "vertex-removal");
  const bool counts = GENERATE(true, false);  // texture coordinates, in the error
  CAPTURE(operation, counts);
  const Scratch scratch;
  const std::string in = torus_file(scratch, "torus.glb"), out = scratch.path("out.glb");
  std::vector<std::string> arguments = {"simplify",    in,        out,           "--ratio", "0.3",
                                        "--operation", operation, "--index-only"};
  if (!counts) arguments.insert(arguments.end(), {"--attribute", "uv=0"});
  vkmesh_run(arguments);
  const IndexedFaceSet before = mesh_in(in), after = mesh_in(out);
  CHECK(after.face_count() <= 922);
  CHECK(after.points == before.points);
  CHECK(floats_of(after, "uv") == floats_of(before, "uv"));
  CHECK(open_edges(after) == 0);
  // No triangle reaches across a seam: texture coordinates of its corners are near each other.
  const std::vector<float> uv = floats_of(after, "uv");
  for (std::size_t f = 0; f < after.face_count(); ++f)
    for (const unsigned k : {0u, 1u}) {
      float low = 1, high = 0;
      for (const std::uint32_t c : after.face(f)) {
        low = std::min(low, uv[2 * c + k]);
        high = std::max(high, uv[2 * c + k]);
      }
      REQUIRE(high - low < 0.7f);
    }
}

TEST_CASE("OBJ needs no points repeated: the seam is one of its texture coordinates") {
  const Scratch scratch;
  const std::string in = torus_file(scratch, "torus.glb"), out = scratch.path("out.obj");
  vkmesh_run({"simplify", in, out, "--ratio", "0.3"});
  const IndexedFaceSet mesh = mesh_in(out);
  CHECK(diagnose(mesh).value().boundary_edges == 0);
  CHECK(find_channel(mesh.corner_channels, "uv") != nullptr);
}

TEST_CASE("smooth and normals give all copies of a point the same") {
  const Scratch scratch;
  const std::string in = torus_file(scratch, "torus.glb"), out = scratch.path("out.glb");
  vkmesh_run({"smooth", in, out, "--iterations", "5"});
  const IndexedFaceSet smooth = mesh_in(out);
  CHECK(smooth.points.size() == (kRings + 1) * (kSides + 1));
  CHECK(open_edges(smooth) == 0);

  vkmesh_run({"normals", in, out});
  const IndexedFaceSet shaded = mesh_in(out);
  REQUIRE(find_channel(shaded.point_channels, "normal") != nullptr);
  const auto& normals = std::get<std::vector<float>>(find_channel(shaded.point_channels, "normal")->values);
  std::map<Place, Place> normal_at;
  for (std::size_t p = 0; p < shaded.points.size(); ++p) {
    const Place normal = {normals[3 * p], normals[3 * p + 1], normals[3 * p + 2]};
    REQUIRE(normal_at.try_emplace(place_of(shaded.points[p]), normal).first->second == normal);
  }
  CHECK(normal_at.size() == kRings * kSides);

  vkmesh_run({"smooth", in, out, "--iterations", "5", "--keep-splits"});
  CHECK(open_edges(mesh_in(out)) == 0);  // the boundary stays where it was
  const Outcome both = vkmesh_run({"smooth", in, out, "--keep-splits", "--weld", "0"});
  CHECK(both.code == 2);
  CHECK_THAT(both.err, Contains("--keep-splits"));
}

TEST_CASE("triangles without shared points are simplified as the surface they make") {
  const Scratch scratch;
  std::string text;
  const IndexedFaceSet ball = icosphere(3);
  for (const std::uint32_t c : ball.corners)
    text += "v " + std::to_string(ball.points[c].x) + " " + std::to_string(ball.points[c].y) + " " +
            std::to_string(ball.points[c].z) + "\n";
  for (std::size_t c = 0; c < ball.corners.size(); c += 3)
    text += "f " + std::to_string(c + 1) + " " + std::to_string(c + 2) + " " + std::to_string(c + 3) + "\n";
  const std::string in = scratch.file("soup.obj", text), out = scratch.path("out.ply");
  vkmesh_run({"simplify", in, out, "--ratio", "0.1"});
  const IndexedFaceSet mesh = mesh_in(out);
  CHECK(mesh.face_count() == 128);
  CHECK(diagnose(mesh).value().boundary_edges == 0);
}
