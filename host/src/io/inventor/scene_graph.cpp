#include "io/inventor/scene_graph.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "io/inventor/scene_scanner.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

bool begins_number(char c) {
  return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
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
    if (expanded_ > 0)
      notes.push_back({"repaired.prototype", std::to_string(expanded_) + " instances of PROTOs expanded"});
    note_ignored(notes, prototypes_, "dropped.externproto", "EXTERNPROTO definitions");
    note_ignored(notes, routes_, "dropped.route", "ROUTE statements");
    note_ignored(notes, connections_, "dropped.connection", "connections of fields");
    note_ignored(notes, undefined_, "skipped.use", "uses of names that no node before them has");
  }

 private:
  /// PROTO: a node type that a file makes out of others.
  struct Prototype {
    std::vector<SceneField> fields;
    SceneScanner body;
    std::size_t length = 0;  ///< The length of the body.
    std::string_view name;
    Prototype* outer = nullptr;  ///< The one defined before it where it was defined, as all that are visible.
    bool is_open = false;        ///< An instance of it is being expanded.
  };

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
    if (word == "PROTO") return prototype(depth);
    if (word == "EXTERNPROTO") return external_prototype();
    // Events of a PROTO's body that go to its interface.
    if (given_ != nullptr && node != nullptr && is_event_mapping()) return {};
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

  Result<void> external_prototype() {
    ++prototypes_;
    static_cast<void>(scan_.word());
    if (!scan_.accept('[') || !scan_.skip_nested('[', ']')) return expected("'[' and ']' after EXTERNPROTO");
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
      return kIgnoredNode;
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
      VKMESH_TRY(Prototype* const prototype, prototype_named(type));
      if (prototype != nullptr) return expand(*prototype, type, depth);
      ignored_.add(type);
      VKMESH_TRY(const bool ends, skip_ignored(depth));
      if (!ends) return endless();
      return kIgnoredNode;
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

  /// Over the body of a node of no known type; what it gives a name to, others may use. False where the body
  /// does not end.
  Result<bool> skip_ignored(std::size_t depth) {
    if (depth >= kMaxSceneDepth) return scan_.skip_nested('{', '}');
    for (std::size_t open = 1; open > 0;) {
      const char c = scan_.peek();
      if (c == '\0' && scan_.at_end()) return false;
      const SceneScanner before = scan_;
      if (c == '"') {
        if (!scan_.skip_string()) return false;
      } else if (scan_.accept('{')) {
        ++open;
      } else if (scan_.accept('}')) {
        --open;
      } else if (const std::string_view word = scan_.word(); word.empty()) {
        scan_.skip_one();
      } else if (word == "DEF") {
        scan_ = before;
        const auto node = read_node(depth + 1);
        if (node) continue;
        if (node.error().code != ErrorCode::kUnreadable) return tl::unexpected<Error>(node.error());
        // Nothing of the kind: what is left of this body is passed over as it is.
        scan_ = before;
        for (; open > 0; --open)
          if (!scan_.skip_nested('{', '}')) return false;
      }
    }
    return true;
  }

  /// [ field Type name value ... ] of a PROTO: the values that its instances need not give.
  Result<std::vector<SceneField>> interface(std::size_t depth) {
    std::vector<SceneField> fields;
    while (!scan_.accept(']')) {
      const std::string_view access = scan_.word();
      const std::string_view type = scan_.word();
      SceneField value;
      value.name = scan_.word();
      if (access.empty() || type.empty() || value.name.empty()) return expected("a field of a PROTO");
      if (access != "field" && access != "exposedField") continue;
      VKMESH_CHECK(read_value(value, depth + 1));
      fields.push_back(std::move(value));
    }
    return fields;
  }

  Result<void> prototype(std::size_t depth) {
    const char* at = scan_.at();
    const std::string_view name = scan_.word();
    if (name.empty() || !scan_.accept('[')) return expected("'[' after PROTO and its name");
    if (depth >= kMaxSceneDepth)
      return source_.bad_line(at, "nodes stand in more than " + std::to_string(kMaxSceneDepth) + " others");
    Prototype made{{}, scan_, 0, name, innermost_};
    VKMESH_TRY(made.fields, interface(depth));
    if (!scan_.accept('{')) return expected("'{' after the interface of a PROTO");
    made.body = scan_;
    if (!scan_.skip_nested('{', '}')) return source_.bad_line(at, "a PROTO has no body that ends");
    made.length = static_cast<std::size_t>(scan_.at() - made.body.at());
    innermost_ = &defined_prototypes_.emplace_back(std::move(made));
    return {};
  }

  /// The PROTO of that name that is visible here, or nullptr. One within the body of another hides those
  /// around it, and ends with it.
  Result<Prototype*> prototype_named(std::string_view name) {
    for (Prototype* found = innermost_; found != nullptr; found = found->outer) {
      VKMESH_CHECK(spend(1, name));
      if (found->name == name) return found;
    }
    return nullptr;
  }

  Result<void> spend(std::size_t steps, std::string_view at) {
    if (steps > expansion_)
      return source_.bad_line(at.data(),
                              "the instances of PROTOs make a scene out of proportion to the file");
    expansion_ -= steps;
    return {};
  }

  /// An instance of a PROTO, whose body begins here: the first node of the PROTO's body, in which the fields
  /// that the instance gives stand where the body says IS.
  Result<std::uint32_t> expand(Prototype& prototype, std::string_view type, std::size_t depth) {
    if (prototype.is_open)
      return source_.bad_line(type.data(), "the PROTO " + shown(type) + " stands in itself");
    if (depth >= kMaxSceneDepth)
      return source_.bad_line(type.data(),
                              "nodes stand in more than " + std::to_string(kMaxSceneDepth) + " others");
    VKMESH_CHECK(spend(prototype.length, type));
    ++expanded_;
    std::vector<SceneField> given = prototype.fields;
    SceneNode instance;
    while (!scan_.accept('}')) {
      if (scan_.at_end()) return source_.bad_line(type.data(), "the node " + shown(type) + " does not end");
      const SceneScanner before = scan_;
      const std::string_view word = scan_.word();
      if (word == "ROUTE" || word == "PROTO" || word == "EXTERNPROTO" || word.empty()) {
        scan_ = before;
        VKMESH_CHECK(statement(&instance, instance.children, depth + 1));
        continue;
      }
      if (given_ != nullptr && is_event_mapping()) continue;
      SceneField value;
      value.name = word;
      VKMESH_CHECK(read_value(value, depth + 1));
      for (SceneField& field : given)
        if (field.name == word) field = value;
    }
    // Names within the body are its own. Those of PROTOs that are visible are those where it was defined, and
    // its own, by which it is told where it stands in itself.
    const SceneScanner behind = std::exchange(scan_, prototype.body);
    Prototype* const innermost = std::exchange(innermost_, &prototype);
    const std::size_t defined = defined_prototypes_.size();
    prototype.is_open = true;
    std::map<std::string_view, std::uint32_t> names;
    std::swap(names, defined_);
    const std::vector<SceneField>* const outer = std::exchange(given_, &given);
    std::vector<std::uint32_t> nodes;
    const auto read = [&]() -> Result<void> {
      while (!scan_.accept('}')) VKMESH_CHECK(statement(nullptr, nodes, depth + 1));
      return {};
    };
    Result<void> result = read();
    given_ = outer;
    std::swap(names, defined_);
    prototype.is_open = false;
    while (defined_prototypes_.size() > defined) defined_prototypes_.pop_back();
    innermost_ = innermost;
    scan_ = behind;
    if (!result) return tl::unexpected<Error>(std::move(result.error()));
    return nodes.empty() ? kIgnoredNode : nodes.front();
  }

  Result<void> field(std::string_view name, SceneNode& node, std::size_t depth) {
    SceneField value;
    value.name = name;
    VKMESH_CHECK(read_value(value, depth));
    // Inventor writes ~ for a value that does not count, or behind it.
    bool is_ignored = value.text == "~";
    if (!is_ignored) {
      const SceneScanner behind = scan_;
      is_ignored = scan_.word() == "~";
      if (!is_ignored) scan_ = behind;
    }
    VKMESH_CHECK(skip_connection(depth));
    if (is_ignored) return {};
    if (std::find(fields_.begin(), fields_.end(), name) == fields_.end()) return {};
    for (SceneField& other : node.fields)
      if (other.name == name) {
        other = std::move(value);
        return {};
      }
    node.fields.push_back(std::move(value));
    return {};
  }

  /// Over "= USE node.field" or "= Engine { } . field" behind a value, which it may change while a program
  /// runs.
  Result<void> skip_connection(std::size_t depth) {
    const SceneScanner before = scan_;
    if (scan_.word() != "=") {
      scan_ = before;
      return {};
    }
    ++connections_;
    const SceneScanner source = scan_;
    if (scan_.word() == "USE") {
      static_cast<void>(scan_.word());
    } else {
      scan_ = source;
      VKMESH_CHECK(read_node(depth));
    }
    const SceneScanner behind = scan_;
    const std::string_view word = scan_.word();
    if (word == ".")
      static_cast<void>(scan_.word());
    else if (!word.starts_with('.'))
      scan_ = behind;
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
      to.text = between(from, scan_.at());
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
    if (to.text == "IS" && given_ != nullptr) {
      const std::string_view name = scan_.word();
      to.text = {};
      for (const SceneField& value : *given_)
        if (value.name == name) {
          to.text = value.text;
          to.nodes = value.nodes;
        }
      return {};
    }
    if (to.text.empty()) return expected("the value of the field " + shown(to.name));
    return {};
  }

  /// "name IS event": no value that counts; passed over.
  bool is_event_mapping() {
    const SceneScanner before = scan_;
    if (scan_.word() == "IS") {
      const std::string_view name = scan_.word();
      const bool is_field = std::any_of(given_->begin(), given_->end(),
                                        [&](const SceneField& value) { return value.name == name; });
      if (!is_field && !name.empty()) return true;
    }
    scan_ = before;
    return false;
  }

  bool begins_node() {
    SceneScanner ahead = scan_;
    if (begins_number(ahead.peek())) return false;
    const std::string_view word = ahead.word();
    return !word.empty() &&
           (word == "DEF" || word == "USE" || word == "PROTO" || word == "ROUTE" || ahead.peek() == '{');
  }

  const Source& source_;
  SceneScanner scan_;
  std::span<const KnownNode> known_;
  std::span<const std::string_view> fields_;
  IgnoredNodes& ignored_;
  SceneGraph graph_;
  std::map<std::string_view, std::uint32_t> defined_;
  std::deque<Prototype> defined_prototypes_;        ///< Never moved, since they name each other.
  Prototype* innermost_ = nullptr;                  ///< The last that is visible.
  const std::vector<SceneField>* given_ = nullptr;  ///< The fields of the instance that is expanded.
  std::uint64_t expansion_ = 64 * static_cast<std::uint64_t>(source_.bytes.size()) + (std::uint64_t{1} << 22);
  std::size_t statements_ = 0, prototypes_ = 0, routes_ = 0, undefined_ = 0, connections_ = 0, expanded_ = 0;
};

}  // namespace

std::string SceneField::string() const {
  if (form == SceneForm::kCharacters) return std::string(text);
  const std::size_t open = text.find('"');
  if (open == std::string_view::npos) return {};
  std::string string;
  for (std::size_t i = open + 1; i < text.size() && text[i] != '"'; ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) ++i;
    string += text[i];
  }
  return string;
}

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
    notes.push_back({"dropped.node", std::to_string(count) + " " + shown(type) + " nodes ignored"});
  if (others_ > 0)
    notes.push_back({"dropped.node", std::to_string(others_) + " nodes of other types ignored"});
}

std::string IgnoredNodes::text() const {
  std::string text;
  std::size_t listed = 0;
  for (const auto& [type, count] : counts_)
    if (listed++ < 3) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + shown(type);
  return listed > 3 ? text + ", …" : text;
}

void note_ignored(Notes& notes, std::size_t count, const char* code, const char* what) {
  if (count > 0) notes.push_back({code, std::to_string(count) + " " + what + " ignored"});
}

Result<SceneGraph> parse_scene(const Source& source, std::span<const KnownNode> known,
                               std::span<const std::string_view> fields, IgnoredNodes& ignored,
                               Notes& notes) {
  SceneParser parser(source, known, fields, ignored);
  VKMESH_TRY(SceneGraph graph, parser.read());
  parser.add_to(notes);
  return graph;
}

}  // namespace vkmesh::detail
