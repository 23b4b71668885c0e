// Reading and writing mesh files: PLY, OBJ, OFF, STL, glTF, OpenInventor, VRML and XYZ, each also gzipped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/mesh/polygon_soup.h>

namespace vkmesh {

enum class FileFormat { kPly, kObj, kOff, kStl, kGltf, kInventor, kVrml1, kVrml2, kXyz };
enum class FileEncoding { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

/// "ply", "obj", "off", "stl", "gltf", "iv", "vrml1", "vrml2", "xyz".
[[nodiscard]] VKMESH_API std::string name_of(FileFormat format);
/// "ascii", "binary_little_endian", "binary_big_endian".
[[nodiscard]] VKMESH_API std::string name_of(FileEncoding encoding);

/// A difference between a file and the mesh read from it or written to it.
struct VKMESH_API FileNote {
  /// What happened to what, for programs: "dropped.skin", "rounded.positions". The first word is "dropped"
  /// (content that is not kept), "skipped" (malformed content that is passed over), "rounded" (to fewer
  /// bits), "replaced" (values a format cannot hold), "partial" (elements without a value got a neutral one),
  /// "nonfinite" (values that are not finite are kept), "repaired" (a frame around the content deviates from
  /// the format), or "offset" (positions are relative to an offset). Codes stay the same between versions.
  std::string code;
  std::string sentence;  ///< For people: "12 'l' lines ignored".

  /// Whether the mesh holds less than the file: true for all but "repaired" and "offset".
  [[nodiscard]] bool is_loss() const;
  friend bool operator==(const FileNote&, const FileNote&) = default;
};

/// A mesh as it was read.
struct MeshFile {
  std::variant<IndexedFaceSet, PolygonSoup> geometry;  ///< PolygonSoup for STL, IndexedFaceSet for the rest.
  DVec3 offset{0.0};  ///< Points are positions of the file less this: see ReadOptions.
  FileFormat format = FileFormat::kPly;
  FileEncoding encoding = FileEncoding::kAscii;
  bool gzip = false;
  std::vector<std::string> material_libraries;  ///< OBJ: the files that `mtllib` names.
  std::size_t levels = 1;       ///< glTF: the levels of detail of the node that has most; see ReadOptions.
  std::vector<FileNote> notes;  ///< One for each kind of difference.
};

struct ReadOptions {
  Progress progress;
  /// Subtracted from every position before it is rounded to single precision.
  DVec3 offset{0.0};
  /// Where a mesh lies so far from the origin that single precision would lose more than 2^-21 of its size
  /// (map coordinates), and `offset` is 0: subtract an offset on a grid of powers of two, exactly, and return
  /// it in MeshFile::offset. Without this, positions are rounded where they are, and a note tells the error.
  bool find_offset = false;
  /// XYZ: take lines of two numbers, too, as points whose z is 0.
  bool planar = false;
  /// glTF: which level of detail is read of nodes that have several, by MSFT_lod or as nodes NAME_LOD0,
  /// NAME_LOD1, … beside each other; of those that have fewer, the coarsest. Default 0, the finest.
  std::size_t level = 0;
};

/// Reads a file of any known format. The content decides the format, the extension only where the content
/// leaves it open (OBJ, XYZ). gzip is recognised by its magic bytes, a UTF-8 byte-order mark is passed over.
/// "-" reads standard input. O(bytes); no allocation that the bytes present do not justify. Faces of fewer
/// than three corners, and points that are not finite and that no face uses, are skipped and counted in the
/// notes; a face that repeats a point is kept (consolidate counts it). Colours are 8-bit integers or
/// fractions of 1, whatever type the file gives them. Errors: kUnreadable (missing, a directory, malformed,
/// without points, an index out of range, a coordinate that is not finite; with file and line or byte),
/// kOutOfMemory, kInterrupted.
[[nodiscard]] VKMESH_API Result<MeshFile> read_mesh(const std::filesystem::path& path,
                                                    const ReadOptions& options = {});

/// The same from memory; `name` stands for the path in errors and its extension serves as the hint.
[[nodiscard]] VKMESH_API Result<MeshFile> parse_mesh(std::span<const std::byte> bytes,
                                                     const std::string& name,
                                                     const ReadOptions& options = {});

/// The geometry of a file as an indexed face set; a soup is welded (see weld()).
[[nodiscard]] VKMESH_API Result<IndexedFaceSet> to_indexed_face_set(MeshFile file);

struct WriteOptions {
  FileFormat format = FileFormat::kPly;
  /// OBJ, OFF, Inventor and VRML are text whatever this says; STL has no big-endian form.
  FileEncoding encoding = FileEncoding::kBinaryLittleEndian;
  bool gzip = false;
  /// What the file's comment says made it; left out of formats without comments. Empty for none.
  std::string comment;
  DVec3 offset{0.0};  ///< Added to every point; PLY and glTF then hold doubles where they write binary.
  std::vector<std::string> material_libraries;  ///< OBJ: written as `mtllib`.
};

/// Options from a file name: "a.ply.gz" is a gzipped binary PLY, "a.obj" OBJ, "-" binary PLY.
/// Errors: kUsage for an extension that no writer serves (the message lists those that exist).
[[nodiscard]] VKMESH_API Result<WriteOptions> write_options_for(const std::filesystem::path& path);

/// Writes the mesh. The file appears whole or not at all: it is written beside its place, then renamed. "-"
/// writes to standard output. What the format cannot hold (STL has no attributes) is left out and named in
/// the returned notes. Normals, uv and colours that are not finite are written as 0. Errors: kNotWritable
/// (with the system's reason), kUnsuitable (no points; polygons or a point cloud into STL, faces into XYZ),
/// kOutOfMemory.
[[nodiscard]] VKMESH_API Result<std::vector<FileNote>> write_mesh(const std::filesystem::path& path,
                                                                  const IndexedFaceSet& mesh,
                                                                  const WriteOptions& options);

/// What write_mesh() would return, without a file: the bytes are made and let go.
[[nodiscard]] VKMESH_API Result<std::vector<FileNote>> losses_of(const IndexedFaceSet& mesh,
                                                                 const WriteOptions& options);

/// The same into memory.
[[nodiscard]] VKMESH_API Result<std::vector<std::byte>> encode_mesh(const IndexedFaceSet& mesh,
                                                                    const WriteOptions& options);

/// How levels of detail stand in a glTF file.
enum class LevelLayout {
  kNodes,   ///< Nodes NAME_LOD0, NAME_LOD1, … under one node NAME, as engines know them by name.
  kMsftLod  ///< A node with the finest mesh names those of the others, by the extension MSFT_lod.
};

struct LevelWriteOptions {
  LevelLayout layout = LevelLayout::kNodes;
  std::string name = "mesh";  ///< NAME in the names of nodes and meshes.
  /// MSFT_lod: for each level the least share of the screen that it is meant for, falling. Empty: not said.
  std::vector<double> screen_coverage;
  /// The points of each level are the first of those of the level before, and so are what its corners have:
  /// vertices are written once, the coarsest level's first, and a level takes the first of them.
  bool shared_points = false;
};

/// Writes levels of detail, the finest first, into one glTF file. Otherwise as write_mesh(). Errors: also
/// kUsage for another format, for no levels, and for a coverage that is not one for each of them.
[[nodiscard]] VKMESH_API Result<std::vector<FileNote>> write_levels(const std::filesystem::path& path,
                                                                    std::span<const IndexedFaceSet> levels,
                                                                    const LevelWriteOptions& level_options,
                                                                    const WriteOptions& options);

/// Writes each mesh into a file of its own, all of one format. All files are whole before the first of them
/// appears. The notes are those of all. Otherwise as write_mesh(). Errors: also kUsage unless there is a path
/// for each mesh.
[[nodiscard]] VKMESH_API Result<std::vector<FileNote>> write_meshes(
    std::span<const std::filesystem::path> paths, std::span<const IndexedFaceSet> meshes,
    const WriteOptions& options);

/// Writes polylines, each the points of one in order, as the lines ("l") of an OBJ file that holds the points
/// they name; `offset` is added to each. Otherwise as write_mesh(). Errors: kUsage for an index out of range;
/// kNotWritable; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<void> write_polylines(const std::filesystem::path& path,
                                                      std::span<const Vec3> points,
                                                      std::span<const std::vector<std::uint32_t>> polylines,
                                                      const DVec3& offset = DVec3(0.0));

}  // namespace vkmesh
