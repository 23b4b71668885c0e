// Reading and writing mesh files: PLY, OBJ, OFF, STL, glTF, OpenInventor and VRML, each also gzipped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/mesh/polygon_soup.h>

namespace vkmesh {

enum class FileFormat { kPly, kObj, kOff, kStl, kGltf, kInventor, kVrml1, kVrml2 };
enum class FileEncoding { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

/// "ply", "obj", "off", "stl", "gltf", "iv", "vrml1", "vrml2".
[[nodiscard]] std::string name_of(FileFormat format);
/// "ascii", "binary_little_endian", "binary_big_endian".
[[nodiscard]] std::string name_of(FileEncoding encoding);

/// A mesh as it was read.
struct MeshFile {
  std::variant<IndexedFaceSet, PolygonSoup> geometry;  ///< PolygonSoup for STL, IndexedFaceSet for the rest.
  FileFormat format = FileFormat::kPly;
  FileEncoding encoding = FileEncoding::kAscii;
  bool gzip = false;
  /// One sentence for each kind of content that was not kept ("12 'l' lines ignored").
  std::vector<std::string> notes;
};

struct ReadOptions {
  Progress progress;
};

/// Reads a file of any known format. The content decides the format, the extension only where the content
/// leaves it open (OBJ). gzip is recognised by its magic bytes. "-" reads standard input. O(bytes); no
/// allocation that the bytes present do not justify. A face of fewer than three corners is refused; one
/// that repeats a point is not (consolidate counts it). Errors: kUnreadable (missing, a directory, malformed,
/// an index out of range, a coordinate that is not finite; with file and line or byte), kOutOfMemory,
/// kInterrupted.
[[nodiscard]] Result<MeshFile> read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from memory; `name` stands for the path in errors and its extension serves as the hint.
[[nodiscard]] Result<MeshFile> parse_mesh(std::span<const std::byte> bytes, const std::string& name,
                                          const ReadOptions& options = {});

/// The geometry of a file as an indexed face set; a soup is welded (see weld()).
[[nodiscard]] Result<IndexedFaceSet> to_indexed_face_set(MeshFile file);

struct WriteOptions {
  FileFormat format = FileFormat::kPly;
  /// OBJ, OFF, Inventor and VRML are text whatever this says; STL has no big-endian form.
  FileEncoding encoding = FileEncoding::kBinaryLittleEndian;
  bool gzip = false;
  /// What the file's comment says made it; left out of formats without comments. Empty for none.
  std::string comment;
};

/// Options from a file name: "a.ply.gz" is a gzipped binary PLY, "a.obj" OBJ, "-" binary PLY.
/// Errors: kUsage for an extension that no writer serves (the message lists those that exist).
[[nodiscard]] Result<WriteOptions> write_options_for(const std::filesystem::path& path);

/// Writes the mesh. The file appears whole or not at all: it is written beside its place, then renamed. "-"
/// writes to standard output. What the format cannot hold (STL has no attributes) is left out and named in
/// the returned notes. Errors: kNotWritable (with the system's reason), kUnsuitable (polygons into STL),
/// kOutOfMemory.
[[nodiscard]] Result<std::vector<std::string>> write_mesh(const std::filesystem::path& path,
                                                          const IndexedFaceSet& mesh,
                                                          const WriteOptions& options);

/// The same into memory.
[[nodiscard]] Result<std::vector<std::byte>> encode_mesh(const IndexedFaceSet& mesh,
                                                         const WriteOptions& options);

/// Writes polylines, each the points of one in order, as the lines ("l") of an OBJ file that holds the points
/// they name. Otherwise as write_mesh(). Errors: kUsage for an index out of range; kNotWritable;
/// kOutOfMemory.
[[nodiscard]] Result<void> write_polylines(const std::filesystem::path& path, std::span<const Vec3> points,
                                           std::span<const std::vector<std::uint32_t>> polylines);

}  // namespace vkmesh
