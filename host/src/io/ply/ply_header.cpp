// The header of PLY files.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "io/ply/ply.h"
#include "io/text.h"

namespace vkmesh::detail::ply {
namespace {

class HeaderReader {
 public:
  explicit HeaderReader(const Source& source) : source_(source), text_(source.bytes) {}

  Result<Header> read() {
    text_.word();  // "ply", which detection has seen.
    if (!text_.line_done()) return unexpected("the end of the line");
    const bool carriage_return = text_.accept('\r');
    const bool line_feed = text_.accept('\n');
    bool format_seen = false;
    for (;;) {
      text_.skip_to_content();
      const char* line = text_.at();
      const std::string_view keyword = text_.word();
      if (keyword.empty()) return source_.bad_line(line, "the header ends without 'end_header'");
      if (keyword == "comment" || keyword == "obj_info") {
        text_.skip_to_line_end();
      } else if (keyword == "format") {
        if (format_seen) return source_.bad_line(line, "the header gives its format twice");
        format_seen = true;
        VKMESH_CHECK(format());
      } else if (keyword == "element") {
        VKMESH_CHECK(element(line));
      } else if (keyword == "property") {
        VKMESH_CHECK(property(line));
      } else if (keyword == "end_header") {
        if (!text_.line_done()) return unexpected("the end of the line");
        break;
      } else {
        return source_.bad_line(line, "the header holds an unknown keyword, " + quoted(keyword));
      }
      if (!text_.line_done()) return unexpected("the end of the line");
    }
    if (!format_seen) return source_.bad_line(text_.at(), "the header gives no format");
    // The body begins after one line end: what follows it may be data. Only a file whose first line ends with
    // a carriage return alone has line ends of that kind.
    const bool here = text_.accept('\r');
    if (!(here && carriage_return && !line_feed)) text_.accept('\n');
    header_.body = text_.at();
    return std::move(header_);
  }

 private:
  tl::unexpected<Error> unexpected(const std::string& wanted) {
    text_.skip_blanks();
    return source_.bad_line(text_.at(), "expected " + wanted + ", found " + text_.found());
  }

  static std::string quoted(std::string_view word) { return TextCursor(word).found(); }

  Result<void> format() {
    const char* at = text_.at();
    const std::string_view name = text_.word();
    if (name == "ascii")
      header_.encoding = FileEncoding::kAscii;
    else if (name == "binary_little_endian")
      header_.encoding = FileEncoding::kBinaryLittleEndian;
    else if (name == "binary_big_endian")
      header_.encoding = FileEncoding::kBinaryBigEndian;
    else
      return source_.bad_line(
          at, "the format is none of ascii, binary_little_endian, binary_big_endian: " + quoted(name));
    if (text_.word() != "1.0") return source_.bad_line(at, "the version of the format is not 1.0");
    return {};
  }

  Result<std::string> name(const char* line) {
    const std::string_view word = text_.word();
    const bool printable = std::none_of(word.begin(), word.end(), [](char c) {
      return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7f;
    });
    if (word.empty() || !printable) return source_.bad_line(line, "a name is missing or not printable");
    return std::string(word);
  }

  Result<void> element(const char* line) {
    Element e;
    e.at = line;
    VKMESH_TRY(e.name, name(line));
    if (header_.find(e.name) != nullptr)
      return source_.bad_line(line, "element '" + e.name + "' is declared twice");
    if (!text_.number(e.count))
      return source_.bad_line(line, "expected the count of element '" + e.name + "', found " + text_.found());
    header_.elements.push_back(std::move(e));
    return {};
  }

  Result<Scalar> scalar(const char* line) {
    const std::string_view word = text_.word();
    if (const auto type = scalar_of(word)) return *type;
    return source_.bad_line(line, "unknown scalar type " + quoted(word));
  }

  Result<void> property(const char* line) {
    if (header_.elements.empty()) return source_.bad_line(line, "a property precedes every element");
    Element& owner = header_.elements.back();
    Property p;
    const TextCursor before = text_;
    p.list = text_.word() == "list";
    if (p.list) {
      VKMESH_TRY(p.count_type, scalar(line));
      if (!is_integer(p.count_type)) return source_.bad_line(line, "the count of a list is no integer type");
    } else {
      text_ = before;
    }
    VKMESH_TRY(p.type, scalar(line));
    VKMESH_TRY(p.name, name(line));
    if (owner.find(p.name) != nullptr)
      return source_.bad_line(line, "property '" + p.name + "' is declared twice");
    owner.properties.push_back(std::move(p));
    return {};
  }

  const Source& source_;
  TextCursor text_;
  Header header_;
};

}  // namespace

Result<Header> read_header(const Source& source) {
  return HeaderReader(source).read();
}

}  // namespace vkmesh::detail::ply
