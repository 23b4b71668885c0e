// Wavefront OBJ (Advanced Visualizer manual, appendix B1), its polygonal part.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <vkmesh/mesh/handles.h>

#include "base/distinct_rows.h"
#include "io/formats.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

// Known keywords whose statements may go on over several lines; those of others end with their line.
constexpr std::array<std::string_view, 24> kIgnored = {
    "p",    "l",    "vp", "deg", "bmat", "step",  "cstype", "curv",  "curv2", "surf", "parm", "trim",
    "hole", "scrv", "sp", "end", "con",  "bevel", "lod",    "ctech", "stech", "bzp",  "bsp",  "cdc"};

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// What `vt` or `vn` lines and the corners that name them give.
struct Attribute {
  const char* keyword = "";
  std::string channel;
  unsigned components = 0;
  std::vector<float> values;
  std::vector<std::uint32_t> of_corner;  ///< kInvalid, or nothing at the end, where a corner names none.
  std::size_t wrong = 0;                 ///< Corners that name one that there is not.

  [[nodiscard]] std::size_t count() const { return values.size() / components; }
};

/// The largest index so far, and where it stands: indices may precede what they name.
struct Highest {
  std::uint64_t index = 0;
  const char* at = nullptr;
};

/// Which of the names that `usemtl`, or `g` and `o`, gave is in force at each face.
class FaceLabels {
 public:
  /// The faces from number `face` on have this name. Faces before the first one have the empty name.
  void set(std::string_view name, std::size_t face) {
    if (!named_ && face > 0) {
      numbers_[{}] = 0;
      labels_.emplace_back();
      of_face_.assign(face, 0);
    }
    named_ = true;
    name_ = name;
    number_ = kInvalid;
  }
  void add_face() {
    if (!named_) return;
    if (number_ == kInvalid) {
      const auto [found, is_new] = numbers_.try_emplace(name_, static_cast<std::uint32_t>(labels_.size()));
      if (is_new) labels_.emplace_back(name_);
      number_ = found->second;
    }
    of_face_.push_back(number_);
  }
  /// A channel, when any face has a name.
  void keep(const char* channel, IndexedFaceSet& mesh) {
    if (labels_.empty() || (labels_.size() == 1 && labels_[0].empty())) return;
    mesh.face_channels.push_back({channel, 1, std::move(of_face_), std::move(labels_)});
  }

 private:
  bool named_ = false;
  std::string_view name_;
  std::uint32_t number_ = kInvalid;
  std::map<std::string_view, std::uint32_t> numbers_;
  std::vector<std::string> labels_;
  std::vector<std::uint32_t> of_face_;
};

class ObjReader {
 public:
  explicit ObjReader(const Source& source) : source_(source), text_(source.bytes, '#') {
    file_.format = FileFormat::kObj;
    file_.geometry = IndexedFaceSet{};
    uv_.keyword = "vt";
    uv_.channel = "uv";
    uv_.components = 2;
    normal_.keyword = "vn";
    normal_.channel = "normal";
    normal_.components = 3;
  }

  Result<MeshFile> read() {
    IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file_.geometry);
    FaceCollector collector(mesh);
    for (std::size_t line = 0;; ++line) {
      if (Source::due(line)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_content();
      if (text_.at_end()) break;
      const char* at = text_.at();
      const std::string_view keyword = text_.word();
      if (keyword == "v") {
        VKMESH_CHECK(vertex(at, mesh));
      } else if (keyword == "f" || keyword == "fo") {
        VKMESH_CHECK(face(at, mesh, collector));
      } else if (keyword == "vt") {
        VKMESH_CHECK(texture_coordinates());
      } else if (keyword == "vn") {
        for (int k = 0; k < 3; ++k) VKMESH_CHECK(value("a normal", normal_.values));
      } else if (keyword == "usemtl") {
        materials_.set(name(), faces_);
      } else if (keyword == "o") {
        objects_.set(name(), faces_);
      } else if (keyword == "g") {
        groups_.set(name(), faces_);
      } else if (keyword == "mtllib") {
        if (const std::string_view library = name(); !library.empty())
          file_.material_libraries.emplace_back(library);
      } else if (is_one_of(keyword, kIgnored)) {
        ++ignored_[keyword];
        skip_statement();
      } else {
        // Known or not: files of archives and of newer programs have more than the manual lists.
        const auto known = ignored_.find(keyword);
        if (known != ignored_.end())
          ++known->second;
        else if (ignored_.size() < kKeywords)
          ignored_[keyword] = 1;
        else
          ++other_keywords_;
        text_.skip_to_line_end();
      }
      skip_continuation();
      if (!text_.line_done()) return expected("the end of the line");
    }
    if (mesh.points.empty()) return source_.bad_line(text_.at(), "the file holds no vertex" + skipped());
    VKMESH_CHECK(finish(mesh));
    return std::move(file_);
  }

 private:
  static constexpr float kNoColor = -1e30f;     ///< Stands for the colour of a vertex that has none.
  static constexpr std::size_t kKeywords = 64;  ///< Ignored ones that are told by name.

  /// " (skipped: 3 'foo' lines)", so that a file refused as empty says what it held.
  std::string skipped() const {
    std::string text;
    std::size_t shown = 0;
    for (const auto& [keyword, count] : ignored_)
      if (shown++ < 3)
        text += (text.empty() ? " (skipped: " : ", ") + std::to_string(count) + " " +
                TextCursor(keyword).found() + (count == 1 ? " line" : " lines");
    return text.empty() ? text : text + (shown > 3 ? ", …)" : ")");
  }

  tl::unexpected<Error> expected(const std::string& what) {
    skip_continuation();
    return source_.bad_line(text_.at(), "expected " + what + ", found " + text_.found());
  }

  /// Blanks, and line ends that a backslash hides.
  void skip_continuation() {
    for (text_.skip_blanks(); !text_.at_end() && *text_.at() == '\\'; text_.skip_blanks()) {
      const TextCursor before = text_;
      text_.accept('\\');
      text_.skip_blanks();
      if (!text_.at_line_end() || text_.at_end()) {
        text_ = before;
        return;
      }
      text_.accept('\r');
      text_.accept('\n');
    }
  }

  /// The rest of the line, which may be several words; names may begin with #. A # alone begins a comment.
  std::string_view name() {
    TextCursor words(rest(text_.at()));
    words.skip_blanks();
    const char* from = words.at();
    const char* to = from;
    for (std::string_view word = words.word(); !word.empty() && word != "#"; word = words.word())
      to = words.at();
    text_.skip_to_line_end();
    return {from, static_cast<std::size_t>(to - from)};
  }

  void skip_statement() {
    for (;;) {
      skip_continuation();
      if (text_.at_line_end()) return;
      if (text_.word().ends_with('\\')) text_.skip_to_content();
    }
  }

  /// A number of this statement, which may stand on the next line.
  template <class T>
  bool number(T& to) {
    skip_continuation();
    return text_.number_prefix(to) && ends_number();
  }

  bool ends_number() const {
    if (text_.at_line_end()) return true;
    const char c = *text_.at();
    return c == ' ' || c == '\t' || c == '\\' || c == '\v' || c == '\f';
  }

  bool statement_done() {
    skip_continuation();
    return text_.line_done();
  }

  Result<void> value(const char* what, std::vector<float>& values) {
    float x = 0;
    if (!number(x)) return expected(std::string("a number of ") + what);
    values.push_back(x);
    return {};
  }

  Result<void> vertex(const char* at, IndexedFaceSet& mesh) {
    DVec3 exact;
    for (int axis = 0; axis < 3; ++axis)
      if (!number(exact[axis])) return expected(std::string("coordinate ") + "xyz"[axis]);
    const Vec3 point = source_.positions->place(exact);
    if (!all_finite(point)) not_finite_.add(mesh.points.size(), at);
    if (mesh.points.size() == kMaxElements)
      return source_.bad_line(at, "there are more vertices than 32-bit indices can number");
    mesh.points.push_back(point);
    if (statement_done()) return {};
    // x y z [w] or x y z red green blue [alpha], which is no part of the format but widely written.
    std::array<float, 4> more{};
    std::size_t count = 0;
    for (; count < more.size() && !statement_done(); ++count)
      if (!number(more[count])) return expected("a number");
    if (count == 3 || count == 4) {
      colors_.resize(3 * (mesh.points.size() - 1), kNoColor);
      ++colored_;
      for (std::size_t k = 0; k < 3; ++k) {
        colors_.push_back(more[k]);
        whole_colors_ = whole_colors_ && more[k] == std::floor(more[k]) && more[k] >= 0 && more[k] <= 255;
      }
      alphas_ += count == 4;
    } else {
      weights_ += more[0] != 1.0f;
    }
    return {};
  }

  Result<void> texture_coordinates() {
    VKMESH_CHECK(value("a texture coordinate", uv_.values));
    if (statement_done()) {
      uv_.values.push_back(0);
      return {};
    }
    VKMESH_CHECK(value("a texture coordinate", uv_.values));
    float third = 0;
    if (!statement_done()) {
      if (!number(third)) return expected("a number");
      thirds_ += third != 0;
    }
    return {};
  }

  /// An index as it stands in a face: from 1, or negative from the last one. False for anything else.
  bool index(std::uint64_t count, std::uint32_t& to, Highest& highest) {
    std::int64_t i = 0;
    const char* at = text_.at();
    if (!text_.number_prefix(i) || i == 0) return false;
    if (i < 0) {
      // Not -i: the smallest integer has no opposite.
      if (count < static_cast<std::uint64_t>(-(i + 1)) + 1) return false;
      i = static_cast<std::int64_t>(count) + i + 1;
    }
    const auto from_zero = static_cast<std::uint64_t>(i - 1);
    if (from_zero >= kMaxElements) return false;
    if (highest.at == nullptr || from_zero > highest.index) highest = {from_zero, at};
    to = static_cast<std::uint32_t>(from_zero);
    return true;
  }

  /// Sets the attribute of a corner. One that cannot be named (0, or before the first) costs it, not the
  /// face.
  Result<void> corner_attribute(Attribute& attribute, std::size_t corner) {
    std::int64_t i = 0;
    const char* at = text_.at();
    if (!text_.number_prefix(i))
      return source_.bad_line(at, std::string("expected the index of a '") + attribute.keyword +
                                      "' line, found " + TextCursor(rest(at)).found());
    if (i < 0)
      i = i < -static_cast<std::int64_t>(kMaxElements)
              ? 0
              : std::max<std::int64_t>(0, static_cast<std::int64_t>(attribute.count()) + i + 1);
    attribute.of_corner.resize(corner, kInvalid);
    if (i == 0 || i > static_cast<std::int64_t>(kMaxElements)) {
      ++attribute.wrong;
      attribute.of_corner.push_back(kInvalid);
    } else {
      attribute.of_corner.push_back(static_cast<std::uint32_t>(i - 1));
    }
    return {};
  }

  std::string_view rest(const char* at) const {
    return source_.bytes.substr(static_cast<std::size_t>(at - source_.bytes.data()));
  }

  Result<void> face(const char* line, IndexedFaceSet& mesh, FaceCollector& collector) {
    std::size_t count = 0;
    for (; !statement_done(); ++count) {
      std::uint32_t point = 0;
      const char* at = text_.at();
      if (!index(mesh.points.size(), point, highest_point_))
        return source_.bad_line(at, "expected the index of a vertex (of " +
                                        std::to_string(mesh.points.size()) + " so far), found " +
                                        TextCursor(rest(at)).found());
      const std::size_t corner = mesh.corners.size();
      collector.corner(point);
      if (text_.accept('/')) {
        const bool uv = !ends_number() && *text_.at() != '/';
        if (uv) VKMESH_CHECK(corner_attribute(uv_, corner));
        if (text_.accept('/') && !ends_number()) VKMESH_CHECK(corner_attribute(normal_, corner));
      }
      if (!ends_number())
        return source_.bad_line(at, "expected a corner, found " + TextCursor(rest(at)).found());
    }
    switch (collector.end_face(count)) {
      case FaceCollector::Face::kTooMany:
        return source_.bad_line(line, "the faces have more corners than 32-bit indices can number");
      case FaceCollector::Face::kSkipped:
        ++small_faces_;
        for (Attribute* attribute : {&uv_, &normal_})
          attribute->of_corner.resize(std::min(attribute->of_corner.size(), mesh.corners.size()));
        return {};
      case FaceCollector::Face::kKept:
        break;
    }
    ++faces_;
    materials_.add_face();
    objects_.add_face();
    groups_.add_face();
    return {};
  }

  Result<void> check(const Highest& highest, std::uint64_t count, const char* keyword) const {
    if (highest.at == nullptr || highest.index < count) return {};
    return source_.bad_line(highest.at, "a face names '" + std::string(keyword) + "' " +
                                            std::to_string(highest.index + 1) + ", but there are " +
                                            std::to_string(count));
  }

  Result<void> finish(IndexedFaceSet& mesh) {
    VKMESH_CHECK(check(highest_point_, mesh.points.size(), "v"));
    keep(uv_, mesh);
    keep(normal_, mesh);
    if (!colors_.empty()) {
      if (colored_ < mesh.points.size())
        file_.notes.push_back({"partial.color", std::to_string(mesh.points.size() - colored_) +
                                                    " vertices without a colour made white"});
      colors_.resize(3 * mesh.points.size(), kNoColor);
      const float largest = *std::max_element(colors_.begin(), colors_.end());
      std::replace(colors_.begin(), colors_.end(), kNoColor, largest > 1 ? 255.0f : 1.0f);
      mesh.point_channels.push_back(color_channel(std::move(colors_), 3, whole_colors_));
    }
    VKMESH_CHECK(not_finite_.drop(source_, false, mesh, file_.notes));
    materials_.keep("material", mesh);
    objects_.keep("object", mesh);
    groups_.keep("group", mesh);
    const auto note = [&](std::size_t count, const char* code, const std::string& what) {
      if (count > 0) file_.notes.push_back({code, std::to_string(count) + " " + what + " ignored"});
    };
    note_small_faces(file_.notes, small_faces_);
    note(weights_, "dropped.weights", "vertex weights");
    note(alphas_, "dropped.opacities", "vertex opacities");
    note(thirds_, "dropped.uvw", "third texture coordinates");
    for (const auto& [keyword, count] : ignored_)
      note(count, "skipped.keyword", TextCursor(keyword).found() + " lines");
    note(other_keywords_, "skipped.keyword", "lines of other keywords");
    return {};
  }

  /// Attributes of corners become a channel: of points when point i has the i-th in all its corners, else of
  /// corners. Corners that name none get 0.
  void keep(Attribute& attribute, IndexedFaceSet& mesh) {
    const std::string lines = std::string("'") + attribute.keyword + "' lines";
    if (attribute.of_corner.empty()) {
      // A cloud has as many as vertices, in their order.
      if (mesh.corners.empty() && attribute.count() > 0 && attribute.count() == mesh.points.size())
        mesh.point_channels.push_back({attribute.channel, attribute.components, std::move(attribute.values)});
      else if (attribute.count() > 0)
        file_.notes.push_back(
            {"dropped.unused_" + attribute.channel,
             std::to_string(attribute.count()) + " " + lines + " ignored: no corner of a face names one"});
      return;
    }
    attribute.of_corner.resize(mesh.corners.size(), kInvalid);
    std::size_t without = 0;
    for (std::uint32_t& i : attribute.of_corner) {
      if (i != kInvalid && i >= attribute.count()) {
        i = kInvalid;
        ++attribute.wrong;
      }
      without += i == kInvalid;
    }
    if (attribute.wrong > 0)
      file_.notes.push_back(
          {"skipped." + attribute.channel + "_index",
           std::to_string(attribute.wrong) + " corners name " + lines + " that there are not"});
    if (without == attribute.of_corner.size()) return;
    if (without > 0)
      file_.notes.push_back({"partial." + attribute.channel,
                             std::to_string(without) + " corners without '" + attribute.channel + "' got 0"});
    if (attribute.count() == mesh.points.size() && attribute.of_corner == mesh.corners) {
      mesh.point_channels.push_back({attribute.channel, attribute.components, std::move(attribute.values)});
      return;
    }
    std::vector<float> values;
    values.reserve(attribute.of_corner.size() * attribute.components);
    for (const std::size_t i : attribute.of_corner)
      for (unsigned k = 0; k < attribute.components; ++k)
        values.push_back(i == kInvalid ? 0.0f : attribute.values[i * attribute.components + k]);
    mesh.corner_channels.push_back({attribute.channel, attribute.components, std::move(values)});
  }

  const Source& source_;
  TextCursor text_;
  MeshFile file_;
  Attribute uv_, normal_;
  Highest highest_point_;
  NonFinitePoints not_finite_;
  FaceLabels materials_, objects_, groups_;
  std::size_t faces_ = 0, small_faces_ = 0;
  std::vector<float> colors_;  ///< One for each vertex up to the last that has one.
  std::size_t colored_ = 0;
  bool whole_colors_ = true;
  std::size_t weights_ = 0, alphas_ = 0, thirds_ = 0;
  std::map<std::string_view, std::size_t> ignored_;
  std::size_t other_keywords_ = 0;
};

/// The names of faces, for the writer.
class OutLabels {
 public:
  OutLabels(const char* keyword, const char* name, const IndexedFaceSet& mesh) : keyword_(keyword) {
    const Channel* found = find_channel(mesh.face_channels, name);
    if (found == nullptr || found->components != 1) return;
    bool fits = !found->labels.empty() && std::all_of(found->labels.begin(), found->labels.end(), is_name);
    for (std::size_t f = 0; fits && f < mesh.face_count(); ++f)
      fits = number(*found, f) < found->labels.size();
    if (fits) channel_ = found;
  }

  [[nodiscard]] const Channel* channel() const { return channel_; }

  /// A line where face f has another name than the one before it.
  void put(std::size_t f, Output& out) {
    if (channel_ == nullptr) return;
    const std::string& label = channel_->labels[number(*channel_, f)];
    if (label == current_) return;
    current_ = label;
    out.put(std::string(keyword_) + (label.empty() ? "" : " ") + std::string(label) + "\n");
  }

 private:
  /// What a line can hold and a reader gets back.
  static bool is_name(const std::string& label) {
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    // A # alone begins a comment, a \ goes on in the next line.
    return std::none_of(label.begin(), label.end(),
                        [](char c) { return c == '\\' || (c >= 0 && c < ' ' && c != '\t'); }) &&
           (" " + label + " ").find(" # ") == std::string::npos &&
           (label.empty() || (!blank(label.front()) && !blank(label.back())));
  }

  /// Beyond every label for what is none.
  static std::uint64_t number(const Channel& channel, std::size_t f) {
    return std::visit(
        [&](const auto& v) {
          using T = typename std::decay_t<decltype(v)>::value_type;
          constexpr std::uint64_t kNone = ~std::uint64_t{0};
          if constexpr (std::is_integral_v<T>)
            return v[f] < 0 ? kNone : static_cast<std::uint64_t>(v[f]);
          else
            return kNone;
        },
        channel.values);
  }

  const char* keyword_;
  const Channel* channel_ = nullptr;
  std::string_view current_;
};

template <std::size_t N>
using Rows = std::vector<std::array<float, N>>;

/// Where the `vt` or `vn` of each corner comes from, for the writer.
template <std::size_t N>
struct ObjAttribute {
  const char* keyword;
  const Channel* of_points = nullptr;
  const Channel* of_corners = nullptr;
  std::vector<std::uint32_t> row_of_corner;  ///< For a corner channel; equal rows are written once.

  ObjAttribute(const char* key, const char* channel, const IndexedFaceSet& mesh) : keyword(key) {
    const auto fitting = [&](const std::vector<Channel>& channels) -> const Channel* {
      const Channel* c = find_channel(channels, channel);
      return c != nullptr && c->components == N ? c : nullptr;
    };
    of_corners = fitting(mesh.corner_channels);
    if (of_corners == nullptr) of_points = fitting(mesh.point_channels);
  }

  [[nodiscard]] bool any() const { return of_points != nullptr || of_corners != nullptr; }

  void put_rows(const IndexedFaceSet& mesh, Output& out) {
    const auto row_at = [](const Channel& c, std::size_t i) {
      std::array<float, N> row;
      for (std::size_t k = 0; k < N; ++k) row[k] = channel_float(c, i * N + k);
      return row;
    };
    const auto put = [&](const std::array<float, N>& row) {
      out.put(keyword);
      for (const float x : row) {
        char* to = out.room(64);
        *to++ = ' ';
        out.commit(put_number(to, x));
      }
      out.put("\n");
    };
    if (of_points != nullptr)
      for (std::size_t i = 0; i < mesh.points.size(); ++i) put(row_at(*of_points, i));
    if (of_corners == nullptr) return;
    DistinctRows<N> distinct;
    Rows<N> rows;
    for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
      const std::array<float, N> row = row_at(*of_corners, c);
      row_of_corner.push_back(distinct.number(row.data(), rows));
    }
    for (const std::array<float, N>& row : rows) put(row);
  }

  [[nodiscard]] std::uint64_t number_of(const IndexedFaceSet& mesh, std::size_t corner) const {
    return std::uint64_t{of_corners != nullptr ? row_of_corner[corner] : mesh.corners[corner]} + 1;
  }
};

}  // namespace

Result<MeshFile> parse_obj(const Source& source) {
  return ObjReader(source).read();
}

void encode_obj(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  ObjAttribute<2> uv("vt", "uv", mesh);
  ObjAttribute<3> normal("vn", "normal", mesh);
  const Channel* color = find_channel(mesh.point_channels, "color");
  if (color != nullptr && color->components != 3 && color->components != 4) color = nullptr;
  if (color != nullptr && color->components == 4)
    notes.push_back({"dropped.opacities", "vertex opacities left out: OBJ holds none"});
  for (const Channel& c : mesh.point_channels)
    if (&c != uv.of_points && &c != normal.of_points && &c != color)
      note_left_out(notes, "point", c, "OBJ holds normals, uv and colours");
  for (const Channel& c : mesh.corner_channels)
    if (&c != uv.of_corners && &c != normal.of_corners)
      note_left_out(notes, "corner", c, "OBJ holds normals and uv of corners");
  OutLabels material("usemtl", "material", mesh), object("o", "object", mesh), group("g", "group", mesh);
  for (const Channel& c : mesh.face_channels)
    if (&c != material.channel() && &c != object.channel() && &c != group.channel())
      note_left_out(notes, "face", c, "OBJ holds names of materials, objects and groups of faces");

  for (const std::string& line : comment_lines(options.comment)) out.put("# " + line + "\n");
  for (const std::string& library : options.material_libraries) out.put("mtllib " + library + "\n");
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    char* to = out.room(256);
    *to++ = 'v';
    for (int axis = 0; axis < 3; ++axis) {
      *to++ = ' ';
      to = put_coordinate(to, mesh.points[i][axis], options.offset[axis]);
    }
    for (unsigned k = 0; color != nullptr && k < 3; ++k) {
      *to++ = ' ';
      to = put_number(to, color_fraction(*color, i * color->components + k));
    }
    *to++ = '\n';
    out.commit(to);
  }
  uv.put_rows(mesh, out);
  normal.put_rows(mesh, out);
  for (std::size_t f = 0, corner = 0; f < mesh.face_count(); ++f) {
    object.put(f, out);
    group.put(f, out);
    material.put(f, out);
    out.put("f");
    for (const std::uint32_t c : mesh.face(f)) {
      char* to = out.room(128);
      *to++ = ' ';
      to = put_number(to, std::uint64_t{c} + 1);
      if (uv.any() || normal.any()) *to++ = '/';
      if (uv.any()) to = put_number(to, uv.number_of(mesh, corner));
      if (normal.any()) {
        *to++ = '/';
        to = put_number(to, normal.number_of(mesh, corner));
      }
      out.commit(to);
      ++corner;
    }
    out.put("\n");
  }
}

}  // namespace vkmesh::detail
