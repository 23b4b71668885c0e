// OFF, the Object File Format of Geomview (http://www.geomview.org/docs/html/OFF.html), in its text form.
#include <algorithm>
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

/// Values that stand behind others on a line, as many on each line as on the first.
struct LineTail {
  std::vector<float> values;
  unsigned components = 0;
  bool whole_numbers = true;

  void add(float value) {
    values.push_back(value);
    whole_numbers = whole_numbers && value == std::floor(value) && value >= 0 && value <= 255;
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
    VKMESH_CHECK(vertices());
    VKMESH_CHECK(faces());
    VKMESH_CHECK(rest());
    IndexedFaceSet& out = mesh();
    if (normals_) out.point_channels.push_back({"normal", 3, std::move(normal_values_)});
    if (colors_ && color_.components > 0)
      out.point_channels.push_back(
          color_channel(std::move(color_.values), color_.components, color_.whole_numbers));
    if (uvs_) out.point_channels.push_back({"uv", 2, std::move(uv_values_)});
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
    if (keyword.ends_with("OFF")) {
      keyword.remove_suffix(3);
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
      if (text_.word() == "BINARY") return source_.bad_line(line, "binary OFF files are not read");
      text_ = counts;
    } else {
      text_ = before;  // The keyword is optional.
    }
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
      for (int axis = 0; axis < 3; ++axis)
        if (!text_.number(points[i][axis]))
          return expected(std::string("coordinate ") + "xyz"[axis] + " of vertex " + std::to_string(i));
      if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y) || !std::isfinite(points[i].z))
        return source_.bad_line(line, "vertex " + std::to_string(i) + " has a coordinate that is not finite");
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
      file_.notes.push_back("numbers beyond what the header announces ignored on the lines of " +
                            std::to_string(beyond) + " vertices");
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
    std::size_t uncolored = 0;
    for (std::size_t f = 0; f < faces_; ++f) {
      if (Source::due(f)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_content();
      const char* line = text_.at();
      std::uint64_t count = 0;
      if (!text_.number(count)) return expected("the number of corners of face " + std::to_string(f));
      if (count < 3)
        return source_.bad_line(line,
                                "face " + std::to_string(f) + " has " + std::to_string(count) + " corners");
      for (std::uint64_t k = 0; k < count; ++k) {
        std::int64_t index = 0;
        if (!text_.number(index))
          return expected("corner " + std::to_string(k) + " of face " + std::to_string(f));
        if (index < 0 || static_cast<std::uint64_t>(index) >= points_)
          return source_.bad_line(line, "face " + std::to_string(f) + " names vertex " +
                                            std::to_string(index) + ", but there are " +
                                            std::to_string(points_) + " vertices, counted from 0");
        collector.corner(static_cast<std::uint32_t>(index));
      }
      if (!collector.end_face(count))
        return source_.bad_line(line, "the faces have more corners than 32-bit indices can number");
      if (text_.line_done()) {
        ++uncolored;
      } else {
        VKMESH_CHECK(face_color(f, color));
      }
    }
    if (color.components > 0 && uncolored == 0 && color.values.size() == faces_ * color.components)
      out.face_channels.push_back(
          color_channel(std::move(color.values), color.components, color.whole_numbers));
    else if (uncolored < faces_)
      file_.notes.push_back("colours of " + std::to_string(faces_ - uncolored) +
                            " faces ignored: not all faces have one of 3 or 4 components");
    return {};
  }

  /// Real files hold more than they promise; other programs read what is promised.
  Result<void> rest() {
    std::size_t lines = 0;
    for (text_.skip_to_content(); !text_.at_end(); text_.skip_to_content()) {
      if (Source::due(lines++)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_line_end();
    }
    if (lines > 0)
      file_.notes.push_back(std::to_string(lines) + " lines behind what the header promises ignored");
    return {};
  }

  /// Colours of one number are indices into a table that is not in the file; they are counted as ignored.
  Result<void> face_color(std::size_t f, LineTail& color) {
    const std::size_t before = color.values.size();
    for (float value = 0; !text_.line_done(); color.add(value))
      if (!text_.number(value)) return expected("the colour of face " + std::to_string(f));
    const std::size_t numbers = color.values.size() - before;
    const bool fits = numbers == 3 || numbers == 4;
    if (color.components == 0 && fits) color.components = static_cast<unsigned>(numbers);
    if (!fits || numbers != color.components) color.values.resize(before);
    return {};
  }

  const Source& source_;
  TextCursor text_;
  MeshFile file_;
  std::uint64_t points_ = 0, faces_ = 0;
  bool normals_ = false, colors_ = false, uvs_ = false;
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
      to = put_number(to, mesh.points[i][axis]);
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
