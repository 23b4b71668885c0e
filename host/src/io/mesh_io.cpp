#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
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
  if (!has_lines) return bad_byte(at, std::move(message));
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
  Channel channel{"color", components, std::move(values)};
  if (!bytes) {
    to_canonical_color(channel);
    return channel;
  }
  std::vector<std::uint8_t> rounded;
  rounded.reserve(channel.scalar_count());
  for (const float v : std::get<std::vector<float>>(channel.values))
    rounded.push_back(static_cast<std::uint8_t>(v));
  channel.values = std::move(rounded);
  return channel;
}

bool to_canonical_color(Channel& channel) {
  return std::visit(
      [&](const auto& given) {
        using T = typename std::decay_t<decltype(given)>::value_type;
        if constexpr (std::is_same_v<T, std::uint8_t>) {
          return false;
        } else {
          double largest = 0;
          for (const T v : given)
            if (std::isfinite(static_cast<double>(v))) largest = std::max(largest, static_cast<double>(v));
          if constexpr (std::is_integral_v<T>) {
            if (sizeof(T) > 1 && largest <= 255) {
              std::vector<std::uint8_t> bytes;
              bytes.reserve(given.size());
              for (const T v : given) bytes.push_back(static_cast<std::uint8_t>(v < 0 ? T{0} : v));
              channel.values = std::move(bytes);
              return true;
            }
          } else if (largest <= 1) {
            return false;
          }
          const double one = std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::max())
                             : largest <= 255      ? 255.0
                                                   : 65535.0;
          std::vector<float> fractions;
          fractions.reserve(given.size());
          for (const T v : given) fractions.push_back(static_cast<float>(static_cast<double>(v) / one));
          channel.values = std::move(fractions);
          return true;
        }
      },
      channel.values);
}

void Positions::add(const Positions& other) {
  bounds_ += other.bounds_;
  error_ = std::max(error_, other.error_);
}

double Positions::size() const {
  const DVec3 extent = bounds_.extent();
  return std::hypot(extent.x, extent.y, extent.z);
}

DVec3 Positions::better_offset() const {
  const double size = this->size();
  DVec3 offset(0.0);
  // Also false where there is no point, and where the size is not finite.
  if (!(size > 0 && size < HUGE_VAL) || error_ <= std::ldexp(size, -21)) return offset;
  const double grid = std::ldexp(1.0, std::ilogb(size) + 1);
  for (int axis = 0; axis < 3; ++axis) {
    const double middle = bounds_.low[axis] + (bounds_.high[axis] - bounds_.low[axis]) / 2;
    if (std::abs(middle) > 4 * size) offset[axis] = std::round(middle / grid) * grid;
  }
  return offset;
}

void Positions::add_notes(Notes& notes) const {
  const auto text = [](double x) {
    char digits[32];
    return std::string(digits, put_number(digits, x));
  };
  if (offset_ != DVec3(0.0))
    notes.push_back({"offset.positions", "positions are kept relative to (" + text(offset_.x) + ", " +
                                             text(offset_.y) + ", " + text(offset_.z) + ")"});
  if (error_ > std::ldexp(size(), -22) && size() > 0)
    notes.push_back(
        {"rounded.positions", "positions rounded to single precision, by at most " + text(error_)});
}

void note_small_faces(Notes& notes, std::size_t count) {
  if (count > 0)
    notes.push_back({"skipped.small_faces", std::to_string(count) + (count == 1 ? " face" : " faces") +
                                                " of fewer than three corners skipped"});
}

Result<void> NonFinitePoints::drop(const Source& source, bool binary, IndexedFaceSet& mesh, Notes& notes) {
  if (points_.empty()) return {};
  std::sort(points_.begin(), points_.end());
  std::vector<bool> used(mesh.points.size());
  for (const std::uint32_t c : mesh.corners) used[c] = true;
  for (const auto& [point, at] : points_)
    if (used[point]) {
      std::string message = "vertex " + std::to_string(point) + " has a coordinate that is not finite";
      return binary ? source.bad_byte(at, std::move(message)) : source.bad_line(at, std::move(message));
    }
  std::vector<std::uint32_t> kept, number(mesh.points.size());
  kept.reserve(mesh.points.size() - points_.size());
  auto next = points_.begin();
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    number[i] = static_cast<std::uint32_t>(kept.size());
    if (next != points_.end() && next->first == i)
      ++next;
    else
      kept.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t k = 0; k < kept.size(); ++k) mesh.points[k] = mesh.points[kept[k]];
  mesh.points.resize(kept.size());
  mesh.point_channels = gather(mesh.point_channels, kept);
  for (std::uint32_t& c : mesh.corners) c = number[c];
  notes.push_back({"dropped.nonfinite_points",
                   std::to_string(points_.size()) +
                       (points_.size() == 1 ? " point that is not finite and that no face uses dropped"
                                            : " points that are not finite and that no face uses dropped")});
  return {};
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
  notes.push_back({"dropped." + channel.name,
                   std::string(element) + " channel '" + channel.name + "' left out: " + reason});
}

void note_labels_left_out(Notes& notes, const char* element, const Channel& channel) {
  notes.push_back({"dropped.labels", "names that the numbers of " + std::string(element) + " channel '" +
                                         channel.name + "' stand for left out"});
}

char* put_coordinate(char* to, float value, double offset) {
  if (offset == 0) return put_number(to, value);
  const double exact = static_cast<double>(value) + offset;
  for (int digits = 1; digits <= 17; ++digits) {
    char* const end = std::to_chars(to, to + 64, exact, std::chars_format::general, digits).ptr;
    double back = 0;
    std::from_chars(to, end, back);
    if (static_cast<float>(back - offset) == value) return end;
  }
  return put_number(to, exact);
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
    {FileFormat::kVrml2, "wrl"},   {FileFormat::kVrml2, "vrml"},  {FileFormat::kXyz, "xyz"}};

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
  if ((line.starts_with("#Inventor V2.") || line.starts_with("#Inventor V1.")) &&
      line.find("ascii") != std::string_view::npos)
    return parse_inventor(source, FileFormat::kInventor);
  if (line.starts_with("#VRML V1.0 ascii")) return parse_inventor(source, FileFormat::kVrml1);
  if (line.starts_with("#VRML V2.0 utf8")) return parse_vrml2(source);
  if (line.starts_with("#Inventor V2.1 binary") || line.starts_with("#Inventor V2.0 binary"))
    return parse_binary_inventor(source);
  return source.bad_line(line.data(),
                         "only Inventor in ascii and (V2.0 and V2.1) binary, VRML 1.0 in ascii and VRML 2.0 "
                         "in utf8 are read");
}

}  // namespace

Result<MeshFile> parse_format(const Source& source) {
  const std::string_view bytes = source.bytes;
  if (bytes.empty()) return fail(ErrorCode::kUnreadable, "the file is empty", {source.name, {}, {}});
  // The magic number of PLY, Inventor and VRML is their first line; a binary STL file of the right size is
  // one whatever its header says.
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || bytes.starts_with("ply "))
    return parse_ply(source);
  if (bytes.starts_with("#Inventor ") || bytes.starts_with("#VRML ")) return parse_scene_file(source);
  if (stl_binary_size(bytes) == bytes.size()) return parse_stl_binary(source);
  if (is_gltf(bytes)) return parse_gltf(source);

  TextCursor text(bytes, '#');
  text.skip_to_content();
  const std::string_view word = text.word();
  const bool has_zeros = bytes.substr(0, 512).find('\0') != std::string_view::npos;
  if (off_keyword(word) > 0) return parse_off(source);
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
  if (named == FileFormat::kXyz || (!has_zeros && is_xyz(bytes))) return parse_xyz(source);
  return fail(ErrorCode::kUnreadable, "the content is none of PLY, OBJ, OFF, STL, glTF, Inventor, VRML, XYZ",
              {source.name, {}, {}});
}

namespace {

/// Tells of values that are not finite in the attributes with a meaning, which no renderer can use.
void note_not_finite(const std::vector<Channel>& channels, const char* elements, Notes& notes) {
  for (const Channel& channel : channels) {
    if (channel.name != "normal" && channel.name != "uv" && channel.name != "color") continue;
    const std::size_t count = std::visit(
        [](const auto& values) {
          std::size_t found = 0;
          for (const auto v : values) found += !std::isfinite(static_cast<double>(v));
          return found;
        },
        channel.values);
    if (count > 0)
      notes.push_back({"nonfinite." + channel.name, std::to_string(count) + " values of '" + channel.name +
                                                        "' of " + elements + " are not finite"});
  }
}

/// What holds for every format: canonical colours, and notes on values that are not finite.
void finish_channels(MeshFile& file) {
  const auto finish = [&](std::vector<Channel>& channels, const char* elements) {
    for (Channel& channel : channels)
      if (channel.name == "color") to_canonical_color(channel);
    note_not_finite(channels, elements, file.notes);
  };
  if (auto* mesh = std::get_if<IndexedFaceSet>(&file.geometry)) {
    finish(mesh->point_channels, "points");
    finish(mesh->corner_channels, "corners");
    finish(mesh->face_channels, "faces");
  } else {
    finish(std::get<PolygonSoup>(file.geometry).face_channels, "faces");
  }
}

bool has_points(const MeshFile& file) {
  const auto* mesh = std::get_if<IndexedFaceSet>(&file.geometry);
  return mesh != nullptr ? !mesh->points.empty() : !std::get<PolygonSoup>(file.geometry).corners.empty();
}

/// What the notes say of content that is not in the mesh.
std::string passed_over(const std::vector<FileNote>& notes) {
  std::string text;
  for (const FileNote& note : notes)
    if (note.is_loss()) text += (text.empty() ? " (" : "; ") + note.sentence;
  return text.empty() ? text : text + ")";
}

Result<MeshFile> parse_content(Source source, const ReadOptions& options) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (source.bytes.starts_with(kByteOrderMark)) source.bytes.remove_prefix(kByteOrderMark.size());
  source.offset = options.offset;
  source.planar = options.planar;
  int inlines = 0;
  source.inlines = &inlines;
  Positions positions(source.offset);
  source.positions = &positions;
  source.level = options.level;
  VKMESH_TRY(MeshFile file, parse_format(source));
  if (!has_points(file))
    return fail(ErrorCode::kUnreadable, "the file holds no points" + passed_over(file.notes),
                {source.name, {}, {}});
  if (options.find_offset && options.offset == DVec3(0.0)) {
    // Far from the origin, which few meshes are: they are read a second time, relative to a point near them.
    const DVec3 offset = positions.better_offset();
    if (offset != DVec3(0.0)) {
      source.offset = offset;
      positions = Positions(offset);
      VKMESH_TRY(file, parse_format(source));
    }
  }
  file.offset = source.offset;
  finish_channels(file);
  positions.add_notes(file.notes);
  return file;
}

/// Refuses what no encoder could write: channels of the wrong size, indices and offsets that point nowhere.
Result<void> check_writable(const IndexedFaceSet& mesh, const WriteOptions& options) {
  if (mesh.points.empty())
    return fail(ErrorCode::kUnsuitable,
                "a mesh without points is not written: no reader would take the file");
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
  if (options.format == FileFormat::kStl && mesh.face_count() == 0 && !mesh.points.empty())
    return fail(ErrorCode::kUnsuitable,
                "STL holds triangles only: it cannot hold a point cloud, as PLY, OBJ, OFF and XYZ can");
  if (options.format == FileFormat::kXyz && mesh.face_count() > 0)
    return fail(ErrorCode::kUnsuitable, "XYZ holds points only, and the mesh has faces");
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

/// Whether encoders take the channel as it is: canonical colours; normals, uv and colours that are finite.
bool is_encodable(const Channel& channel) {
  if (channel.name != "normal" && channel.name != "uv" && channel.name != "color") return true;
  return std::visit(
      [&](const auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_integral_v<T>)
          return channel.name != "color" || std::is_same_v<T, std::uint8_t>;
        else
          return std::all_of(values.begin(), values.end(),
                             [&](T v) { return std::isfinite(v) && (channel.name != "color" || v <= 1); });
      },
      channel.values);
}

void make_encodable(std::vector<Channel>& channels, const char* element, Notes& notes) {
  for (Channel& channel : channels) {
    if (is_encodable(channel)) continue;
    if (channel.name == "color") to_canonical_color(channel);
    std::size_t count = 0;
    std::visit(
        [&](auto& values) {
          for (auto& value : values)
            if (!std::isfinite(static_cast<double>(value))) {
              value = 0;
              ++count;
            }
        },
        channel.values);
    if (count > 0)
      notes.push_back({"replaced." + channel.name, std::to_string(count) + " values of " + element +
                                                       " channel '" + channel.name +
                                                       "' that are not finite written as 0"});
  }
}

bool is_encodable(const IndexedFaceSet& mesh) {
  const auto encodable = [](const std::vector<Channel>& channels) {
    return std::all_of(channels.begin(), channels.end(), [](const Channel& c) { return is_encodable(c); });
  };
  return encodable(mesh.point_channels) && encodable(mesh.corner_channels) && encodable(mesh.face_channels);
}

void make_encodable(IndexedFaceSet& mesh, Notes& notes) {
  make_encodable(mesh.point_channels, "point", notes);
  make_encodable(mesh.corner_channels, "corner", notes);
  make_encodable(mesh.face_channels, "face", notes);
}

Result<Notes> encode(const IndexedFaceSet& given, const WriteOptions& options, Output& out) {
  Notes notes;
  IndexedFaceSet changed;
  const bool as_it_is = is_encodable(given);
  if (!as_it_is) {
    changed = given;
    make_encodable(changed, notes);
  }
  const IndexedFaceSet& mesh = as_it_is ? given : changed;
  if (options.format != FileFormat::kObj && !options.material_libraries.empty())
    notes.push_back({"dropped.material_libraries", std::to_string(options.material_libraries.size()) +
                                                       " names of material libraries left out: " +
                                                       name_of(options.format) + " holds none"});
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
    case FileFormat::kXyz:
      encode_xyz(mesh, options, out, notes);
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

bool FileNote::is_loss() const {
  return !code.starts_with("repaired.") && !code.starts_with("offset.");
}

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
                                                     path == "-" ? nullptr : &folder},
                                                    options));
    file.gzip = content.gzip;
    return file;
  });
}

Result<MeshFile> parse_mesh(std::span<const std::byte> bytes, const std::string& name,
                            const ReadOptions& options) {
  return detail::catching([&]() -> Result<MeshFile> {
    const std::string_view given(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!detail::is_gzip(given)) return detail::parse_content({given, name, options.progress, 0}, options);
    VKMESH_TRY(const detail::ByteBuffer inflated, detail::inflate_bytes(given, name));
    VKMESH_TRY(MeshFile file, detail::parse_content({inflated.view(), name, options.progress, 0.5}, options));
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

Result<std::vector<FileNote>> write_mesh(const std::filesystem::path& path, const IndexedFaceSet& mesh,
                                         const WriteOptions& options) {
  return detail::catching([&]() -> Result<std::vector<FileNote>> {
    VKMESH_CHECK(detail::check_writable(mesh, options));
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(path));
    detail::Output out(file.file(), path == "-" ? "standard output" : path.string(), options.gzip);
    VKMESH_TRY(detail::Notes notes, detail::encode(mesh, options, out));
    VKMESH_CHECK(file.commit());
    return notes;
  });
}

Result<std::vector<FileNote>> losses_of(const IndexedFaceSet& mesh, const WriteOptions& options) {
  return detail::catching([&]() -> Result<std::vector<FileNote>> {
    VKMESH_CHECK(detail::check_writable(mesh, options));
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open("/dev/null"));
    detail::Output out(file.file(), "/dev/null", false);
    return detail::encode(mesh, options, out);
  });
}

Result<std::vector<FileNote>> write_levels(const std::filesystem::path& path,
                                           std::span<const IndexedFaceSet> levels,
                                           const LevelWriteOptions& level_options,
                                           const WriteOptions& options) {
  return detail::catching([&]() -> Result<std::vector<FileNote>> {
    if (options.format != FileFormat::kGltf)
      return fail(ErrorCode::kUsage, "only glTF holds several levels of detail in one file");
    if (levels.empty()) return fail(ErrorCode::kUsage, "there are no levels of detail to write");
    if (!level_options.screen_coverage.empty() && level_options.screen_coverage.size() != levels.size())
      return fail(ErrorCode::kUsage, "screen coverage is one for each level of detail, or not given");
    detail::Notes notes;
    std::vector<IndexedFaceSet> changed;
    for (const IndexedFaceSet& level : levels) {
      VKMESH_CHECK(detail::check_writable(level, options));
      if (changed.empty() && !detail::is_encodable(level)) changed.assign(levels.begin(), levels.end());
    }
    for (IndexedFaceSet& level : changed) detail::make_encodable(level, notes);
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(path));
    detail::Output out(file.file(), path == "-" ? "standard output" : path.string(), options.gzip);
    VKMESH_CHECK(
        detail::encode_gltf_levels(changed.empty() ? levels : changed, level_options, options, out, notes));
    VKMESH_CHECK(out.finish());
    VKMESH_CHECK(file.commit());
    return notes;
  });
}

Result<std::vector<FileNote>> write_meshes(std::span<const std::filesystem::path> paths,
                                           std::span<const IndexedFaceSet> meshes,
                                           const WriteOptions& options) {
  return detail::catching([&]() -> Result<std::vector<FileNote>> {
    if (paths.size() != meshes.size()) return fail(ErrorCode::kUsage, "there is not one path for each mesh");
    std::vector<FileNote> all;
    std::vector<detail::OutputFile> files;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      VKMESH_CHECK(detail::check_writable(meshes[i], options));
      VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(paths[i]));
      detail::Output out(file.file(), paths[i].string(), options.gzip);
      VKMESH_TRY(const detail::Notes notes, detail::encode(meshes[i], options, out));
      for (const FileNote& note : notes)
        if (std::ranges::find(all, note) == all.end()) all.push_back(note);
      files.push_back(std::move(file));
    }
    for (detail::OutputFile& file : files) VKMESH_CHECK(file.commit());
    return all;
  });
}

Result<void> write_polylines(const std::filesystem::path& path, std::span<const Vec3> points,
                             std::span<const std::vector<std::uint32_t>> polylines, const DVec3& offset) {
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
          to = detail::put_coordinate(to, points[v][axis], offset[axis]);
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
