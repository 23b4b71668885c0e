// Levels of detail in files: one glTF file of several meshes, and one file each.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/io_support.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

/// Three levels of a grid over the same points, the coarser over the first of them: a strip, a longer one,
/// and all.
std::vector<IndexedFaceSet> shared_levels(bool corner_uv) {
  std::vector<IndexedFaceSet> levels;
  const IndexedFaceSet all = grid(8, 8);
  for (const std::size_t rows : {std::size_t{8}, std::size_t{4}, std::size_t{1}}) {
    IndexedFaceSet level;
    for (std::size_t f = 0; f < all.face_count(); ++f)
      if (std::ranges::all_of(all.face(f), [&](std::uint32_t v) { return v < 9 * (rows + 1); }))
        level.corners.insert(level.corners.end(), all.face(f).begin(), all.face(f).end());
    level.points.assign(all.points.begin(), all.points.begin() + static_cast<std::ptrdiff_t>(9 * (rows + 1)));
    if (corner_uv) {
      // A seam along x = 4.
      std::vector<float> uv;
      for (std::size_t f = 0; f < level.face_count(); ++f) {
        float middle = 0;
        for (const std::uint32_t v : level.face(f)) middle += level.points[v].x;
        for (const std::uint32_t v : level.face(f)) {
          uv.push_back(level.points[v].x / 8 + (middle > 12 ? 1.0f : 0.0f));
          uv.push_back(level.points[v].y / 8);
        }
      }
      level.corner_channels.push_back({"uv", 2, std::move(uv), {}});
    }
    level.face_channels.push_back(
        {"material", 1, std::vector<std::uint32_t>(level.face_count(), 0), {"stone"}});
    levels.push_back(std::move(level));
  }
  return levels;
}

WriteOptions gltf_text() {
  WriteOptions options;
  options.format = FileFormat::kGltf;
  options.encoding = FileEncoding::kAscii;
  return options;
}

std::string bytes_in(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

IndexedFaceSet read_level(const std::string& path, std::size_t level) {
  ReadOptions options;
  options.level = level;
  return to_indexed_face_set(read_mesh(path, options).value()).value();
}

}  // namespace

TEST_CASE("A glTF file of levels is read level by level", "[io][lod]") {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "vkmesh_levels_test";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "levels.gltf").string();
  for (const LevelLayout layout : {LevelLayout::kNodes, LevelLayout::kMsftLod})
    for (const bool corner_uv : {false, true}) {
      const std::vector<IndexedFaceSet> levels = shared_levels(corner_uv);
      LevelWriteOptions options;
      options.layout = layout;
      options.name = "grid";
      options.shared_points = true;
      options.screen_coverage = {0.5, 0.1, 0};
      REQUIRE(write_levels(path, levels, options, gltf_text()));
      const auto json = nlohmann::json::parse(bytes_in(path));
      // One view of positions for all, and an accessor over it for each.
      std::vector<nlohmann::json> positions;
      for (const auto& mesh : json.at("meshes"))
        positions.push_back(
            json.at("accessors")
                .at(mesh.at("primitives").at(0).at("attributes").at("POSITION").get<std::size_t>()));
      REQUIRE(positions.size() == 3);
      for (std::size_t k = 0; k < 3; ++k) {
        CHECK(positions[k].at("bufferView") == positions[0].at("bufferView"));
        CHECK(positions[k].value("byteOffset", 0) == 0);
      }
      CHECK(positions[0].at("count") == (corner_uv ? 90 : 81));
      CHECK(positions[2].at("count") == (corner_uv ? 20 : 18));
      CHECK(positions[2].at("max").at(1) == 1);
      CHECK(positions[0].at("max").at(1) == 8);
      CHECK(json.at("materials").size() == 1);
      const auto& nodes = json.at("nodes");
      if (layout == LevelLayout::kNodes) {
        CHECK(nodes.size() == 4);
        CHECK(nodes.at(0).at("name") == "grid");
        CHECK(nodes.at(0).at("children") == nlohmann::json::array({1, 2, 3}));
        for (std::size_t k = 0; k < 3; ++k)
          CHECK(nodes.at(k + 1).at("name") == "grid_LOD" + std::to_string(k));
        CHECK(!json.contains("extensionsUsed"));
      } else {
        CHECK(nodes.size() == 3);
        CHECK(nodes.at(0).at("extensions").at("MSFT_lod").at("ids") == nlohmann::json::array({1, 2}));
        CHECK(nodes.at(0).at("extras").at("MSFT_screencoverage") == nlohmann::json::array({0.5, 0.1, 0.0}));
        CHECK(json.at("scenes").at(0).at("nodes") == nlohmann::json::array({0}));
        CHECK(json.at("extensionsUsed") == nlohmann::json::array({"MSFT_lod"}));
      }
      const MeshFile finest = read_mesh(path).value();
      CHECK(finest.levels == 3);
      CHECK(std::ranges::count(finest.notes, std::string("dropped.levels"), &FileNote::code) == 1);
      for (std::size_t k = 0; k < 4; ++k) {
        const IndexedFaceSet back = read_level(path, k);
        const IndexedFaceSet& meant = levels[std::min<std::size_t>(k, 2)];
        CHECK(back.face_count() == meant.face_count());
        if (!corner_uv) CHECK(back.corners == meant.corners);
        if (!corner_uv) CHECK(back.points == meant.points);
      }
    }
  std::filesystem::remove_all(folder);
}

TEST_CASE("Levels without common points have vertices of their own", "[io][lod]") {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "vkmesh_own_levels_test";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "levels.glb").string();
  std::vector<IndexedFaceSet> levels = {icosphere(2), icosphere(1, 2.0f)};
  levels[0].point_channels.push_back({"quality", 1, std::vector<float>(levels[0].points.size(), 2.0f), {}});
  WriteOptions options = gltf_text();
  options.encoding = FileEncoding::kBinaryLittleEndian;
  options.offset = DVec3(1000, 0, 0);
  LevelWriteOptions level_options;
  level_options.shared_points = true;  // which is not so
  REQUIRE(write_levels(path, levels, level_options, options));
  for (std::size_t k = 0; k < 2; ++k) {
    const IndexedFaceSet back = read_level(path, k);
    CHECK(back.corners == levels[k].corners);
    CHECK(back.points[0].x == Approx(levels[k].points[0].x + 1000));
  }
  CHECK(!write_levels(path, {}, level_options, options));
  level_options.screen_coverage = {1};
  CHECK(write_levels(path, levels, level_options, options).error().code == ErrorCode::kUsage);
  options.format = FileFormat::kPly;
  level_options.screen_coverage = {};
  CHECK(write_levels(path, levels, level_options, options).error().code == ErrorCode::kUsage);

  // One file each: all or none.
  const std::vector<std::filesystem::path> paths = {folder / "a.ply", folder / "b.ply"};
  levels[1].corners[0] = 100000;
  CHECK(!write_meshes(paths, levels, options));
  CHECK(!std::filesystem::exists(paths[0]));
  levels[1].corners[0] = 0;
  levels[1] = icosphere(1);
  REQUIRE(write_meshes(paths, levels, options));
  CHECK(to_indexed_face_set(read_mesh(paths[1]).value()).value().face_count() == 80);
  std::filesystem::remove_all(folder);
}

TEST_CASE("MSFT_lod that names no node is refused, and one name alone is no level", "[io][lod]") {
  const std::string head = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":)"
                           R"("data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
                           R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
                           R"("componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":)"
                           R"([{"attributes":{"POSITION":0}}]}],"scenes":[{"nodes":[0]}],"nodes":)";
  const auto at_level_1 = [&](const std::string& nodes) {
    ReadOptions options;
    options.level = 1;
    return parse_mesh(as_bytes(head + nodes + "}"), "a.gltf", options);
  };
  CHECK(at_level_1(R"([{"mesh":0,"name":"tree_LOD0"}])"));
  for (const char* ids : {"[7]", "[-1]", "[\"a\"]", "7", "[0]", "[]"})
    if (const auto read =
            at_level_1(std::string(R"([{"mesh":0,"extensions":{"MSFT_lod":{"ids":)") + ids + "}}}]");
        !read)
      CHECK(read.error().code == ErrorCode::kUnreadable);
  CHECK(!at_level_1(R"([{"mesh":0,"extensions":{"MSFT_lod":{"ids":[7]}}}])"));
}
