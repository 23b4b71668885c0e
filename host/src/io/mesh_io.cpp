#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/weld.h>

#include "io/bytes.h"
#include "io/formats.h"
#include "io/text.h"

namespace vkmesh {
namespace detail {

tl::unexpected<Error> Source::bad_line(const char* at, std::string message) const {
  // Counted only when something is wrong. A file without line feeds ends its lines with carriage returns.
  const auto upto = bytes.begin() + (at - bytes.data());
  const char line_end = bytes.find('\n') == std::string_view::npos ? '\r' : '\n';
  const auto line = static_cast<std::uint64_t>(std::count(bytes.begin(), upto, line_end)) + 1;
  return fail(ErrorCode::kUnreadable, std::move(message), {name, line, {}});
}

tl::unexpected<Error> Source::bad_byte(const char* at, std::string message) const {
  return fail(ErrorCode::kUnreadable, std::move(message),
              {name, {}, static_cast<std::uint64_t>(at - bytes.data())});
}

Result<void> Source::tick(const char* at) const {
  if (!progress || bytes.empty()) return {};
  const double part = static_cast<double>(at - bytes.data()) / static_cast<double>(bytes.size());
  if (progress(progress_from + (1 - progress_from) * part)) return {};
  return fail(ErrorCode::kInterrupted, "reading was interrupted", {name, {}, {}});
}

Channel color_channel(std::vector<float> values, unsigned components, bool whole_numbers) {
  const bool bytes =
      whole_numbers && std::any_of(values.begin(), values.end(), [](float v) { return v > 1; });
  if (!bytes) return {"color", components, std::move(values)};
  std::vector<std::uint8_t> rounded;
  rounded.reserve(values.size());
  for (const float v : values) rounded.push_back(static_cast<std::uint8_t>(v));
  return {"color", components, std::move(rounded)};
}

std::vector<std::string> comment_lines(const std::string& comment) {
  std::vector<std::string> lines;
  std::string line;
  for (const char c : comment + "\n") {
    if (static_cast<unsigned char>(c) >= 0x20) {
      line += c;
    } else if (!line.empty()) {
      lines.push_back(std::exchange(line, {}));
    }
  }
  return lines;
}

void note_left_out(Notes& notes, const char* element, const Channel& channel, const std::string& reason) {
  notes.push_back(std::string(element) + " channel '" + channel.name + "' left out: " + reason);
}

float channel_float(const Channel& channel, std::size_t i) {
  return std::visit([&](const auto& v) { return static_cast<float>(v[i]); }, channel.values);
}

float color_fraction(const Channel& channel, std::size_t i) {
  return std::visit(
      [&](const auto& v) {
        const auto value = static_cast<float>(v[i]);
        return std::is_integral_v<std::decay_t<decltype(v[i])>> ? value / 255.0f : value;
      },
      channel.values);
}

std::uint8_t color_byte(const Channel& channel, std::size_t i) {
  const float bytes = color_fraction(channel, i) * 255.0f;
  // Not-a-number fails the comparison and is black.
  return bytes > 0 ? static_cast<std::uint8_t>(std::lround(std::min(bytes, 255.0f))) : std::uint8_t{0};
}

namespace {

struct KnownFormat {
  FileFormat format;
  const char* name;
};

/// Each format with its extensions, the first of which is its name.
constexpr KnownFormat kFormats[] = {
    {FileFormat::kPly, "ply"},     {FileFormat::kObj, "obj"},     {FileFormat::kOff, "off"},
    {FileFormat::kStl, "stl"},     {FileFormat::kGltf, "gltf"},   {FileFormat::kGltf, "glb"},
    {FileFormat::kInventor, "iv"}, {FileFormat::kVrml1, "vrml1"}, {FileFormat::kVrml2, "vrml2"},
    {FileFormat::kVrml2, "wrl"},   {FileFormat::kVrml2, "vrml"}};

/// What the name of a file says: its extension in lower case without the dot, and a .gz after it.
struct NameHint {
  std::string extension;
  bool gzip = false;
};

NameHint hint_of(std::filesystem::path path) {
  const auto extension = [&] {
    std::string text = path.extension().string();
    if (!text.empty()) text.erase(0, 1);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text;
  };
  NameHint hint{extension(), false};
  if (hint.extension == "wrz") return {"wrl", true};
  if (hint.extension != "gz") return hint;
  hint.gzip = true;
  path = path.stem();
  hint.extension = extension();
  return hint;
}

std::optional<FileFormat> format_named(const std::string& extension) {
  for (const KnownFormat& known : kFormats)
    if (extension == known.name) return known.format;
  return std::nullopt;
}

/// Text begins with one of these when it is OBJ.
bool is_obj_keyword(std::string_view word) {
  static constexpr std::string_view kWords[] = {"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"};
  return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
}

/// Inventor and VRML, which their first line tells apart.
Result<MeshFile> parse_scene_file(const Source& source) {
  const std::string_view line = source.bytes.substr(0, source.bytes.find_first_of("\r\n"));
  if (line.starts_with("#Inventor V2.") && line.find("ascii") != std::string_view::npos)
    return parse_inventor(source, FileFormat::kInventor);
  if (line.starts_with("#VRML V1.0 ascii")) return parse_inventor(source, FileFormat::kVrml1);
  if (line.starts_with("#VRML V2.0 utf8")) return parse_vrml2(source);
  if (line.find("binary") != std::string_view::npos)
    return source.bad_line(line.data(),
                           "binary Inventor files are not read: write it as ascii, for example with ivcat");
  return source.bad_line(line.data(),
                         "only Inventor 2 in ascii, VRML 1.0 in ascii and VRML 2.0 in utf8 are read");
}

Result<MeshFile> parse_content(const Source& source) {
  const std::string_view bytes = source.bytes;
  if (bytes.empty()) return fail(ErrorCode::kUnreadable, "the file is empty", {source.name, {}, {}});
  // The magic number of PLY is its first line; a binary STL file of the right size is one whatever its header
  // says.
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || bytes.starts_with("ply "))
    return parse_ply(source);
  if (stl_binary_size(bytes) == bytes.size()) return parse_stl_binary(source);
  if (is_gltf(bytes)) return parse_gltf(source);
  if (bytes.starts_with("#Inventor ") || bytes.starts_with("#VRML ")) return parse_scene_file(source);

  TextCursor text(bytes, '#');
  text.skip_to_content();
  const std::string_view word = text.word();
  const bool has_zeros = bytes.substr(0, 512).find('\0') != std::string_view::npos;
  if (word.size() <= 7 && word.ends_with("OFF")) return parse_off(source);
  if ((word == "solid" || word == "SOLID" || word == "Solid") && !has_zeros) return parse_stl_ascii(source);

  const auto named = format_named(hint_of(source.name).extension);
  if (named == FileFormat::kStl) return parse_stl_binary(source);
  if (named == FileFormat::kPly)
    return source.bad_line(bytes.data(),
                           "a PLY file begins with a line 'ply', this one with " + TextCursor(bytes).found());
  if (named == FileFormat::kOff) return parse_off(source);
  if (named == FileFormat::kGltf) return parse_gltf(source);
  if (named == FileFormat::kInventor || named == FileFormat::kVrml1 || named == FileFormat::kVrml2)
    return source.bad_line(
        bytes.data(), "an Inventor or VRML file begins with its name and version after a #, this one with " +
                          TextCursor(bytes).found());
  if (named == FileFormat::kObj || is_obj_keyword(word)) return parse_obj(source);
  return fail(ErrorCode::kUnreadable, "the content is none of PLY, OBJ, OFF, STL, glTF, Inventor, VRML",
              {source.name, {}, {}});
}

/// Refuses what no encoder could write: channels of the wrong size, indices and offsets that point nowhere.
Result<void> check_writable(const IndexedFaceSet& mesh, const WriteOptions& options) {
  if (mesh.is_triangles()
          ? mesh.corners.size() % 3 != 0
          : mesh.face_offsets.front() != 0 || mesh.face_offsets.back() != mesh.corners.size() ||
                !std::is_sorted(mesh.face_offsets.begin(), mesh.face_offsets.end()))
    return fail(ErrorCode::kUsage, "the face offsets of the mesh do not fit its corners");
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    if (mesh.corners[c] >= mesh.points.size())
      return fail(ErrorCode::kUsage, "corner " + std::to_string(c) + " names point " +
                                         std::to_string(mesh.corners[c]) + " of " +
                                         std::to_string(mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (!std::isfinite(mesh.points[i].x) || !std::isfinite(mesh.points[i].y) ||
        !std::isfinite(mesh.points[i].z))
      return fail(ErrorCode::kUnsuitable,
                  "point " + std::to_string(i) + " has a coordinate that is not finite");
  const auto check = [](const std::vector<Channel>& channels, std::size_t elements) -> Result<void> {
    for (const Channel& c : channels)
      if (c.scalar_count() != elements * c.components)
        return fail(ErrorCode::kUsage, "channel '" + c.name + "' holds " + std::to_string(c.scalar_count()) +
                                           " scalars for " + std::to_string(elements) + " elements of " +
                                           std::to_string(c.components));
    return {};
  };
  VKMESH_CHECK(check(mesh.point_channels, mesh.points.size()));
  VKMESH_CHECK(check(mesh.corner_channels, mesh.corners.size()));
  VKMESH_CHECK(check(mesh.face_channels, mesh.face_count()));
  const bool triangles_only = options.format == FileFormat::kStl || options.format == FileFormat::kGltf;
  const std::string format_name = options.format == FileFormat::kStl ? "STL" : "glTF";
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::size_t corners = mesh.face(f).size();
    if (corners < 3)
      return fail(ErrorCode::kUnsuitable,
                  "face " + std::to_string(f) + " has " + std::to_string(corners) + " corners");
    if (corners > 3 && triangles_only)
      return fail(ErrorCode::kUnsuitable, "face " + std::to_string(f) + " has " + std::to_string(corners) +
                                              " corners and " + format_name +
                                              " holds triangles only: triangulate the mesh first");
  }
  if (triangles_only && options.encoding == FileEncoding::kBinaryBigEndian)
    return fail(ErrorCode::kUsage, format_name + " has no big-endian form");
  return {};
}

Result<Notes> encode(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out) {
  Notes notes;
  switch (options.format) {
    case FileFormat::kPly:
      encode_ply(mesh, options, out, notes);
      break;
    case FileFormat::kObj:
      encode_obj(mesh, options, out, notes);
      break;
    case FileFormat::kOff:
      encode_off(mesh, options, out, notes);
      break;
    case FileFormat::kStl:
      encode_stl(mesh, options, out, notes);
      break;
    case FileFormat::kGltf:
      VKMESH_CHECK(encode_gltf(mesh, options, out, notes));
      break;
    case FileFormat::kInventor:
    case FileFormat::kVrml1:
    case FileFormat::kVrml2:
      encode_scene(mesh, options, out, notes);
      break;
  }
  VKMESH_CHECK(out.finish());
  return notes;
}

}  // namespace
}  // namespace detail

std::string name_of(FileFormat format) {
  for (const detail::KnownFormat& known : detail::kFormats)
    if (known.format == format) return known.name;
  return "unknown";
}

std::string name_of(FileEncoding encoding) {
  switch (encoding) {
    case FileEncoding::kAscii:
      return "ascii";
    case FileEncoding::kBinaryLittleEndian:
      return "binary_little_endian";
    case FileEncoding::kBinaryBigEndian:
      return "binary_big_endian";
  }
  return "unknown";
}

Result<MeshFile> read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  return detail::catching([&]() -> Result<MeshFile> {
    VKMESH_TRY(const detail::Content content, detail::read_content(path, options.progress));
    const std::string name = path == "-" ? "standard input" : path.string();
    const std::filesystem::path folder = path.parent_path();
    VKMESH_TRY(MeshFile file, detail::parse_content({content.bytes.view(), name, options.progress, 0.5,
                                                     path == "-" ? nullptr : &folder}));
    file.gzip = content.gzip;
    return file;
  });
}

Result<MeshFile> parse_mesh(std::span<const std::byte> bytes, const std::string& name,
                            const ReadOptions& options) {
  return detail::catching([&]() -> Result<MeshFile> {
    const std::string_view given(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!detail::is_gzip(given)) return detail::parse_content({given, name, options.progress, 0});
    VKMESH_TRY(const detail::ByteBuffer inflated, detail::inflate_bytes(given, name));
    VKMESH_TRY(MeshFile file, detail::parse_content({inflated.view(), name, options.progress, 0.5}));
    file.gzip = true;
    return file;
  });
}

Result<IndexedFaceSet> to_indexed_face_set(MeshFile file) {
  if (auto* mesh = std::get_if<IndexedFaceSet>(&file.geometry)) return std::move(*mesh);
  return weld(std::get<PolygonSoup>(file.geometry));
}

Result<WriteOptions> write_options_for(const std::filesystem::path& path) {
  return detail::catching([&]() -> Result<WriteOptions> {
    WriteOptions options;
    if (path == "-") return options;
    const detail::NameHint hint = detail::hint_of(path);
    const auto format = detail::format_named(hint.extension);
    if (!format) {
      std::string known;
      for (const detail::KnownFormat& f : detail::kFormats)
        known += std::string(known.empty() ? "" : ", ") + "." + f.name;
      return fail(ErrorCode::kUsage,
                  "the extension names no format that can be written (" + known + ", each also with .gz)",
                  {path.string(), {}, {}});
    }
    options.format = *format;
    options.gzip = hint.gzip;
    if (*format != FileFormat::kPly && *format != FileFormat::kStl && hint.extension != "glb")
      options.encoding = FileEncoding::kAscii;
    return options;
  });
}

Result<std::vector<std::string>> write_mesh(const std::filesystem::path& path, const IndexedFaceSet& mesh,
                                            const WriteOptions& options) {
  return detail::catching([&]() -> Result<std::vector<std::string>> {
    VKMESH_CHECK(detail::check_writable(mesh, options));
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(path));
    detail::Output out(file.file(), path == "-" ? "standard output" : path.string(), options.gzip);
    VKMESH_TRY(detail::Notes notes, detail::encode(mesh, options, out));
    VKMESH_CHECK(file.commit());
    return notes;
  });
}

Result<void> write_polylines(const std::filesystem::path& path, std::span<const Vec3> points,
                             std::span<const std::vector<std::uint32_t>> polylines) {
  return detail::catching([&]() -> Result<void> {
    std::vector<std::uint32_t> number(points.size(), 0);  // From 1, as OBJ counts.
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(path));
    detail::Output out(file.file(), path == "-" ? "standard output" : path.string(), false);
    std::uint32_t count = 0;
    for (const auto& polyline : polylines)
      for (const std::uint32_t v : polyline) {
        if (v >= points.size()) return fail(ErrorCode::kUsage, "a polyline names no point");
        if (number[v] != 0) continue;
        number[v] = ++count;
        char* to = out.room(256);
        *to++ = 'v';
        for (int axis = 0; axis < 3; ++axis) {
          *to++ = ' ';
          to = detail::put_number(to, points[v][axis]);
        }
        *to++ = '\n';
        out.commit(to);
      }
    for (const auto& polyline : polylines) {
      out.put("l");
      for (const std::uint32_t v : polyline) {
        char* to = out.room(32);
        *to++ = ' ';
        out.commit(detail::put_number(to, std::uint64_t{number[v]}));
      }
      out.put("\n");
    }
    VKMESH_CHECK(out.finish());
    return file.commit();
  });
}

Result<std::vector<std::byte>> encode_mesh(const IndexedFaceSet& mesh, const WriteOptions& options) {
  return detail::catching([&]() -> Result<std::vector<std::byte>> {
    VKMESH_CHECK(detail::check_writable(mesh, options));
    std::vector<std::byte> bytes;
    detail::Output out(bytes, options.gzip);
    VKMESH_CHECK(detail::encode(mesh, options, out));
    return bytes;
  });
}

}  // namespace vkmesh
