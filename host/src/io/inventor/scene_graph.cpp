#include "io/inventor/scene_graph.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "io/text.h"

namespace vkmesh::detail {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == ',' || c == '\v' || c == '\f';
}

bool ends_word(char c) {
  return is_blank(c) || c == '{' || c == '}' || c == '[' || c == ']' || c == '"' || c == '#';
}

bool begins_number(char c) {
  return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
}

/// Walks over the text of a scene. Commas are blanks, comments run from # to the end of the line.
class SceneScanner {
 public:
  explicit SceneScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  [[nodiscard]] const char* at() const { return at_; }
  [[nodiscard]] bool at_end() const { return at_ == end_; }
  [[nodiscard]] std::string_view rest() const { return {at_, static_cast<std::size_t>(end_ - at_)}; }

  void skip() {
    while (at_ != end_) {
      if (is_blank(*at_)) {
        ++at_;
      } else if (*at_ == '#') {
        while (at_ != end_ && *at_ != '\n' && *at_ != '\r') ++at_;
      } else {
        return;
      }
    }
  }

  /// What the next content begins with; 0 at the end.
  char peek() {
    skip();
    return at_ == end_ ? '\0' : *at_;
  }

  bool accept(char c) {
    if (peek() != c || at_ == end_) return false;
    ++at_;
    return true;
  }

  /// The next word or number; empty where a bracket, a quote or the end stands.
  std::string_view word() {
    skip();
    const char* from = at_;
    while (at_ != end_ && !ends_word(*at_)) ++at_;
    return {from, static_cast<std::size_t>(at_ - from)};
  }

  /// Over a quoted string that begins here. False where it does not end.
  bool skip_string() {
    for (++at_; at_ != end_; ++at_) {
      if (*at_ == '"') {
        ++at_;
        return true;
      }
      if (*at_ == '\\' && at_ + 1 != end_) ++at_;
    }
    return false;
  }

  /// To behind the next `c`. False where there is none.
  bool skip_past(char c) {
    while (at_ != end_)
      if (*at_++ == c) return true;
    return false;
  }

  /// From behind an opening bracket to behind the one that closes it. False where none does.
  bool skip_nested(char open, char close) {
    for (std::size_t depth = 1; peek() != '\0' || !at_end();) {
      if (*at_ == '"') {
        if (!skip_string()) return false;
        continue;
      }
      if (*at_ == open) ++depth;
      if (*at_++ == close && --depth == 0) return true;
    }
    return false;
  }

  /// A number, which must end where a word ends.
  template <class T>
  bool number(T& value) {
    skip();
    TextCursor text(rest());
    if (!text.number_prefix(value) || (!text.at_end() && !ends_word(*text.at()))) return false;
    at_ = text.at();
    return true;
  }

 private:
  const char* at_;
  const char* end_;
};

/// A name as a message shows it.
std::string shown(std::string_view name) {
  return TextCursor(name).found();
}

class SceneParser {
 public:
  SceneParser(const Source& source, std::span<const KnownNode> known,
              std::span<const std::string_view> fields, IgnoredNodes& ignored)
      : source_(source), scan_(source.bytes), known_(known), fields_(fields), ignored_(ignored) {}

  Result<SceneGraph> read() {
    graph_.nodes.emplace_back();
    while (scan_.peek() != '\0' || !scan_.at_end()) {
      VKMESH_CHECK(statement(nullptr, graph_.roots, 0));
    }
    return std::move(graph_);
  }

  void add_to(Notes& notes) const {
    const auto note = [&](std::size_t count, const char* what) {
      if (count > 0) notes.push_back(std::to_string(count) + " " + what + " ignored");
    };
    note(prototypes_, "PROTO definitions");
    note(routes_, "ROUTE statements");
    note(undefined_, "uses of names that no node before them has");
  }

 private:
  tl::unexpected<Error> expected(const std::string& what) {
    scan_.skip();
    return source_.bad_line(scan_.at(), "expected " + what + ", found " + TextCursor(scan_.rest()).found());
  }

  /// A node, a field of `node` (which is null where no field may stand), or what is neither. `depth` counts
  /// the nodes around it.
  Result<void> statement(SceneNode* node, std::vector<std::uint32_t>& nodes, std::size_t depth) {
    if (Source::due(statements_++)) VKMESH_CHECK(source_.tick(source_.bytes.data()));
    const SceneScanner before = scan_;
    const std::string_view word = scan_.word();
    if (word.empty()) return expected("the name of a node or field");
    if (word == "~") return {};
    if (word == "ROUTE") {
      ++routes_;
      for (int part = 0; part < 3; ++part)
        if (scan_.word().empty()) return expected("a ROUTE from a field TO a field");
      return {};
    }
    if (word == "PROTO" || word == "EXTERNPROTO") return prototype(word);
    const bool is_node = word == "DEF" || word == "USE" || scan_.peek() == '{';
    if (is_node) {
      scan_ = before;
      VKMESH_TRY(const std::uint32_t child, read_node(depth));
      nodes.push_back(child);
      return {};
    }
    if (node == nullptr) return expected("'{' after " + shown(word));
    return field(word, *node, depth);
  }

  Result<void> prototype(std::string_view keyword) {
    ++prototypes_;
    const char* at = scan_.at();
    static_cast<void>(scan_.word());
    if (!scan_.accept('[') || !scan_.skip_nested('[', ']')) return expected("'[' and ']' after PROTO");
    if (keyword == "PROTO") {
      if (!scan_.accept('{') || !scan_.skip_nested('{', '}'))
        return source_.bad_line(at, "a PROTO has no body that ends");
      return {};
    }
    if (scan_.peek() == '"' ? scan_.skip_string() : scan_.accept('[') && scan_.skip_nested('[', ']'))
      return {};
    return expected("the addresses of an EXTERNPROTO");
  }

  /// [DEF name] Type { ... } or USE name.
  Result<std::uint32_t> read_node(std::size_t depth) {
    std::string_view word = scan_.word();
    if (word == "USE") {
      const std::string_view name = scan_.word();
      if (name.empty()) return expected("a name after USE");
      const auto found = defined_.find(name);
      if (found != defined_.end()) return found->second;
      ++undefined_;
      return kIgnored;
    }
    std::string_view name;
    if (word == "DEF") {
      name = scan_.word();
      if (name.empty()) return expected("a name after DEF");
      word = scan_.word();
    }
    if (word.empty()) return expected("the type of a node");
    if (!scan_.accept('{')) return expected("'{' after " + shown(word));
    VKMESH_TRY(const std::uint32_t node, read_body(word, depth));
    // Known only from here on: a node within cannot use it.
    if (!name.empty()) defined_[name] = node;
    return node;
  }

  Result<std::uint32_t> read_body(std::string_view type, std::size_t depth) {
    const auto known =
        std::find_if(known_.begin(), known_.end(), [&](const KnownNode& k) { return k.name == type; });
    const auto endless = [&] {
      return source_.bad_line(type.data(), "the node " + shown(type) + " does not end");
    };
    if (known == known_.end()) {
      ignored_.add(type);
      if (!scan_.skip_nested('{', '}')) return endless();
      return kIgnored;
    }
    if (depth >= kMaxSceneDepth)
      return source_.bad_line(type.data(),
                              "nodes stand in more than " + std::to_string(kMaxSceneDepth) + " others");
    SceneNode node;
    node.kind = known->kind;
    node.type = type;
    while (!scan_.accept('}')) {
      if (scan_.at_end()) return endless();
      VKMESH_CHECK(statement(&node, node.children, depth + 1));
    }
    if (graph_.nodes.size() >= kMaxElements) return source_.bad_line(type.data(), "there are too many nodes");
    graph_.nodes.push_back(std::move(node));
    return static_cast<std::uint32_t>(graph_.nodes.size() - 1);
  }

  Result<void> field(std::string_view name, SceneNode& node, std::size_t depth) {
    SceneField value;
    value.name = name;
    VKMESH_CHECK(read_value(value, depth));
    // A connection: "= USE node.field".
    const SceneScanner before = scan_;
    if (scan_.word() == "=") {
      if (scan_.word() == "USE") static_cast<void>(scan_.word());
    } else {
      scan_ = before;
    }
    if (std::find(fields_.begin(), fields_.end(), name) == fields_.end()) return {};
    for (SceneField& other : node.fields)
      if (other.name == name) {
        other = std::move(value);
        return {};
      }
    node.fields.push_back(std::move(value));
    return {};
  }

  static std::string_view between(const char* from, const char* to) {
    return {from, static_cast<std::size_t>(to - from)};
  }

  Result<void> read_value(SceneField& to, std::size_t depth) {
    const char first = scan_.peek();
    const char* from = scan_.at();
    if (begins_number(first)) {
      // How many belong to it only its type says; no name begins like a number.
      const char* end = from;
      while (begins_number(scan_.peek())) {
        static_cast<void>(scan_.word());
        end = scan_.at();
      }
      to.text = between(from, end);
      return {};
    }
    if (first == '"') {
      if (!scan_.skip_string()) return source_.bad_line(from, "a string does not end");
      return {};
    }
    if (first == '(') {
      if (!scan_.skip_past(')')) return source_.bad_line(from, "a list in parentheses does not end");
      to.text = between(from + 1, scan_.at() - 1);
      return {};
    }
    if (scan_.accept('[')) {
      if (begins_node()) {
        while (!scan_.accept(']')) {
          if (scan_.at_end()) return source_.bad_line(from, "a list of nodes does not end");
          VKMESH_CHECK(statement(nullptr, to.nodes, depth));
        }
        return {};
      }
      if (!scan_.skip_nested('[', ']')) return source_.bad_line(from, "a list does not end");
      to.text = between(from + 1, scan_.at() - 1);
      return {};
    }
    if (begins_node()) {
      VKMESH_TRY(const std::uint32_t child, read_node(depth));
      to.nodes.push_back(child);
      return {};
    }
    to.text = scan_.word();
    if (to.text.empty()) return expected("the value of the field " + shown(to.name));
    return {};
  }

  bool begins_node() {
    SceneScanner ahead = scan_;
    if (begins_number(ahead.peek())) return false;
    const std::string_view word = ahead.word();
    return !word.empty() &&
           (word == "DEF" || word == "USE" || word == "PROTO" || word == "ROUTE" || ahead.peek() == '{');
  }

  static constexpr std::uint32_t kIgnored = 0;

  const Source& source_;
  SceneScanner scan_;
  std::span<const KnownNode> known_;
  std::span<const std::string_view> fields_;
  IgnoredNodes& ignored_;
  SceneGraph graph_;
  std::map<std::string_view, std::uint32_t> defined_;
  std::size_t statements_ = 0, prototypes_ = 0, routes_ = 0, undefined_ = 0;
};

}  // namespace

const SceneField* SceneNode::field(std::string_view name) const {
  for (const SceneField& f : fields)
    if (f.name == name) return &f;
  return nullptr;
}

std::string_view SceneNode::word(std::string_view name, std::string_view otherwise) const {
  const SceneField* f = field(name);
  return f == nullptr || f->text.empty() ? otherwise : f->text;
}

void IgnoredNodes::add(std::string_view type) {
  constexpr std::size_t kNames = 64;
  const auto found = counts_.find(type);
  if (found != counts_.end())
    ++found->second;
  else if (counts_.size() < kNames)
    counts_[type] = 1;
  else
    ++others_;
}

void IgnoredNodes::add_to(Notes& notes) const {
  for (const auto& [type, count] : counts_)
    notes.push_back(std::to_string(count) + " " + shown(type) + " nodes ignored");
  if (others_ > 0) notes.push_back(std::to_string(others_) + " nodes of other types ignored");
}

Result<SceneGraph> parse_scene(const Source& source, std::span<const KnownNode> known,
                               std::span<const std::string_view> fields, IgnoredNodes& ignored,
                               Notes& notes) {
  SceneParser parser(source, known, fields, ignored);
  VKMESH_TRY(SceneGraph graph, parser.read());
  parser.add_to(notes);
  return graph;
}

const char* SceneNumbers::place_of(std::string_view text, std::size_t i) {
  SceneScanner scan(text);
  for (std::size_t k = 0; k < i; ++k) static_cast<void>(scan.word());
  scan.skip();
  return scan.at();
}

Result<void> SceneNumbers::tick(const char* at) {
  farthest_ = std::max(farthest_, at);
  return source_.tick(farthest_);
}

/// Calls read(scanner) until the text ends; false from it is an error.
template <class Read>
Result<void> SceneNumbers::each(std::string_view text, const char* what, Read&& read) {
  SceneScanner scan(text);
  for (std::size_t i = 0;; ++i) {
    if (Source::due(i)) VKMESH_CHECK(tick(scan.at()));
    scan.skip();
    if (scan.at_end()) return {};
    if (!read(scan))
      return source_.bad_line(scan.at(),
                              std::string("expected ") + what + ", found " + TextCursor(scan.rest()).found());
  }
}

Result<const SceneFloats*> SceneNumbers::floats(const SceneField* field, unsigned width) {
  if (field == nullptr) return nullptr;
  const auto [found, is_new] = floats_.try_emplace(field->text.data());
  SceneFloats& array = found->second;
  if (is_new) {
    array.text = field->text;
    VKMESH_CHECK(each(field->text, "a number", [&](SceneScanner& scan) {
      const SceneScanner before = scan;
      float value = 0;
      if (!scan.number(value) || !std::isfinite(value)) {
        scan = before;
        return false;
      }
      array.values.push_back(value);
      return true;
    }));
  }
  if (array.values.size() % width != 0)
    return source_.bad_line(field->name.data(), "the field " + shown(field->name) + " holds " +
                                                    std::to_string(array.values.size()) +
                                                    " numbers, which are not rows of " +
                                                    std::to_string(width));
  return &array;
}

Result<const SceneIndices*> SceneNumbers::indices(const SceneField* field) {
  if (field == nullptr) return nullptr;
  const auto [found, is_new] = indices_.try_emplace(field->text.data());
  SceneIndices& array = found->second;
  if (is_new) {
    array.text = field->text;
    VKMESH_CHECK(each(field->text, "a whole number", [&](SceneScanner& scan) {
      std::int32_t value = 0;
      if (!scan.number(value)) return false;
      array.values.push_back(value);
      return true;
    }));
  }
  if (array.values.empty() || (array.values.size() == 1 && array.values[0] == -1)) return nullptr;
  return &array;
}

Result<const SceneFloats*> SceneNumbers::packed_colors(const SceneField* field) {
  if (field == nullptr) return nullptr;
  const auto [found, is_new] = colors_.try_emplace(field->text.data());
  SceneFloats& array = found->second;
  if (is_new) {
    array.text = field->text;
    VKMESH_CHECK(each(field->text, "a colour as one number", [&](SceneScanner& scan) {
      const SceneScanner before = scan;
      std::string_view word = scan.word();
      const bool hex = word.starts_with("0x") || word.starts_with("0X");
      if (hex) word.remove_prefix(2);
      std::uint32_t value = 0;
      const auto [to, code] = std::from_chars(word.data(), word.data() + word.size(), value, hex ? 16 : 10);
      if (word.empty() || code != std::errc{} || to != word.data() + word.size()) {
        scan = before;
        return false;
      }
      for (int shift = 24; shift >= 0; shift -= 8)
        array.values.push_back(static_cast<float>((value >> shift) & 0xff) / 255.0f);
      return true;
    }));
  }
  return &array;
}

Result<void> SceneNumbers::values(const SceneField* field, std::span<double> to) {
  if (field == nullptr) return {};
  VKMESH_TRY(const SceneFloats* array, floats(field, 1));
  if (array->values.size() != to.size())
    return source_.bad_line(field->name.data(), "the field " + shown(field->name) + " holds " +
                                                    std::to_string(array->values.size()) +
                                                    " numbers instead of " + std::to_string(to.size()));
  std::copy(array->values.begin(), array->values.end(), to.begin());
  return {};
}

Result<void> SceneNumbers::whole_number(const SceneField* field, std::int64_t& to) {
  if (field == nullptr) return {};
  SceneScanner scan(field->text);
  std::int64_t value = 0;
  if (!scan.number(value))
    return source_.bad_line(field->name.data(), "the field " + shown(field->name) + " is no whole number");
  to = value;
  return {};
}

}  // namespace vkmesh::detail
