// Writes the inputs that fuzzing starts from: make_seeds FOLDER makes FOLDER/TARGET/ for each target.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/io/mesh_io.h>

#include "face_set.h"
#include "support/inventor_bytes.h"

namespace vkmesh::fuzz {
namespace {

struct Seed {
  std::string name;
  IndexedFaceSet mesh;
};

template <class T>
std::vector<T> count_up(std::size_t count) {
  std::vector<T> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<T>(i % 100));
  return values;
}

/// One channel of every meaning and of every scalar type.
IndexedFaceSet with_channels(IndexedFaceSet mesh) {
  const std::size_t points = mesh.points.size(), corners = mesh.corners.size(), faces = mesh.face_count();
  mesh.point_channels = {
      {"normal", 3, count_up<float>(3 * points)},   {"color", 3, count_up<std::uint8_t>(3 * points)},
      {"quality", 1, count_up<double>(points)},     {"a", 1, count_up<std::int8_t>(points)},
      {"b", 2, count_up<std::int16_t>(2 * points)}, {"c", 1, count_up<std::uint32_t>(points)}};
  mesh.corner_channels = {{"uv", 2, count_up<float>(2 * corners)},
                          {"normal", 3, count_up<float>(3 * corners)}};
  mesh.face_channels = {{"color", 4, count_up<std::uint8_t>(4 * faces)},
                        {"d", 1, count_up<std::uint16_t>(faces)},
                        {"e", 1, count_up<std::int32_t>(faces)}};
  return mesh;
}

/// Faces over as many points as they name, which lie on a small helix.
IndexedFaceSet mesh_of(const std::vector<std::vector<std::uint32_t>>& faces) {
  IndexedFaceSet mesh;
  mesh.face_offsets = {0};
  std::uint32_t points = 0;
  for (const auto& face : faces) {
    mesh.corners.insert(mesh.corners.end(), face.begin(), face.end());
    mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    points = std::max(points, *std::max_element(face.begin(), face.end()) + 1);
  }
  mesh.normalize_offsets();
  for (std::uint32_t i = 0; i < points; ++i)
    mesh.points.emplace_back(static_cast<float>(i % 3), static_cast<float>(i % 4),
                             0.1f * static_cast<float>(i));
  return mesh;
}

std::vector<Seed> seeds() {
  const IndexedFaceSet tetrahedron = mesh_of({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const IndexedFaceSet cube =
      mesh_of({{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
  std::vector<Seed> all = {{"tetrahedron", tetrahedron},
                           {"cube", cube},
                           {"strip", mesh_of({{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}})},
                           {"mobius", mesh_of({{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 0}, {4, 0, 1}})},
                           {"bow-tie", mesh_of({{0, 1, 2}, {0, 3, 4}})},
                           {"fin", mesh_of({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})},
                           {"misoriented", mesh_of({{0, 1, 2}, {0, 1, 3}})},
                           {"twice", mesh_of({{0, 1, 2}, {1, 2, 0}, {3, 3, 4}, {5, 6, 7, 8, 6}})},
                           {"mixed", mesh_of({{0, 1, 2}, {0, 2, 4, 3}, {1, 5, 6, 4, 2}, {7, 8, 9}})},
                           {"channels", with_channels(cube)},
                           {"triangle-channels", with_channels(tetrahedron)},
                           {"points", {}}};
  all.back().mesh.points = {{0, 0, 0}, {-1.5f, 1e-20f, 3e20f}};
  return all;
}

bool write(const std::filesystem::path& path, const void* bytes, std::size_t count) {
  std::ofstream file(path, std::ios::binary);
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  file.close();
  return static_cast<bool>(file);
}

/// Each shape, each operation and each point type, with changes that a small generator chooses: no format
/// says what these bytes should be.
bool write_decimation_seeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  bool written = true;
  for (std::uint32_t seed = 0; seed < 48; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> bytes(200);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    bytes[0] = static_cast<std::uint8_t>(seed);      // the point type
    bytes[1] = 0;                                    // one shape
    bytes[2] = static_cast<std::uint8_t>(seed / 2);  // its kind
    bytes[5] %= 64;                                  // changes
    written = write(folder / std::to_string(seed), bytes.data(), bytes.size()) && written;
  }
  return written;
}

bool write_seeds(const std::filesystem::path& folder) {
  bool written = write_decimation_seeds(folder / "decimate");
  for (const Seed& seed : seeds()) {
    const auto bytes = bytes_of(seed.mesh);
    std::filesystem::create_directories(folder / "consolidate");
    written = write(folder / "consolidate" / seed.name, bytes.data(), bytes.size()) && written;
    for (const char* extension : {"ply", "obj", "off", "stl", "iv", "vrml1", "wrl", "gltf", "glb", "xyz"}) {
      auto options = write_options_for(std::string("seed.") + extension);
      if (!options) return false;
      std::filesystem::create_directories(folder / extension);
      const bool chosen = options->format == FileFormat::kPly || options->format == FileFormat::kStl;
      for (const FileEncoding encoding :
           {FileEncoding::kAscii, FileEncoding::kBinaryLittleEndian, FileEncoding::kBinaryBigEndian}) {
        if (!chosen && encoding != options->encoding) continue;  // The extension says which.
        options->encoding = encoding;
        const auto encoded = encode_mesh(seed.mesh, *options);
        if (!encoded) continue;  // Polygons into STL, which also has no big-endian form; faces into XYZ.
        const auto path = folder / extension / (seed.name + "-" + name_of(encoding));
        written = write(path, encoded->data(), encoded->size()) && written;
      }
    }
  }
  for (const bool has_flags : {false, true}) {
    const test::InventorBytes iv{has_flags};
    const std::string bytes = iv.header() + test::inventor_scene(iv);
    const auto path = folder / "iv" / (has_flags ? "scene-binary-2.1" : "scene-binary-2.0");
    written = write(path, bytes.data(), bytes.size()) && written;
  }
  return written;
}

}  // namespace
}  // namespace vkmesh::fuzz

int main(int argc, char** argv) {
  if (argc == 2 && vkmesh::fuzz::write_seeds(argv[1])) return 0;
  std::fprintf(stderr, "usage: %s FOLDER, which must be writable\n", argv[0]);
  return 1;
}
