// Fuzzes a reader: what it takes can be written in the same format and reads back as the same geometry.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <vkmesh/io/mesh_io.h>

#include "check.h"
#include "io/ply/ply.h"

namespace vkmesh::fuzz {
namespace {

bool same_position(const Vec3& a, const Vec3& b) {
  return std::memcmp(&a, &b, sizeof(Vec3)) == 0;
}

bool same_positions(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

/// What the readers promise.
void require_sound(const IndexedFaceSet& mesh) {
  for (const std::uint32_t c : mesh.corners) require(c < mesh.points.size(), "every corner names a point");
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    require(mesh.face(f).size() >= 3, "every face has three corners or more");
  const auto fits = [](const std::vector<Channel>& channels, std::size_t elements) {
    for (const Channel& c : channels) require(c.scalar_count() == elements * c.components, "channels fit");
  };
  fits(mesh.point_channels, mesh.points.size());
  fits(mesh.corner_channels, mesh.corners.size());
  fits(mesh.face_channels, mesh.face_count());
}

/// Face by face and corner by corner the same positions: all that a format of soups keeps.
void require_same_corners(const IndexedFaceSet& mesh, const PolygonSoup& back) {
  require(mesh.face_offsets == back.face_offsets, "faces keep their corner counts");
  require(mesh.corners.size() == back.corners.size(), "faces keep their corners");
  for (std::size_t c = 0; c < back.corners.size(); ++c)
    require(same_position(mesh.points[mesh.corners[c]], back.corners[c]), "corners keep their positions");
}

/// The triangles, each as the positions of its corners, in ascending order: glTF groups them by material.
std::vector<std::array<float, 9>> triangles_of(const IndexedFaceSet& mesh) {
  std::vector<std::array<float, 9>> triangles(mesh.face_count());
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    for (int axis = 0; axis < 3; ++axis)
      triangles[c / 3][3 * (c % 3) + static_cast<std::size_t>(axis)] = mesh.points[mesh.corners[c]][axis];
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

void round_trip(const IndexedFaceSet& mesh, const WriteOptions& options) {
  const auto bytes = encode_mesh(mesh, options);
  if (!bytes) {
    // A polygon that the format cannot hold is refused; nothing else may be.
    require(bytes.error().code == ErrorCode::kUnsuitable, "written: " + bytes.error().describe());
    return;
  }
  auto back = parse_mesh(*bytes, VKMESH_FUZZ_NAME);
  require(back.has_value(), "what is written can be read: " + (back ? "" : back.error().describe()));
  require(back->format == options.format, "what is written is of its format");
  if (const auto* soup = std::get_if<PolygonSoup>(&back->geometry)) return require_same_corners(mesh, *soup);
  const auto& other = std::get<IndexedFaceSet>(back->geometry);
  if (options.format == FileFormat::kGltf)
    return require(triangles_of(mesh) == triangles_of(other), "triangles are kept bit for bit");
  require(same_positions(mesh.points, other.points), "points are kept bit for bit");
  require(mesh.corners == other.corners && mesh.face_offsets == other.face_offsets, "faces are kept");
}

/// PLY is read in blocks where it is long; the result and the error are the same for short ones.
void require_same_in_blocks(std::span<const std::byte> bytes, const Result<MeshFile>& file) {
  const Progress progress;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto other = detail::ply::parse({text, VKMESH_FUZZ_NAME, progress, 0}, 1 + bytes.size() % 61);
  require(file.has_value() == other.has_value(), "blocks are refused like the whole");
  if (!file)
    return require(file.error().describe() == other.error().describe(), "blocks give the error of the whole");
  const auto& mesh = std::get<IndexedFaceSet>(file->geometry);
  const auto& again = std::get<IndexedFaceSet>(other->geometry);
  require(same_positions(mesh.points, again.points), "blocks give the points of the whole");
  require(mesh.corners == again.corners && mesh.face_offsets == again.face_offsets,
          "blocks give the faces of the whole");
  require(file->notes == other->notes, "blocks give the notes of the whole");
}

void fuzz(std::span<const std::byte> bytes) {
  auto file = parse_mesh(bytes, VKMESH_FUZZ_NAME);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("ply\n")) require_same_in_blocks(bytes, file);
  if (!file) return require(!file.error().message.empty(), "errors are told");
  WriteOptions options;
  options.format = file->format;
  auto mesh = to_indexed_face_set(std::move(*file));
  require(mesh.has_value(), "soups are welded");
  require_sound(*mesh);
  for (const FileEncoding encoding :
       {FileEncoding::kAscii, FileEncoding::kBinaryLittleEndian, FileEncoding::kBinaryBigEndian}) {
    const bool only_little = options.format == FileFormat::kStl || options.format == FileFormat::kGltf;
    if (only_little && encoding == FileEncoding::kBinaryBigEndian) continue;
    options.encoding = encoding;
    round_trip(*mesh, options);
  }
}

}  // namespace
}  // namespace vkmesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vkmesh::fuzz::fuzz(std::as_bytes(std::span(data, size)));
  return 0;
}
