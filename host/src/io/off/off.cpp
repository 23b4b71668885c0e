// OFF, the Object File Format of Geomview (http://www.geomview.org/docs/html/OFF.html).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

/// Values that stand behind others on a line, as many on each line as on the first that has any.
struct LineTail {
  static constexpr float kNone = -1e30f;  ///< Stands for a value of a line that has none.

  std::vector<float> values;
  unsigned components = 0;
  bool whole_numbers = true;
  std::size_t before = 0;   ///< Lines before the first that has any.
  std::size_t indices = 0;  ///< Lines of another number of values.

  void set_components(std::size_t count) {
    components = static_cast<unsigned>(count);
    values.assign(before * count, kNone);
  }
  void add(float value) {
    values.push_back(value);
    whole_numbers = whole_numbers && value == std::floor(value) && value >= 0 && value <= 255;
  }
  void add_none() {
    if (components == 0)
      ++before;
    else
      values.insert(values.end(), components, kNone);
  }
  /// The colours of as many elements; those without one are white.
  Channel channel(std::size_t elements) {
    values.resize(elements * components, kNone);
    const float largest = values.empty() ? 0.0f : *std::max_element(values.begin(), values.end());
    std::replace(values.begin(), values.end(), kNone, largest > 1 ? 255.0f : 1.0f);
    return color_channel(std::move(values), components, whole_numbers);
  }
};

class OffReader {
 public:
  explicit OffReader(const Source& source) : source_(source), text_(source.bytes, '#') {
    file_.format = FileFormat::kOff;
    file_.geometry = IndexedFaceSet{};
  }

  Result<MeshFile> read() {
    VKMESH_CHECK(header());
    if (binary_) {
      VKMESH_CHECK(read_binary());
      return std::move(file_);
    }
    VKMESH_CHECK(vertices());
    IndexedFaceSet& out = mesh();
    if (normals_) out.point_channels.push_back({"normal", 3, std::move(normal_values_)});
    if (colors_ && color_.components > 0)
      out.point_channels.push_back(
          color_channel(std::move(color_.values), color_.components, color_.whole_numbers));
    if (uvs_) out.point_channels.push_back({"uv", 2, std::move(uv_values_)});
    VKMESH_CHECK(faces());
    VKMESH_CHECK(rest());
    return std::move(file_);
  }

 private:
  IndexedFaceSet& mesh() { return std::get<IndexedFaceSet>(file_.geometry); }

  tl::unexpected<Error> expected(const std::string& what) {
    text_.skip_blanks();
    return source_.bad_line(text_.at(), "expected " + what + ", found " + text_.found());
  }

  Result<void> header() {
    text_.skip_to_content();
    const char* line = text_.at();
    const TextCursor before = text_;
    std::string_view keyword = text_.word();
    if (const std::size_t length = off_keyword(keyword); length > 0) {
      text_ = TextCursor(source_.bytes.substr(static_cast<std::size_t>(line - source_.bytes.data()) + length),
                         '#');
      keyword = keyword.substr(0, length - 3);
      const auto prefix = [&](std::string_view letters) {
        if (!keyword.starts_with(letters)) return false;
        keyword.remove_prefix(letters.size());
        return true;
      };
      uvs_ = prefix("ST");
      colors_ = prefix("C");
      normals_ = prefix("N");
      // Written the other way round, too; the order of the numbers is the same.
      colors_ = colors_ || prefix("C");
      if (!keyword.empty()) return source_.bad_line(line, "only OFF files in three dimensions are read");
      text_.skip_to_content();
      const TextCursor counts = text_;
      binary_ = text_.word() == "BINARY";
      if (binary_) return {};
      text_ = counts;
    } else {
      text_ = before;  // The keyword is optional.
    }
    text_.skip_blanks();
    line = text_.at();
    if (!text_.number(points_)) return expected("the number of vertices");
    if (!text_.number(faces_)) return expected("the number of faces");
    std::uint64_t edges = 0;
    static_cast<void>(text_.number(edges));  // Often wrong, sometimes missing, never needed.
    if (!text_.line_done()) return expected("the end of the line");
    // A digit and what parts it from the next number; the last line may lack its end.
    const std::uint64_t left = text_.left() + 1;
    const std::uint64_t vertex_bytes = 6 + (normals_ ? 6 : 0) + (uvs_ ? 4 : 0), face_bytes = 2;
    if (points_ > left / vertex_bytes || faces_ > (left - points_ * vertex_bytes) / face_bytes)
      return source_.bad_line(line, "the header promises " + std::to_string(points_) + " vertices and " +
                                        std::to_string(faces_) + " faces, but only " +
                                        std::to_string(text_.left()) + " bytes are left for them");
    if (points_ > kMaxElements || faces_ > kMaxElements)
      return source_.bad_line(line, "the header promises more than 32-bit indices can number");
    return {};
  }

  /// The next four bytes of a binary file, which come in big-endian order.
  template <class T>
  bool take(const char*& at, T& value) const {
    static_assert(sizeof(T) == sizeof(std::uint32_t));
    const char* end = source_.bytes.data() + source_.bytes.size();
    if (static_cast<std::size_t>(end - at) < sizeof(T)) return false;
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) bits = bits << 8 | static_cast<unsigned char>(at[i]);
    value = std::bit_cast<T>(bits);
    at += sizeof(T);
    return true;
  }

  /// What stands behind "OFF BINARY": counts, vertices, faces, as whole numbers and floats of four bytes.
  Result<void> read_binary() {
    file_.encoding = FileEncoding::kBinaryBigEndian;
    text_.skip_to_line_end();
    text_.accept('\r');
    text_.accept('\n');
    const char* at = text_.at();
    const auto cut_short = [&] {
      return source_.bad_byte(at, "the file ends within what its header promises");
    };
    std::uint32_t points = 0, faces = 0, edges = 0;
    if (!take(at, points) || !take(at, faces) || !take(at, edges)) return cut_short();
    const std::uint64_t left = source_.bytes.size() - static_cast<std::size_t>(at - source_.bytes.data());
    const std::uint64_t floats = 3 + (normals_ ? 3u : 0u) + (colors_ ? 4u : 0u) + (uvs_ ? 2u : 0u);
    if (4 * floats * points + 8 * std::uint64_t{faces} > left)
      return source_.bad_byte(at, "the header promises " + std::to_string(points) + " vertices and " +
                                      std::to_string(faces) + " faces, but only " + std::to_string(left) +
                                      " bytes are left for them");
    IndexedFaceSet& out = mesh();
    out.points.resize(points);
    std::vector<float> row(floats), colors;
    for (std::size_t i = 0; i < points; ++i) {
      if (Source::due(i)) VKMESH_CHECK(source_.tick(at));
      const char* begin = at;
      for (float& value : row)
        if (!take(at, value)) return cut_short();
      out.points[i] = source_.positions->place(DVec3(row[0], row[1], row[2]));
      if (!all_finite(out.points[i])) not_finite_.add(i, begin);
      auto next = row.begin() + 3;
      const auto append = [&](std::ptrdiff_t count, std::vector<float>& to) {
        to.insert(to.end(), next, next + count);
        next += count;
      };
      if (normals_) append(3, normal_values_);
      if (colors_) append(4, colors);
      if (uvs_) append(2, uv_values_);
    }
    if (normals_) out.point_channels.push_back({"normal", 3, std::move(normal_values_)});
    if (colors_) out.point_channels.push_back({"color", 4, std::move(colors)});
    if (uvs_) out.point_channels.push_back({"uv", 2, std::move(uv_values_)});
    FaceCollector collector(out);
    std::size_t small_faces = 0;
    LineTail color;
    std::size_t uncolored = 0;
    for (std::size_t f = 0; f < faces; ++f) {
      if (Source::due(f)) VKMESH_CHECK(source_.tick(at));
      std::uint32_t count = 0, index = 0, components = 0;
      if (!take(at, count)) return cut_short();
      for (std::uint32_t k = 0; k < count; ++k) {
        const char* begin = at;
        if (!take(at, index)) return cut_short();
        if (index >= points)
          return source_.bad_byte(begin, "face " + std::to_string(f) + " names vertex " +
                                             std::to_string(index) + ", but there are " +
                                             std::to_string(points) + " vertices, counted from 0");
        collector.corner(index);
      }
      std::array<float, 4> values{};
      if (!take(at, components)) return cut_short();
      for (std::uint32_t k = 0; k < components; ++k)
        if (!take(at, values[std::min<std::uint32_t>(k, 3)])) return cut_short();
      const FaceCollector::Face kept = collector.end_face(count);
      if (kept == FaceCollector::Face::kTooMany)
        return source_.bad_byte(at, "the faces have more corners than 32-bit indices can number");
      small_faces += kept == FaceCollector::Face::kSkipped;
      if (kept == FaceCollector::Face::kKept) add_face_color(values, components, color, uncolored);
    }
    note_small_faces(file_.notes, small_faces);
    VKMESH_CHECK(not_finite_.drop(source_, true, out, file_.notes));
    keep_face_colors(color, uncolored);
    return {};
  }

  /// Colours of one number are indices into a table that is not in the file; those faces have none.
  template <std::size_t N>
  void add_face_color(const std::array<float, N>& values, std::size_t count, LineTail& color,
                      std::size_t& uncolored) {
    if (color.components == 0 && (count == 3 || count == 4)) color.set_components(count);
    if (count == 0 || count != color.components) {
      ++uncolored;
      color.indices += count > 0;
      color.add_none();
      return;
    }
    for (std::size_t k = 0; k < count; ++k) color.add(values[k]);
  }

  void keep_face_colors(LineTail& color, std::size_t uncolored) {
    if (color.components == 0) {
      if (color.indices > 0)
        file_.notes.push_back({"dropped.color", "colours of " + std::to_string(color.indices) +
                                                    " faces ignored: they number colours of a table"});
      return;
    }
    if (uncolored > 0)
      file_.notes.push_back({"partial.color", std::to_string(uncolored) + " faces without a colour of " +
                                                  std::to_string(color.components) +
                                                  " components made white"});
    mesh().face_channels.push_back(color.channel(mesh().face_count()));
  }

  Result<void> floats(std::size_t vertex, const char* what, int count, std::vector<float>& values) {
    for (int k = 0; k < count; ++k) {
      float value = 0;
      if (!text_.number(value)) return expected(std::string(what) + " of vertex " + std::to_string(vertex));
      values.push_back(value);
    }
    return {};
  }

  /// How many numbers follow on this line.
  unsigned count_numbers() {
    const TextCursor before = text_;
    unsigned count = 0;
    for (float value = 0; count < 16 && text_.number(value);) ++count;
    text_ = before;
    return count;
  }

  Result<void> vertices() {
    std::vector<Vec3>& points = mesh().points;
    points.resize(points_);
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < points_; ++i) {
      if (Source::due(i)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_content();
      const char* line = text_.at();
      DVec3 exact;
      for (int axis = 0; axis < 3; ++axis)
        if (!text_.coordinate(exact[axis]))
          return expected(std::string("coordinate ") + "xyz"[axis] + " of vertex " + std::to_string(i));
      points[i] = source_.positions->place(exact);
      if (!all_finite(points[i])) not_finite_.add(i, line);
      if (normals_) VKMESH_CHECK(floats(i, "the normal", 3, normal_values_));
      if (colors_) VKMESH_CHECK(vertex_color(i));
      if (uvs_) VKMESH_CHECK(floats(i, "the texture coordinates", 2, uv_values_));
      if (!text_.line_done()) {
        if (count_numbers() == 0) return expected("the end of the line");
        ++beyond;
        text_.skip_to_line_end();
      }
    }
    if (beyond > 0)
      file_.notes.push_back(
          {"skipped.numbers", "numbers beyond what the header announces ignored on the lines of " +
                                  std::to_string(beyond) + " vertices"});
    return {};
  }

  Result<void> vertex_color(std::size_t i) {
    if (i == 0) {
      const unsigned numbers = count_numbers(), others = uvs_ ? 2 : 0;
      if (numbers != 3 + others && numbers != 4 + others) return expected("a colour of 3 or 4 numbers");
      color_.components = numbers - others;
    }
    for (unsigned k = 0; k < color_.components; ++k) {
      float value = 0;
      if (!text_.number(value)) return expected("the colour of vertex " + std::to_string(i));
      color_.add(value);
    }
    return {};
  }

  Result<void> faces() {
    IndexedFaceSet& out = mesh();
    FaceCollector collector(out);
    out.corners.reserve(std::min<std::uint64_t>(3 * faces_, text_.left() / 2));
    LineTail color;
    std::size_t uncolored = 0, small_faces = 0;
    for (std::size_t f = 0; f < faces_; ++f) {
      if (Source::due(f)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_content();
      const char* line = text_.at();
      std::uint64_t count = 0;
      if (!text_.number(count)) return expected("the number of corners of face " + std::to_string(f));
      for (std::uint64_t k = 0; k < count; ++k) {
        std::int64_t index = 0;
        if (!text_.number(index)) {
          // Geomview's manual lets a face go on in the next line.
          if (text_.line_done() && broken_line_ == nullptr) broken_line_ = line;
          text_.skip_to_content();
          if (!text_.number(index))
            return source_.bad_line(line, "expected corner " + std::to_string(k) + " of face " +
                                              std::to_string(f) + ", found " + text_.found());
        }
        if (index < 0 || static_cast<std::uint64_t>(index) >= points_)
          return source_.bad_line(line, "face " + std::to_string(f) + " names vertex " +
                                            std::to_string(index) + ", but there are " +
                                            std::to_string(points_) + " vertices, counted from 0");
        collector.corner(static_cast<std::uint32_t>(index));
      }
      const FaceCollector::Face kept = collector.end_face(count);
      if (kept == FaceCollector::Face::kTooMany)
        return source_.bad_line(line, "the faces have more corners than 32-bit indices can number");
      if (kept == FaceCollector::Face::kSkipped) {
        ++small_faces;
        text_.skip_to_line_end();
      } else {
        VKMESH_CHECK(face_color(f, color, uncolored));
      }
    }
    // A face that lacks a number takes the next face's, and what follows does not come out: that is no face
    // over several lines.
    if (broken_line_ != nullptr && small_faces > 0)
      return source_.bad_line(broken_line_, "a face has fewer corners than its line promises");
    note_small_faces(file_.notes, small_faces);
    VKMESH_CHECK(not_finite_.drop(source_, false, out, file_.notes));
    keep_face_colors(color, uncolored);
    return {};
  }

  /// Real files hold more than they promise; other programs read what is promised.
  Result<void> rest() {
    std::size_t lines = 0;
    for (text_.skip_to_content(); !text_.at_end(); text_.skip_to_content()) {
      if (Source::due(lines++)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_line_end();
    }
    if (lines > 0 && broken_line_ != nullptr)
      return source_.bad_line(broken_line_, "a face has fewer corners than its line promises");
    if (lines > 0)
      file_.notes.push_back({"dropped.trailing_lines",
                             std::to_string(lines) + " lines behind what the header promises ignored"});
    return {};
  }

  Result<void> face_color(std::size_t f, LineTail& color, std::size_t& uncolored) {
    std::array<float, 5> values{};
    std::size_t numbers = 0;
    for (float value = 0; !text_.line_done(); ++numbers) {
      if (!text_.number(value)) return expected("the colour of face " + std::to_string(f));
      if (numbers < values.size()) values[numbers] = value;
    }
    add_face_color(values, numbers, color, uncolored);
    return {};
  }

  const Source& source_;
  TextCursor text_;
  MeshFile file_;
  std::uint64_t points_ = 0, faces_ = 0;
  bool normals_ = false, colors_ = false, uvs_ = false, binary_ = false;
  NonFinitePoints not_finite_;
  const char* broken_line_ = nullptr;  ///< The line of the first face that goes on in the next.
  std::vector<float> normal_values_, uv_values_;
  LineTail color_;
};

/// The channel of that name when OFF can hold it.
const Channel* holdable(const std::vector<Channel>& channels, const std::string& name) {
  const Channel* c = find_channel(channels, name);
  if (c == nullptr) return nullptr;
  const bool fits = name == "normal" ? c->components == 3
                    : name == "uv"   ? c->components == 2
                                     : c->components == 3 || c->components == 4;
  return fits ? c : nullptr;
}

/// The values of one element, each with a blank before it. 8-bit colours are whole numbers, other colours
/// fractions.
void put_values(Output& out, const Channel& channel, std::size_t i) {
  const bool color = channel.name == "color";
  const bool bytes = std::holds_alternative<std::vector<std::uint8_t>>(channel.values);
  for (unsigned k = 0; k < channel.components; ++k) {
    const std::size_t at = i * channel.components + k;
    char* to = out.room(64);
    *to++ = ' ';
    if (color && bytes)
      to = put_number(to, color_byte(channel, at));
    else
      to = put_number(to, color ? color_fraction(channel, at) : channel_float(channel, at));
    out.commit(to);
  }
}

}  // namespace

std::size_t off_keyword(std::string_view word) {
  const std::size_t at = word.find("OFF");
  if (at == std::string_view::npos || at > 4) return 0;
  const std::string_view rest = word.substr(at + 3);
  const bool digits = std::all_of(rest.begin(), rest.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits ? at + 3 : 0;
}

Result<MeshFile> parse_off(const Source& source) {
  return OffReader(source).read();
}

void encode_off(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  const Channel* normal = holdable(mesh.point_channels, "normal");
  const Channel* color = holdable(mesh.point_channels, "color");
  const Channel* uv = holdable(mesh.point_channels, "uv");
  const Channel* face_color = holdable(mesh.face_channels, "color");
  for (const Channel& c : mesh.point_channels)
    if (&c != normal && &c != color && &c != uv)
      note_left_out(notes, "point", c, "OFF holds normals, colours and uv");
  for (const Channel& c : mesh.face_channels)
    if (&c != face_color) note_left_out(notes, "face", c, "OFF holds colours of faces");
  for (const Channel& c : mesh.corner_channels)
    note_left_out(notes, "corner", c, "OFF has no attributes of corners");

  std::string header = std::string(uv != nullptr ? "ST" : "") + (color != nullptr ? "C" : "") +
                       (normal != nullptr ? "N" : "") + "OFF\n";
  header += std::to_string(mesh.points.size()) + " " + std::to_string(mesh.face_count()) + " 0\n";
  out.put(header);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    char* to = out.room(256);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) *to++ = ' ';
      to = put_coordinate(to, mesh.points[i][axis], options.offset[axis]);
    }
    out.commit(to);
    for (const Channel* c : {normal, color, uv})
      if (c != nullptr) put_values(out, *c, i);
    out.put("\n");
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(f);
    out.commit(put_number(out.room(64), corners.size()));
    for (const std::uint32_t c : corners) {
      char* to = out.room(64);
      *to++ = ' ';
      out.commit(put_number(to, c));
    }
    if (face_color != nullptr) put_values(out, *face_color, f);
    out.put("\n");
  }
  // At the end: some readers take nothing but the counts behind the first line.
  for (const std::string& line : comment_lines(options.comment)) out.put("# " + line + "\n");
}

}  // namespace vkmesh::detail
