// What the tests of reading and writing share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <stdlib.h>

#include <vkmesh/io/mesh_io.h>

#include "support/shapes.h"

namespace vkmesh::test {

inline std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

inline std::string as_text(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline MeshFile parse_file(std::string_view content, const std::string& name) {
  auto file = parse_mesh(as_bytes(content), name);
  if (!file) FAIL(file.error().describe());
  return *std::move(file);
}

inline IndexedFaceSet parse(std::string_view content, const std::string& name) {
  auto mesh = to_indexed_face_set(parse_file(content, name));
  if (!mesh) FAIL(mesh.error().describe());
  return *std::move(mesh);
}

/// The error that the content must give.
inline Error parse_error(std::string_view content, const std::string& name) {
  auto file = parse_mesh(as_bytes(content), name);
  if (file) FAIL(name << " was accepted");
  return file.error();
}

/// What notes say.
inline std::vector<std::string> sentences(const std::vector<FileNote>& notes) {
  std::vector<std::string> found;
  for (const FileNote& note : notes) found.push_back(note.sentence);
  return found;
}

/// Their codes.
inline std::vector<std::string> codes(const std::vector<FileNote>& notes) {
  std::vector<std::string> found;
  for (const FileNote& note : notes) found.push_back(note.code);
  return found;
}

inline std::string encode(const IndexedFaceSet& mesh, const WriteOptions& options) {
  auto bytes = encode_mesh(mesh, options);
  if (!bytes) FAIL(bytes.error().describe());
  return as_text(*bytes);
}

inline WriteOptions write_as(FileFormat format, FileEncoding encoding, bool gzip = false) {
  WriteOptions options;
  options.format = format;
  options.encoding = encoding;
  options.gzip = gzip;
  return options;
}

inline void require_same_channels(const std::vector<Channel>& a, const std::vector<Channel>& b) {
  REQUIRE(a.size() == b.size());
  for (const Channel& channel : a) {
    const Channel* other = find_channel(b, channel.name);
    INFO("channel " << channel.name);
    REQUIRE(other != nullptr);
    CHECK(channel.components == other->components);
    CHECK(channel.values == other->values);
  }
}

/// Every array alike, in every bit where it is a position.
inline void require_same(const IndexedFaceSet& a, const IndexedFaceSet& b) {
  REQUIRE(a.points.size() == b.points.size());
  CHECK((a.points.empty() ||
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0));
  CHECK(a.corners == b.corners);
  CHECK(a.face_offsets == b.face_offsets);
  require_same_channels(a.point_channels, b.point_channels);
  require_same_channels(a.corner_channels, b.corner_channels);
  require_same_channels(a.face_channels, b.face_channels);
}

/// A triangle, a quad and a pentagon over seven points, one of them isolated.
inline IndexedFaceSet mixed_polygons() {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0},        {1, 0.1f, 0}, {1, 1, -1e-20f}, {-0.0f, 1, 3e20f},
                 {2, 2, 1.0f / 3}, {0, 3, 1},    {5, 5, 5}};
  mesh.corners = {0, 1, 2, 0, 2, 4, 3, 1, 2, 4, 5, 3};
  mesh.face_offsets = {0, 3, 7, 12};
  return mesh;
}

template <class T>
std::vector<T> ramp(std::size_t count, double scale) {
  std::vector<T> values;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = static_cast<double>(i) * scale;
    // Integers wrap; out of a float's range they would not be defined.
    if constexpr (std::is_integral_v<T>)
      values.push_back(static_cast<T>(static_cast<std::int64_t>(value)));
    else
      values.push_back(static_cast<T>(value));
  }
  return values;
}

/// A folder that goes away with its content.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "vkmesh-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) FAIL("no temporary folder");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

inline void write_bytes(const std::filesystem::path& path, std::string_view content) {
  std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
}

inline std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// These, and shapes with normals, uv and colours of points, of corners and of faces, as scenes hold them.
inline std::vector<IndexedFaceSet> with_scene_channels(std::vector<IndexedFaceSet> meshes) {
  IndexedFaceSet of_points = torus(8, 6);
  const std::size_t n = of_points.points.size();
  of_points.point_channels = {{"normal", 3, ramp<float>(3 * n, 0.1)},
                              {"uv", 2, ramp<float>(2 * n, 0.3)},
                              {"color", 3, ramp<float>(3 * n, 0.001)}};
  IndexedFaceSet of_corners = quad_cube();
  of_corners.corner_channels = {{"normal", 3, ramp<float>(72, 0.1)},
                                {"uv", 2, std::vector<float>(48, 0.5f)},
                                {"color", 3, ramp<float>(72, 0.01)}};
  IndexedFaceSet of_faces = mixed_polygons();
  of_faces.face_channels = {{"normal", 3, ramp<float>(9, 0.1)}, {"color", 3, ramp<float>(9, 0.1)}};
  for (IndexedFaceSet* mesh : {&of_points, &of_corners, &of_faces}) meshes.push_back(std::move(*mesh));
  return meshes;
}

/// The numbers of the channel of that name; empty where there is none.
inline std::vector<float> values_of(const std::vector<Channel>& channels, const std::string& name) {
  const Channel* channel = find_channel(channels, name);
  if (channel == nullptr) return {};
  return std::get<std::vector<float>>(channel->values);
}

/// Reading refuses the content with a sentence, or gives a mesh that can be written.
inline void check_sound(std::string_view content, const std::string& name) {
  const auto file = parse_mesh(as_bytes(content), name);
  if (!file) {
    if (file.error().code != ErrorCode::kUnreadable || file.error().message.empty())
      FAIL(name << ": " << file.error().describe());
    return;
  }
  const auto mesh = to_indexed_face_set(*file);
  REQUIRE(mesh);
  for (const std::uint32_t c : mesh->corners)
    if (c >= mesh->points.size()) FAIL(name << " holds a corner out of range");
  // The writer checks offsets and channel sizes.
  if (!mesh->points.empty()) {
    const auto bytes = encode_mesh(*mesh, write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian));
    if (!bytes) FAIL(name << ": " << bytes.error().describe());
  }
}

}  // namespace vkmesh::test
