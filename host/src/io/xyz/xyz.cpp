// XYZ point files: a point to a line, as three numbers, which a normal or a colour may follow; or two numbers
// where no heights are asked for. A line of names that begins with x and y may stand first. No standard
// describes them; these are the forms that scanners, CloudCompare and tables (CSV) have.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kMostNumbers = 10;

/// Numbers of a line may be parted by commas or semicolons, too.
bool skip_separator(TextCursor& text) {
  text.skip_blanks();
  if (text.accept(',') || text.accept(';')) text.skip_blanks();
  return !text.at_line_end();
}

/// The numbers of a line; none where it holds anything else, or more than any form has.
std::vector<double> numbers_of(TextCursor& text) {
  std::vector<double> numbers;
  do {
    double value = 0;
    if (!text.number_prefix(value) || numbers.size() == kMostNumbers) return {};
    numbers.push_back(value);
    if (text.at_line_end()) return numbers;
    const char next = *text.at();
    if (next != ' ' && next != '\t' && next != ',' && next != ';' && next != '#') return {};
  } while (skip_separator(text));
  return numbers;
}

/// Skips a first line of the names of columns, "x,y,z" or "//X Y Z R G B", which are not read further.
void skip_header(TextCursor& text) {
  text.skip_to_content();
  TextCursor line = text;
  const auto skip_quote = [&] { return line.accept('"') || line.accept('\''); };
  if (line.accept('/')) static_cast<void>(line.accept('/'));
  for (const char* name : {"xX", "yY"}) {
    line.skip_blanks();
    skip_quote();
    if (!line.accept(name[0]) && !line.accept(name[1])) return;
    skip_quote();
    const char* const end = line.at();
    if (!skip_separator(line)) {
      if (name[0] == 'x') return;
    } else if (line.at() == end) {
      return;
    }
  }
  text = line;
  text.skip_to_line_end();
}

bool are_unit_vectors(const std::vector<float>& values) {
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    if (!(std::abs(std::hypot(values[i], values[i + 1], values[i + 2]) - 1) < 0.01f)) return false;
  return true;
}

bool are_bytes(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](float v) { return v >= 0 && v <= 255 && v == std::floor(v); });
}

}  // namespace

bool is_xyz(std::string_view bytes) {
  TextCursor text(bytes, '#');
  skip_header(text);
  text.skip_to_content();
  return numbers_of(text).size() >= 2 && text.line_done();
}

Result<MeshFile> parse_xyz(const Source& source) {
  MeshFile file;
  file.format = FileFormat::kXyz;
  IndexedFaceSet mesh;
  NonFinitePoints not_finite;
  TextCursor text(source.bytes, '#');
  skip_header(text);
  const std::size_t least = source.planar ? 2 : 3;
  std::size_t width = 0;
  std::vector<float> columns;  // Those behind the position, `width - 3` for each point.
  for (std::size_t i = 0;; ++i) {
    if (Source::due(i)) VKMESH_CHECK(source.tick(text.at()));
    text.skip_to_content();
    if (text.at_end()) break;
    const char* line = text.at();
    const std::vector<double> numbers = numbers_of(text);
    if (i == 0) width = numbers.size();
    if (numbers.size() < least || numbers.size() != width || !text.line_done()) {
      std::string found = numbers.empty() ? TextCursor(std::string_view(line, text.left())).found()
                                          : std::to_string(numbers.size());
      if (numbers.size() == 2 && i == 0) found += ": points in the plane, which have no heights";
      return source.bad_line(
          line, "expected " + (width < least ? std::to_string(least) + " to 10" : std::to_string(width)) +
                    " numbers of a point, found " + found);
    }
    if (mesh.points.size() == kMaxElements)
      return source.bad_line(line, "there are more points than 32-bit indices can number");
    const Vec3 point = source.positions->place(DVec3(numbers[0], numbers[1], width > 2 ? numbers[2] : 0.0));
    if (!all_finite(point)) not_finite.add(i, line);
    mesh.points.push_back(point);
    for (std::size_t k = 3; k < width; ++k) columns.push_back(static_cast<float>(numbers[k]));
  }
  const std::size_t more = width < 3 ? 0 : width - 3;
  const auto triple = [&](std::size_t from) {
    std::vector<float> values;
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
      for (std::size_t k = from; k < from + 3; ++k) values.push_back(columns[i * more + k]);
    return values;
  };
  // Normals are unit vectors, colours bytes; columns that are neither have no meaning that is known.
  std::size_t read = 0;
  while (more - read >= 3) {
    std::vector<float> values = triple(read);
    const bool normals = are_unit_vectors(values);
    if (!normals && !are_bytes(values)) break;
    const char* name = normals ? "normal" : "color";
    if (find_channel(mesh.point_channels, name) != nullptr) break;
    mesh.point_channels.push_back(normals ? Channel{"normal", 3, std::move(values)}
                                          : color_channel(std::move(values), 3, true));
    read += 3;
  }
  if (read < more)
    file.notes.push_back({"dropped.columns", std::to_string(more - read) +
                                                 " columns that are neither normals nor colours ignored"});
  VKMESH_CHECK(not_finite.drop(source, false, mesh, file.notes));
  file.geometry = std::move(mesh);
  return file;
}

void encode_xyz(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  const auto fitting = [&](const char* name) -> const Channel* {
    const Channel* c = find_channel(mesh.point_channels, name);
    return c != nullptr && (c->components == 3 || (name[0] == 'c' && c->components == 4)) ? c : nullptr;
  };
  const Channel *normal = fitting("normal"), *color = fitting("color");
  if (normal != nullptr) {
    std::vector<float> values;
    for (std::size_t i = 0; i < normal->scalar_count(); ++i) values.push_back(channel_float(*normal, i));
    if (!are_unit_vectors(values)) normal = nullptr;  // They would not be known again.
  }
  for (const Channel& c : mesh.point_channels)
    if (&c != normal && &c != color) note_left_out(notes, "point", c, "XYZ holds unit normals and colours");
  if (color != nullptr &&
      (color->components == 4 || !std::holds_alternative<std::vector<std::uint8_t>>(color->values)))
    notes.push_back({"rounded.color", "point channel 'color' rounded to three times 8 bits"});
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    char* to = out.room(512);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) *to++ = ' ';
      to = put_coordinate(to, mesh.points[i][axis], options.offset[axis]);
    }
    for (std::size_t k = 0; normal != nullptr && k < 3; ++k) {
      *to++ = ' ';
      to = put_number(to, channel_float(*normal, 3 * i + k));
    }
    for (std::size_t k = 0; color != nullptr && k < 3; ++k) {
      *to++ = ' ';
      to = put_number(to, color_byte(*color, i * color->components + k));
    }
    *to++ = '\n';
    out.commit(to);
  }
}

}  // namespace vkmesh::detail
