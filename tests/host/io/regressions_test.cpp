// The files of tests/regressions: each once broke something, or shows what a careless reader breaks on.
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/consolidate.h>

#include "io/io_support.h"

using namespace vkmesh;

namespace {

IndexedFaceSet read(const std::string& name) {
  auto file = read_mesh(std::filesystem::path(VKMESH_REGRESSIONS_DIR) / name);
  if (!file) FAIL(file.error().describe());
  auto mesh = to_indexed_face_set(*std::move(file));
  REQUIRE(mesh);
  return *std::move(mesh);
}

const Channel& channel_of(const std::vector<Channel>& channels, const std::string& name) {
  const Channel* channel = find_channel(channels, name);
  if (channel == nullptr) FAIL("there is no channel " << name);
  return *channel;
}

using Floats = std::vector<float>;
using Bytes = std::vector<std::uint8_t>;
using Corners = std::vector<std::uint32_t>;

/// The sentence with which a file must be refused, or part of it; none for files that are meshes.
const std::map<std::string, std::string> kRefusals = {
    {"obj-index-of-twenty-digits.obj", "expected"},
    {"obj-infinity-of-visual-c.obj", "vertex 3 has a coordinate that is not finite"},
    {"off-face-that-lacks-a-corner.off", "a face has fewer corners than its line promises"},
    {"off-more-faces-than-bytes.off", "promises"},
    {"ply-count-above-the-file.ply", "promises"},
    {"ply-faces-of-an-unknown-element.ply", "the only faces stand in element 'patch'"},
    {"ply-list-of-four-billion.ply", "the file ends within 'vertex_indices' of face 0"},
    {"ply-negative-list-count.ply", "negative count"},
    {"stl-count-above-the-file.stl", "promises 4000000000 facets"},
    {"vrml-inlines-itself.wrl", "neither polygons nor points (nodes ignored: 1 'Inline')"},
};

/// What a file must give.
struct ExpectedFile {
  std::size_t points, faces;
  std::vector<std::string> codes;  ///< Those of its notes.
};
const std::map<std::string, ExpectedFile> kMeshes = {
    {"gltf-data-without-a-type.gltf", {3, 1, {}}},
    {"gltf-indices-without-a-view.gltf", {3, 1, {}}},
    {"gltf-instances.gltf", {6, 2, {}}},
    {"gltf-skin-on-a-moved-node.gltf", {3, 1, {"dropped.skin"}}},
    {"iv-connection-of-a-field.iv", {8, 6, {"dropped.connection", "dropped.node"}}},
    {"obj-byte-order-mark.obj", {3, 1, {}}},
    {"obj-face-of-one-corner.obj", {3, 1, {"dropped.unused_uv", "skipped.small_faces"}}},
    {"obj-far-from-the-origin.obj", {3, 1, {"rounded.positions"}}},
    {"obj-keywords-of-an-archive.obj", {3, 1, {"skipped.keyword", "skipped.keyword"}}},
    {"obj-names-with-hash.obj", {3, 2, {}}},
    {"obj-normal-not-finite.obj", {3, 1, {"nonfinite.normal"}}},
    {"obj-normals-that-are-missing.obj", {3, 1, {"skipped.normal_index"}}},
    {"obj-uv-index-before-the-first.obj", {3, 1, {"skipped.uv_index", "partial.uv"}}},
    {"obj-uv-index-of-zero.obj", {3, 1, {"skipped.uv_index", "partial.uv"}}},
    {"obj-uv-of-one-object.obj", {3, 2, {"partial.uv"}}},
    {"off-byte-order-mark.off", {3, 1, {}}},
    {"off-face-of-two-corners.off", {3, 1, {"skipped.small_faces"}}},
    {"off-face-over-three-lines.off", {4, 2, {}}},
    {"off-in-binary.off", {3, 1, {"skipped.small_faces"}}},
    {"off-keyword-glued-to-the-count.off", {4, 1, {}}},
    {"ply-byte-order-mark.ply", {3, 1, {}}},
    {"ply-colours-of-16-bits.ply", {3, 1, {}}},
    {"ply-colours-of-floats-to-255.ply", {3, 1, {}}},
    {"ply-doubles-far-from-the-origin.ply", {3, 1, {"rounded.positions"}}},
    {"ply-face-of-two-corners.ply", {3, 1, {"skipped.small_faces"}}},
    {"ply-header-that-ends-with-cr-lf.ply", {3, 1, {}}},
    {"ply-integers-with-a-point.ply", {3, 1, {}}},
    {"ply-point-not-finite-without-face.ply", {3, 1, {"dropped.nonfinite_points"}}},
    {"ply-triangle-strips.ply", {5, 3, {}}},
    {"ply-trillion-elements-of-nothing.ply", {1, 0, {"dropped.element"}}},
    {"ply-uv-of-corners.ply", {4, 2, {"partial.uv"}}},
    {"stl-attribute-bytes-behind-facets.stl", {3, 2, {"dropped.attribute_bytes"}}},
    {"stl-bytes-behind-the-last-facet.stl", {3, 1, {"dropped.trailing_bytes"}}},
    {"stl-count-of-zero.stl", {3, 2, {"repaired.count"}}},
    {"stl-ends-in-two-words.stl", {3, 1, {}}},
    {"stl-facet-of-two-corners.stl", {3, 1, {"skipped.small_faces"}}},
    {"stl-name-glued-to-endsolid.stl", {3, 1, {}}},
    {"stl-normal-not-finite.stl", {3, 1, {"nonfinite.normal"}}},
    {"stl-two-solids-on-one-line.stl", {3, 2, {"dropped.solids"}}},
    {"stl-without-endsolid.stl", {3, 1, {"repaired.endsolid"}}},
    {"vrml-elevation-grid.wrl", {9, 4, {}}},
    {"vrml-extrusion.wrl", {12, 10, {}}},
    {"vrml-inline.wrl", {3, 1, {"dropped.inline", "dropped.inline", "dropped.inline", "dropped.node"}}},
    {"vrml-inlined.wrl", {3, 1, {}}},
    {"vrml-name-within-an-ignored-node.wrl", {3, 1, {"dropped.node"}}},
    {"vrml-prototypes.wrl", {32, 24, {"repaired.prototype"}}},
    {"vrml-shapes-by-measures.wrl",
     {8 + (32 * 15 + 2) + 33 + 64, 6 + 32 * 16 + 33 + 33, {"rounded.primitives"}}},
    {"xyz-points-with-colours.xyz", {3, 0, {}}},
};

std::vector<std::filesystem::path> regression_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(VKMESH_REGRESSIONS_DIR))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

TEST_CASE("files that broke something are read or refused", "[io][regressions]") {
  std::size_t known = 0;
  for (const std::filesystem::path& path : regression_files()) {
    INFO(path.filename());
    const std::string name = path.filename().string();
    const auto file = read_mesh(path);
    const auto refusal = kRefusals.find(name);
    if (refusal != kRefusals.end()) {
      ++known;
      REQUIRE_FALSE(file);
      CHECK(file.error().code == ErrorCode::kUnreadable);
      CHECK_THAT(file.error().message, Catch::Contains(refusal->second));
      continue;
    }
    const auto expected = kMeshes.find(name);
    if (expected == kMeshes.end()) FAIL(name << " is in no table");
    ++known;
    if (!file) FAIL(file.error().describe());
    const auto mesh = to_indexed_face_set(*file);
    REQUIRE(mesh);
    CHECK(mesh->points.size() == expected->second.points);
    CHECK(mesh->face_count() == expected->second.faces);
    CHECK(test::codes(file->notes) == expected->second.codes);
    CHECK(diagnose(*mesh));
  }
  CHECK(known == kRefusals.size() + kMeshes.size());
}

TEST_CASE("what files deviate in leaves the rest as it is", "[io][regressions]") {
  const IndexedFaceSet names = read("obj-names-with-hash.obj");
  CHECK(channel_of(names.face_channels, "material").labels ==
        std::vector<std::string>{"Steel #7", "#00ff00"});
  CHECK(channel_of(names.face_channels, "group").labels == std::vector<std::string>{"wheel #2"});

  CHECK(channel_of(read("obj-uv-of-one-object.obj").corner_channels, "uv").values ==
        ChannelValues(Floats{0, 0, 0, 0, 0, 0, 0.25f, 0.75f, 0.25f, 0.75f, 0.25f, 0.75f}));
  CHECK(channel_of(read("obj-uv-index-of-zero.obj").corner_channels, "uv").values ==
        ChannelValues(Floats{0, 0, 0.5f, 0.5f, 0.5f, 0.5f}));
  CHECK(read("obj-normals-that-are-missing.obj").corner_channels.empty());

  CHECK(channel_of(read("ply-integers-with-a-point.ply").point_channels, "color").values ==
        ChannelValues(Bytes{9, 8, 7, 6, 5, 4, 3, 2, 1}));
  CHECK(read("ply-integers-with-a-point.ply").corners == Corners{2, 1, 0});
  for (const char* name : {"ply-colours-of-16-bits.ply", "ply-colours-of-floats-to-255.ply"}) {
    const Channel color = channel_of(read(name).point_channels, "color");
    REQUIRE(std::holds_alternative<Floats>(color.values));
    CHECK(std::get<Floats>(color.values)[0] == 1.0f);
    CHECK(std::get<Floats>(color.values)[2] == 0.2f);
  }
  const IndexedFaceSet binary = read("off-in-binary.off");
  CHECK(binary.corners == Corners{2, 1, 0});
  CHECK(channel_of(binary.point_channels, "normal").values ==
        ChannelValues(Floats{0, 0, 1, 0, 0, 1, 0, 0, 1}));
  CHECK(channel_of(binary.point_channels, "color").components == 4);
  CHECK(channel_of(binary.face_channels, "color").values == ChannelValues(Floats{0, 0.25f, 1}));
  const IndexedFaceSet two = read("ply-face-of-two-corners.ply");
  CHECK(channel_of(two.face_channels, "tag").values == ChannelValues(Bytes{8}));
  const IndexedFaceSet without = read("ply-point-not-finite-without-face.ply");
  CHECK(without.corners == Corners{2, 1, 0});
  CHECK(channel_of(without.point_channels, "id").values == ChannelValues(std::vector<std::int16_t>{2, 3, 5}));
  CHECK(read("ply-triangle-strips.ply").corners == Corners{0, 1, 2, 2, 1, 3, 3, 1, 4});
  CHECK(channel_of(read("ply-uv-of-corners.ply").corner_channels, "uv").values ==
        ChannelValues(Floats{0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0}));
  CHECK(read("off-face-over-three-lines.off").corners == Corners{3, 2, 1, 0, 0, 1, 2});

  CHECK(read("gltf-instances.gltf").points ==
        std::vector<Vec3>{{1, 0, 0}, {3, 0, 0}, {1, 2, 1}, {1, 0, 10}, {3, 0, 10}, {1, 2, 11}});
  // The joints take back what their inverse bind matrices move; the last point goes half of the second's way.
  CHECK(read("gltf-skin-on-a-moved-node.gltf").points == std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {0, 2, 5}});
  CHECK(read("gltf-indices-without-a-view.gltf").corners == Corners{0, 0, 0});
  CHECK(read("vrml-inline.wrl").points == std::vector<Vec3>{{0, 0, 3}, {2, 0, 3}, {0, 2, 4}});
  CHECK(channel_of(read("vrml-inline.wrl").point_channels, "color").components == 3);
}

TEST_CASE("shapes given by measures are closed, oriented and as large as they say", "[io][regressions]") {
  const auto volume = [](const IndexedFaceSet& mesh) {
    double six = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.face(f);
      const DVec3 a(mesh.points[face[0]]);
      for (std::size_t k = 1; k + 1 < face.size(); ++k) {
        const DVec3 b(mesh.points[face[k]]), c(mesh.points[face[k + 1]]);
        six += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
      }
    }
    return six / 6;
  };
  const auto shape = [&](const std::string& text) {
    const IndexedFaceSet mesh = test::parse("#VRML V2.0 utf8\nShape { geometry " + text + " }", "a.wrl");
    const auto topology = surface_topology(mesh);
    REQUIRE(topology);
    CHECK(topology->whole.closed());
    CHECK(topology->whole.oriented());
    CHECK(topology->whole.euler_characteristic() == 2);
    return volume(mesh);
  };
  CHECK(shape("Box { size 1 2 3 }") == Approx(6));
  CHECK(shape("Sphere { radius 2 }") == Approx(4.0 / 3 * 3.14159265 * 8).epsilon(0.02));
  CHECK(shape("Cylinder { radius 2 height 3 }") == Approx(3.14159265 * 12).epsilon(0.01));
  CHECK(shape("Cone { bottomRadius 2 height 3 }") == Approx(3.14159265 * 4).epsilon(0.01));
  CHECK(shape("Extrusion { }") == Approx(4));
  // Straight along another axis, and around a bend.
  CHECK(shape("Extrusion { spine [ 0 0 0, 3 0 0 ] }") == Approx(12));
  CHECK(shape("Extrusion { spine [ 0 0 0, 0 -3 0 ] }") == Approx(12));
  CHECK(shape("Extrusion { crossSection [ 0.1 0.1, 0.1 -0.1, -0.1 -0.1, -0.1 0.1, 0.1 0.1 ] "
              "spine [ 0 0 0, 0 2 0, 2 2 0, 4 2 0 ] }") == Approx(0.04 * 6).epsilon(0.1));
  const IndexedFaceSet ring = test::parse(
      "#VRML V2.0 utf8\nShape { geometry Extrusion { crossSection [ 0.1 0.1, 0.1 -0.1, -0.1 -0.1, -0.1 0.1, "
      "0.1 0.1 ] spine [ 1 0 0, 0 0 1, -1 0 0, 0 0 -1, 1 0 0 ] } }",
      "a.wrl");
  const auto torus = surface_topology(ring);
  REQUIRE(torus);
  CHECK(torus->whole.closed());
  CHECK(torus->whole.genus == 1u);
  for (const char* iv : {"Cube { }", "Sphere { }", "Cone { }", "Cylinder { }"}) {
    const auto topology = surface_topology(test::parse(std::string("#Inventor V2.1 ascii\n") + iv, "a.iv"));
    REQUIRE(topology);
    CHECK(topology->whole.closed());
  }
}
