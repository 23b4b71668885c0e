// The formats, as the public functions of mesh_io.h see them.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/mesh/indexed_face_set.h>

#include "io/bytes.h"

namespace vkmesh::detail {

using Notes = std::vector<FileNote>;

/// Brings the positions of a file to single precision, and watches what that costs.
class Positions {
 public:
  explicit Positions(const DVec3& offset = DVec3(0.0)) : offset_(offset) {}

  Vec3 place(const DVec3& exact) {
    const DVec3 moved = exact - offset_;
    const Vec3 rounded(moved);
    const DVec3 error = DVec3(rounded) - moved;
    // Here and in bounds a coordinate that is not a number counts for nothing.
    bounds_.add(exact);
    for (int axis = 0; axis < 3; ++axis) error_ = std::max(error_, std::abs(error[axis]));
    return rounded;
  }
  void add(const Positions& other);

  [[nodiscard]] const DVec3& offset() const { return offset_; }
  /// The offset with which less would be lost, on a grid that makes the subtraction exact; 0 when little is.
  [[nodiscard]] DVec3 better_offset() const;
  /// Tells of an offset, and of rounding by more than 2^-22 of the size of the mesh.
  void add_notes(Notes& notes) const;

 private:
  [[nodiscard]] double size() const;

  DVec3 offset_;
  DBounds bounds_;
  double error_ = 0;
};

/// What a reader reads, and how it complains.
struct Source {
  std::string_view bytes;
  std::string name;
  const Progress& progress;
  double progress_from = 0;                       ///< The fraction that getting the bytes took.
  const std::filesystem::path* folder = nullptr;  ///< Where the files lie that this one names, if anywhere.
  DVec3 offset{0.0};                              ///< Subtracted from every position.
  Positions* positions = nullptr;                 ///< Where readers place every position.
  const Source* outer = nullptr;                  ///< The file that inlines this one.
  int* inlines = nullptr;                         ///< How many files were inlined, of all that are read.
  bool has_lines = true;                          ///< False: bad_line() tells the byte.
  bool planar = false;                            ///< As ReadOptions has it.
  std::size_t level = 0;                          ///< Of detail; see ReadOptions.

  /// kUnreadable at the line that holds `at`.
  [[nodiscard]] tl::unexpected<Error> bad_line(const char* at, std::string message) const;
  /// kUnreadable at a byte offset.
  [[nodiscard]] tl::unexpected<Error> bad_byte(const char* at, std::string message) const;
  /// Tells the progress callback that `at` is reached. Errors: kInterrupted.
  [[nodiscard]] Result<void> tick(const char* at) const;
  /// Tick now and then: when `i` is a multiple of 65,536.
  [[nodiscard]] static bool due(std::size_t i) { return (i & 0xffff) == 0; }
};

/// The most points and corners a mesh may have: kInvalid is no index.
inline constexpr std::uint64_t kMaxElements = 0xfffffffeu;

/// Collects the corners of faces; face_offsets come into being with the first face that is no triangle. Faces
/// of fewer than three corners are skipped.
class FaceCollector {
 public:
  explicit FaceCollector(IndexedFaceSet& mesh) : mesh_(mesh) {}
  void corner(std::uint32_t point) { mesh_.corners.push_back(point); }
  enum class Face { kKept, kSkipped, kTooMany };
  /// Ends a face of `count` corners. kTooMany when there are more corners than an index can number.
  [[nodiscard]] Face end_face(std::size_t count) {
    if (count < 3) {
      mesh_.corners.resize(mesh_.corners.size() - count);
      return Face::kSkipped;
    }
    if (count != 3 && mesh_.face_offsets.empty())
      for (std::size_t f = 0; f <= faces_; ++f)
        mesh_.face_offsets.push_back(static_cast<std::uint32_t>(3 * f));
    ++faces_;
    if (!mesh_.face_offsets.empty())
      mesh_.face_offsets.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
    return mesh_.corners.size() <= kMaxElements ? Face::kKept : Face::kTooMany;
  }
  /// The mesh holds this many triangles already.
  void start_with_triangles(std::size_t count) { faces_ = count; }

 private:
  IndexedFaceSet& mesh_;
  std::size_t faces_ = 0;
};

/// "3 faces of fewer than three corners skipped", as every reader says it.
void note_small_faces(Notes& notes, std::size_t count);

/// Points with a coordinate that is not finite, and where they stand in the file.
class NonFinitePoints {
 public:
  /// Points may come in any order.
  void add(std::size_t point, const char* at) { points_.emplace_back(point, at); }
  void add(const NonFinitePoints& other) {
    points_.insert(points_.end(), other.points_.begin(), other.points_.end());
  }
  /// Drops those that no face uses, and tells how many. Errors: kUnreadable for the first that one does;
  /// binary: with its byte, else its line.
  [[nodiscard]] Result<void> drop(const Source& source, bool binary, IndexedFaceSet& mesh, Notes& notes);

 private:
  std::vector<std::pair<std::size_t, const char*>> points_;
};

[[nodiscard]] inline bool all_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Colours as text files give them. Whole numbers up to 255 of which some exceed 1 are 8-bit values; else
/// they are as to_canonical_color() has them.
[[nodiscard]] Channel color_channel(std::vector<float> values, unsigned components, bool whole_numbers);

/// Brings colours of any type to 8-bit integers or fractions of 1, the one rule of all readers and writers.
/// Integers of 16 and 32 bits are fractions of the largest of their type, unless none exceeds 255: then they
/// are 8-bit values. Floats of which some exceed 1 are fractions of 255 or, where some exceed that, of 65535.
/// False, with nothing done, where they are canonical already.
bool to_canonical_color(Channel& channel);

/// By the content, or the name where that leaves it open.
[[nodiscard]] Result<MeshFile> parse_format(const Source& source);
[[nodiscard]] Result<MeshFile> parse_ply(const Source& source);
[[nodiscard]] Result<MeshFile> parse_obj(const Source& source);
[[nodiscard]] Result<MeshFile> parse_off(const Source& source);
[[nodiscard]] Result<MeshFile> parse_stl_ascii(const Source& source);
[[nodiscard]] Result<MeshFile> parse_stl_binary(const Source& source);
/// The size that a binary STL file says it has in bytes 80 to 83, or 0 when it is too short to say.
[[nodiscard]] std::uint64_t stl_binary_size(std::string_view bytes);
/// How many letters of `word` are the keyword of OFF, which some files glue to the first count; 0 for none.
[[nodiscard]] std::size_t off_keyword(std::string_view word);
/// Lines of three (or, where these are enough, two) to ten numbers: points, with normals or colours.
[[nodiscard]] Result<MeshFile> parse_xyz(const Source& source);
/// Whether the first line with content is that of an XYZ file.
[[nodiscard]] bool is_xyz(std::string_view bytes);
[[nodiscard]] Result<MeshFile> parse_gltf(const Source& source);
/// The text of kInventor or kVrml1.
[[nodiscard]] Result<MeshFile> parse_inventor(const Source& source, FileFormat format);
/// OpenInventor 2.0 and 2.1 in binary.
[[nodiscard]] Result<MeshFile> parse_binary_inventor(const Source& source);
[[nodiscard]] Result<MeshFile> parse_vrml2(const Source& source);
/// Whether this is GLB, or JSON that looks like glTF.
[[nodiscard]] bool is_gltf(std::string_view bytes);

/// Encoders get meshes whose indices and channel sizes were checked, whose colours are canonical and whose
/// normals, uv and colours are finite. Each returns what the format could not hold.
void encode_ply(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
void encode_obj(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
void encode_off(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
void encode_stl(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
void encode_xyz(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
/// kInventor, kVrml1 and kVrml2.
void encode_scene(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
/// Errors: kUnsuitable for what exceeds the format's 4 GiB, or has no points.
[[nodiscard]] Result<void> encode_gltf(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out,
                                       Notes& notes);

/// Levels of detail in one file, the finest first; see write_levels().
[[nodiscard]] Result<void> encode_gltf_levels(std::span<const IndexedFaceSet> levels,
                                              const LevelWriteOptions& options, const WriteOptions& write,
                                              Output& out, Notes& notes);

/// The lines of a comment: every control character ends one.
[[nodiscard]] std::vector<std::string> comment_lines(const std::string& comment);

/// "dropped.curvature", "point channel 'curvature' left out: OBJ holds none of that name".
void note_left_out(Notes& notes, const char* element, const Channel& channel, const std::string& reason);

/// "dropped.labels", for a channel that is written without what its numbers stand for.
void note_labels_left_out(Notes& notes, const char* element, const Channel& channel);

/// Scalar i of a channel as a float.
[[nodiscard]] float channel_float(const Channel& channel, std::size_t i);
/// Scalar i of a canonical colour channel as a fraction of 1, and in 8 bits.
[[nodiscard]] float color_fraction(const Channel& channel, std::size_t i);
[[nodiscard]] std::uint8_t color_byte(const Channel& channel, std::size_t i);

/// Appends the shortest text that reads back as the same value. `to` has room for 32 characters.
template <class T>
char* put_number(char* to, T value) {
  return std::to_chars(to, to + 32, value).ptr;
}

/// Appends the shortest text of a coordinate that, less the offset, reads back as the same value. `to` has
/// room for 64 characters.
char* put_coordinate(char* to, float value, double offset);

}  // namespace vkmesh::detail
