// The formats, as the public functions of mesh_io.h see them.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/mesh/indexed_face_set.h>

#include "io/bytes.h"

namespace vkmesh::detail {

/// What a reader reads, and how it complains.
struct Source {
  std::string_view bytes;
  std::string name;
  const Progress& progress;
  double progress_from = 0;                       ///< The fraction that getting the bytes took.
  const std::filesystem::path* folder = nullptr;  ///< Where the files lie that this one names, if anywhere.

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

/// Collects the corners of faces; face_offsets come into being with the first face that is no triangle.
class FaceCollector {
 public:
  explicit FaceCollector(IndexedFaceSet& mesh) : mesh_(mesh) {}
  void corner(std::uint32_t point) { mesh_.corners.push_back(point); }
  /// Ends a face of `count` corners. False when there are more corners than an index can number.
  bool end_face(std::size_t count) {
    if (count != 3 && mesh_.face_offsets.empty())
      for (std::size_t f = 0; f <= faces_; ++f)
        mesh_.face_offsets.push_back(static_cast<std::uint32_t>(3 * f));
    ++faces_;
    if (!mesh_.face_offsets.empty())
      mesh_.face_offsets.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
    return mesh_.corners.size() <= kMaxElements;
  }
  /// The mesh holds this many triangles already.
  void start_with_triangles(std::size_t count) { faces_ = count; }

 private:
  IndexedFaceSet& mesh_;
  std::size_t faces_ = 0;
};

/// Colours as text files give them. Whole numbers up to 255 of which some exceed 1 are 8-bit values; else
/// they are fractions of 1.
[[nodiscard]] Channel color_channel(std::vector<float> values, unsigned components, bool whole_numbers);

[[nodiscard]] Result<MeshFile> parse_ply(const Source& source);
[[nodiscard]] Result<MeshFile> parse_obj(const Source& source);
[[nodiscard]] Result<MeshFile> parse_off(const Source& source);
[[nodiscard]] Result<MeshFile> parse_stl_ascii(const Source& source);
[[nodiscard]] Result<MeshFile> parse_stl_binary(const Source& source);
/// The size that a binary STL file says it has in bytes 80 to 83, or 0 when it is too short to say.
[[nodiscard]] std::uint64_t stl_binary_size(std::string_view bytes);
[[nodiscard]] Result<MeshFile> parse_gltf(const Source& source);
/// kInventor (version 2, ascii) or kVrml1.
[[nodiscard]] Result<MeshFile> parse_inventor(const Source& source, FileFormat format);
[[nodiscard]] Result<MeshFile> parse_vrml2(const Source& source);
/// Whether this is GLB, or JSON that looks like glTF.
[[nodiscard]] bool is_gltf(std::string_view bytes);

using Notes = std::vector<std::string>;

/// Encoders get meshes whose indices and channel sizes were checked. Each returns what the format could not
/// hold.
void encode_ply(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
void encode_obj(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
void encode_off(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
void encode_stl(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
/// kInventor, kVrml1 and kVrml2.
void encode_scene(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes);
/// Errors: kUnsuitable for what exceeds the format's 4 GiB, or has no points.
[[nodiscard]] Result<void> encode_gltf(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out,
                                       Notes& notes);

/// The lines of a comment: every control character ends one.
[[nodiscard]] std::vector<std::string> comment_lines(const std::string& comment);

/// "point channel 'curvature' left out: OBJ holds none of that name".
void note_left_out(Notes& notes, const char* element, const Channel& channel, const std::string& reason);

/// Scalar i of a channel as a float.
[[nodiscard]] float channel_float(const Channel& channel, std::size_t i);
/// Scalar i of a colour channel as a fraction of 1, and in 8 bits.
[[nodiscard]] float color_fraction(const Channel& channel, std::size_t i);
[[nodiscard]] std::uint8_t color_byte(const Channel& channel, std::size_t i);

/// Appends the shortest text that reads back as the same value. `to` has room for 32 characters.
template <class T>
char* put_number(char* to, T value) {
  return std::to_chars(to, to + 32, value).ptr;
}

}  // namespace vkmesh::detail
