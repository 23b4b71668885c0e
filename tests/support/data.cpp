#include "support/data.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>

#include <catch2/catch.hpp>

namespace vkmesh::test {
namespace {

const std::filesystem::path kData = VKMESH_DATA_DIR;

void require_exists(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) FAIL(path.string() + " is missing: run tools/fetch_data.sh");
}

}  // namespace

std::filesystem::path dragon(const char* name) {
  const std::filesystem::path path = kData / "dragon" / name;
  require_exists(path);
  return path;
}

std::vector<std::filesystem::path> cgal_meshes() {
  const std::filesystem::path root = kData / "cgal";
  require_exists(root);
  static const std::set<std::string> kExtensions = {".off", ".obj", ".ply", ".stl"};
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
    if (entry.is_regular_file() && kExtensions.contains(entry.path().extension().string()))
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::filesystem::path> cgal_meshes_for_long_work() {
  std::vector<std::filesystem::path> meshes = cgal_meshes();
  if (!kSanitized) return meshes;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < meshes.size(); i += 8) meshes[kept++] = meshes[i];
  meshes.resize(kept);
  return meshes;
}

}  // namespace vkmesh::test
