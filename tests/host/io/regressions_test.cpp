// The files of tests/regressions: each once broke something, or shows what a careless reader breaks on.
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/consolidate.h>

using namespace vkmesh;

namespace {

/// The sentence with which a file must be refused, or part of it; none for files that are meshes.
const std::map<std::string, std::string> kRefusals = {
    {"obj-index-of-twenty-digits.obj", "expected"},
    {"off-more-faces-than-bytes.off", "promises"},
    {"ply-count-above-the-file.ply", "promises"},
    {"ply-list-of-four-billion.ply", "the file ends within 'vertex_indices' of face 0"},
    {"ply-negative-list-count.ply", "negative count"},
    {"stl-count-above-the-file.stl", "promises 4000000000 facets"},
};
const std::vector<std::string> kMeshes = {"ply-trillion-elements-of-nothing.ply"};

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
    if (std::find(kMeshes.begin(), kMeshes.end(), name) != kMeshes.end()) {
      ++known;
      REQUIRE(file);
    }
    if (!file) {
      CHECK_FALSE(file.error().message.empty());
      continue;
    }
    const auto mesh = to_indexed_face_set(*file);
    REQUIRE(mesh);
    CHECK(survey(*mesh));
  }
  CHECK(known == kRefusals.size() + kMeshes.size());
}
