// OpenInventor in its binary form (as SGI's and Coin's SoOutput write it): the nodes of the text form without
// its brackets. Everything is made of words of 4 bytes, the most significant first, and of strings: a word
// with the length and the characters, filled up to whole words. A node is [DEF name] type, in V2.1 a word of
// flags, a word with the number of its fields, the fields, and the number and nodes of its children where it
// is a group. A field is its name, its value and a word of flags. Nothing says how long a value is: its type
// does, which the file tells for the nodes of programs' own classes, and OpenInventor for the rest.
#include <algorithm>
#include <optional>
#include <utility>

#include "io/inventor/big_endian.h"
#include "io/inventor/scene_graph.h"
#include "io/inventor/scene_scanner.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

/// How a value of a field's type stands in the file.
enum class Layout {
  kWhole,   ///< Words that are whole numbers.
  kReal,    ///< Words that are floats.
  kOther,   ///< Words that are neither.
  kString,  ///< Also names and enumerators.
  kMask,    ///< Strings, and an empty one behind them.
  kNode,    ///< A node, or the string NULL.
  kImage    ///< Width, height, components, texels.
};

struct ValueType {
  Layout layout = Layout::kOther;
  unsigned words = 0;     ///< One value's, where it has a fixed length.
  bool multiple = false;  ///< A word with the number of values stands before them.
};

struct NamedType {
  std::string_view name;  ///< Without SF or MF.
  Layout layout;
  unsigned words;
};

constexpr NamedType kTypes[] = {
    {"Bool", Layout::kWhole, 1},     {"Short", Layout::kWhole, 1},   {"UShort", Layout::kWhole, 1},
    {"Long", Layout::kWhole, 1},     {"ULong", Layout::kWhole, 1},   {"Int32", Layout::kWhole, 1},
    {"UInt32", Layout::kWhole, 1},   {"Vec2s", Layout::kWhole, 2},   {"Vec3s", Layout::kWhole, 3},
    {"Vec4s", Layout::kWhole, 4},    {"Vec2i32", Layout::kWhole, 2}, {"Vec3i32", Layout::kWhole, 3},
    {"Vec4i32", Layout::kWhole, 4},  {"Float", Layout::kReal, 1},    {"Vec2f", Layout::kReal, 2},
    {"Vec3f", Layout::kReal, 3},     {"Vec4f", Layout::kReal, 4},    {"Color", Layout::kReal, 3},
    {"ColorRGBA", Layout::kReal, 4}, {"Rotation", Layout::kReal, 4}, {"Plane", Layout::kReal, 4},
    {"Matrix", Layout::kReal, 16},   {"Double", Layout::kOther, 2},  {"Time", Layout::kOther, 2},
    {"Vec2d", Layout::kOther, 4},    {"Vec3d", Layout::kOther, 6},   {"Vec4d", Layout::kOther, 8},
    {"Trigger", Layout::kOther, 0},  {"String", Layout::kString, 1}, {"Name", Layout::kString, 1},
    {"Enum", Layout::kString, 1},    {"BitMask", Layout::kMask, 1},  {"Node", Layout::kNode, 1},
    {"Engine", Layout::kNode, 1},    {"Path", Layout::kNode, 1},     {"Image", Layout::kImage, 3}};

std::optional<ValueType> type_named(std::string_view name) {
  const bool multiple = name.starts_with("MF");
  if (!multiple && !name.starts_with("SF")) return {};
  for (const NamedType& type : kTypes)
    if (type.name == name.substr(2)) return ValueType{type.layout, type.words, multiple};
  return {};
}

/// The names of fields that OpenInventor's nodes, manipulators and engines give to one type.
struct FieldNames {
  std::string_view type;
  std::string_view names;  ///< A blank around each.
};

constexpr FieldNames kFieldNames[] = {
    {"SFBool", " on pause disable enableCompressedTexture recalcAlways "},
    {"SFShort", " numElements1 numElements2 numElements3 linePattern min max step reset "},
    {"SFInt32",
     " whichChild startIndex numPoints verticesPerColumn verticesPerRow linePatternScaleFactor"
     " numControlPoints numUControlPoints numVControlPoints numSControlPoints numTControlPoints"
     " numNodesUpToContainer numNodesUpToReset "},
    {"MFInt32",
     " coordIndex materialIndex normalIndex textureCoordIndex markerIndex numVertices index textureUnit "},
    {"MFUInt32", " orderedRGBA rgba "},
    {"SFFloat",
     " nearDistance farDistance aspectRatio focalDistance heightAngle height top bottom left right spacing"
     " radius bottomRadius width depth speed angle textureQuality intensity dropOffRate cutOffAngle pointSize"
     " lineWidth ambientIntensity fogVisibility size factor creaseAngle frequency alpha "},
    {"MFFloat",
     " knotVector uKnotVector vKnotVector sKnotVector tKnotVector range screenArea shininess transparency"
     " duty a b c d e f g h x y z w "},
    {"MFVec2f", " texCoord "},
    {"SFVec3f",
     " position direction location center scaleFactor translation translation0 translation1 separation1"
     " separation2 separation3 attenuation directionS directionT directionR bboxCenter bboxSize"
     " draggerPosition "},
    {"MFVec3f", " point vector vertex normal texCoord3 A B C D E F G H from to "},
    {"SFColor", " color fogColor blendColor "},
    {"MFColor", " rgb ambientColor diffuseColor specularColor emissiveColor "},
    {"SFRotation", " orientation rotation rotation0 rotation1 scaleOrientation "},
    {"SFMatrix", " matrix "},
    {"SFPlane", " plane "},
    {"SFTime", " timeIn duration "},
    {"SFTrigger",
     " trigger off toggle syncIn input0 input1 input2 input3 input4 input5 input6 input7 input8 input9 "},
    {"SFEnum",
     " viewportMapping justification vertAlignment horAlignment renderCaching boundingBoxCaching"
     " renderCulling pickCulling mode style map origin axis units type value fogType family model linkage"
     " vertexOrdering shapeType faceType wrapS wrapT normalBinding materialBinding policy lassoType"
     " lassoPolicy lassoMode sizing "},
    {"MFEnum", " operation "},
    {"SFString", " filename name description label "},
    {"MFString", " string expression "},
    {"SFBitMask", " parts whatToReset styles flags "},
    {"SFImage", " image "},
    {"SFNode", " vertexProperty alternateRep node path "}};

/// The nodes whose field of that name has another type.
struct OtherType {
  std::string_view node, field, type;
};

constexpr OtherType kOtherTypes[] = {{"AsciiText", "width", "MFFloat"},
                                     {"FontStyle", "style", "SFBitMask"},
                                     {"Info", "string", "SFString"},
                                     {"Complexity", "value", "SFFloat"},
                                     {"PolygonOffset", "units", "SFFloat"},
                                     {"Environment", "ambientColor", "SFColor"},
                                     {"Coordinate4", "point", "MFVec4f"},
                                     {"ProfileCoordinate2", "point", "MFVec2f"},
                                     {"TextureCoordinate2", "point", "MFVec2f"},
                                     {"Texture2Transform", "translation", "SFVec2f"},
                                     {"Texture2Transform", "rotation", "SFFloat"},
                                     {"Texture2Transform", "scaleFactor", "SFVec2f"},
                                     {"Texture2Transform", "center", "SFVec2f"},
                                     {"MultipleCopy", "matrix", "MFMatrix"},
                                     {"DecomposeMatrix", "matrix", "MFMatrix"},
                                     {"DecomposeMatrix", "center", "MFVec3f"},
                                     {"TransformVec3f", "matrix", "MFMatrix"},
                                     {"ComposeMatrix", "translation", "MFVec3f"},
                                     {"ComposeMatrix", "rotation", "MFRotation"},
                                     {"ComposeMatrix", "scaleFactor", "MFVec3f"},
                                     {"ComposeMatrix", "scaleOrientation", "MFRotation"},
                                     {"ComposeMatrix", "center", "MFVec3f"},
                                     {"ComposeRotation", "axis", "MFVec3f"},
                                     {"ComposeRotation", "angle", "MFFloat"},
                                     {"DecomposeRotation", "rotation", "MFRotation"},
                                     {"DecomposeVec2f", "vector", "MFVec2f"},
                                     {"DecomposeVec4f", "vector", "MFVec4f"},
                                     {"ElapsedTime", "reset", "SFTrigger"},
                                     {"OnOff", "on", "SFTrigger"},
                                     {"InterpolateFloat", "input0", "MFFloat"},
                                     {"InterpolateFloat", "input1", "MFFloat"},
                                     {"InterpolateRotation", "input0", "MFRotation"},
                                     {"InterpolateRotation", "input1", "MFRotation"},
                                     {"InterpolateVec2f", "input0", "MFVec2f"},
                                     {"InterpolateVec2f", "input1", "MFVec2f"},
                                     {"InterpolateVec3f", "input0", "MFVec3f"},
                                     {"InterpolateVec3f", "input1", "MFVec3f"},
                                     {"InterpolateVec4f", "input0", "MFVec4f"},
                                     {"InterpolateVec4f", "input1", "MFVec4f"}};

/// The nodes that have children.
constexpr std::string_view kGroups[] = {"Group",
                                        "Separator",
                                        "Annotation",
                                        "LocateHighlight",
                                        "WWWAnchor",
                                        "Array",
                                        "Switch",
                                        "Blinker",
                                        "LOD",
                                        "LevelOfDetail",
                                        "MultipleCopy",
                                        "PathSwitch",
                                        "TransformSeparator",
                                        "Selection",
                                        "ExtSelection"};

/// The type that OpenInventor gives a field.
std::optional<ValueType> type_of(std::string_view node, std::string_view field) {
  for (const OtherType& other : kOtherTypes)
    if (other.node == node && other.field == field) return type_named(other.type);
  for (const FieldNames& row : kFieldNames) {
    // A name may also be part of another.
    for (std::size_t at = row.names.find(field); at != std::string_view::npos;
         at = row.names.find(field, at + 1))
      if (row.names[at - 1] == ' ' && row.names[at + field.size()] == ' ') return type_named(row.type);
  }
  return {};
}

class BinarySceneParser {
 public:
  BinarySceneParser(const Source& source, const char* begin, bool has_flags, std::span<const KnownNode> known,
                    std::span<const std::string_view> fields, IgnoredNodes& ignored)
      : source_(source),
        at_(begin),
        has_flags_(has_flags),
        known_(known),
        fields_(fields),
        ignored_(ignored) {}

  Result<SceneGraph> read() {
    graph_.nodes.emplace_back();
    while (left() > 0) {
      VKMESH_TRY(const std::uint32_t root, read_node(0));
      graph_.roots.push_back(root);
    }
    return std::move(graph_);
  }

  void add_to(Notes& notes) const {
    note_ignored(notes, connections_, "dropped.connection", "connections of fields");
    note_ignored(notes, undefined_, "skipped.use", "uses of names that no node before them has");
  }

 private:
  struct Description {
    std::string_view name;
    ValueType type;
  };

  [[nodiscard]] std::size_t left() const {
    return static_cast<std::size_t>(source_.bytes.data() + source_.bytes.size() - at_);
  }

  /// Over `count` words, which must be there.
  Result<std::string_view> words(std::uint64_t count) {
    if (count > left() / 4)
      return source_.bad_line(at_, "the file ends within a value of " + std::to_string(count) + " words");
    const std::string_view text(at_, static_cast<std::size_t>(4 * count));
    at_ += text.size();
    return text;
  }

  Result<std::uint32_t> word() {
    VKMESH_TRY(const std::string_view text, words(1));
    return big_endian_word(text.data());
  }

  Result<std::string_view> string() {
    const char* from = at_;
    VKMESH_TRY(const std::uint32_t length, word());
    if (length > left())
      return source_.bad_line(from, "the file ends within a string of " + std::to_string(length) + " bytes");
    VKMESH_TRY(const std::string_view text, words((std::uint64_t{length} + 3) / 4));
    return text.substr(0, length);
  }

  /// A string that is a name, and so an error where the file is not what was taken for it.
  Result<std::string_view> name(const char* what) {
    const char* from = at_;
    VKMESH_TRY(const std::string_view text, string());
    const auto is_part = [](char c) {
      return static_cast<unsigned char>(c) > 0x20 &&
             std::string_view("{}[]\"'\\\x7f").find(c) == std::string_view::npos;
    };
    if (!text.empty() && std::all_of(text.begin(), text.end(), is_part)) return text;
    return source_.bad_line(from, std::string("expected ") + what + ", found " +
                                      (text.empty() ? "an empty string" : TextCursor(text).found()));
  }

  /// [DEF name] Type ... or USE name, or the NULL of a field.
  Result<std::uint32_t> read_node(std::size_t depth) {
    if (Source::due(nodes_++)) VKMESH_CHECK(source_.tick(at_));
    VKMESH_TRY(std::string_view word, name("the type of a node"));
    if (word == "NULL") return kIgnoredNode;
    if (word == "USE") {
      VKMESH_TRY(const std::string_view used, name("a name after USE"));
      const auto found = defined_.find(used);
      if (found != defined_.end()) return found->second;
      ++undefined_;
      return kIgnoredNode;
    }
    std::string_view own_name;
    if (word == "DEF") {
      VKMESH_TRY(own_name, name("a name after DEF"));
      VKMESH_TRY(word, name("the type of a node"));
    }
    VKMESH_TRY(const std::uint32_t node, read_body(word, depth));
    // Known only from here on: a node within cannot use it.
    if (!own_name.empty()) defined_[own_name] = node;
    return node;
  }

  Result<std::uint32_t> read_body(std::string_view type, std::size_t depth) {
    constexpr std::uint32_t kEngine = 1, kGroup = 2;
    constexpr std::uint32_t kDescribed = 0x4000, kCount = 0xff;
    if (depth >= kMaxSceneDepth)
      return source_.bad_line(type.data(),
                              "nodes stand in more than " + std::to_string(kMaxSceneDepth) + " others");
    bool is_group = std::find(std::begin(kGroups), std::end(kGroups), type) != std::end(kGroups);
    if (has_flags_) {
      const char* from = at_;
      VKMESH_TRY(const std::uint32_t flags, word());
      if ((flags & ~(kEngine | kGroup)) != 0)
        return source_.bad_line(from, "the node " + shown(type) + " has flags that are none");
      is_group = is_group || (flags & kGroup) != 0;
    }
    const auto known =
        std::find_if(known_.begin(), known_.end(), [&](const KnownNode& k) { return k.name == type; });
    SceneNode node;
    node.type = type;
    if (known != known_.end()) node.kind = known->kind;
    const bool outer_ignored = in_ignored_;
    if (node.kind == 0) {
      // What stands within is ignored with it.
      if (!outer_ignored) ignored_.add(type);
      in_ignored_ = true;
    }

    // Before V2.1 the plain group has no fields, not even their number.
    if (has_flags_ || type != "Group") {
      const char* from = at_;
      VKMESH_TRY(const std::uint32_t control, word());
      if ((control & ~(kDescribed | kCount)) != 0)
        return source_.bad_line(from, "the node " + shown(type) + " has no number of fields");
      std::vector<Description> descriptions;
      if ((control & kDescribed) != 0) {
        VKMESH_TRY(descriptions, read_descriptions(control & kCount));
      }
      for (std::uint32_t i = 0; i < (control & kCount); ++i)
        VKMESH_CHECK(read_field(node, descriptions, depth + 1));
    }
    if (is_group) {
      VKMESH_TRY(const std::uint32_t count, word());
      for (std::uint32_t i = 0; i < count; ++i) {
        VKMESH_TRY(const std::uint32_t child, read_node(depth + 1));
        if (node.kind != 0) node.children.push_back(child);
      }
    }
    in_ignored_ = outer_ignored;
    if (node.kind == 0) return kIgnoredNode;
    if (graph_.nodes.size() >= kMaxElements) return source_.bad_line(type.data(), "there are too many nodes");
    graph_.nodes.push_back(std::move(node));
    return static_cast<std::uint32_t>(graph_.nodes.size() - 1);
  }

  /// The types and names of the fields of a node of a program's own class.
  Result<std::vector<Description>> read_descriptions(std::uint32_t count) {
    std::vector<Description> descriptions;
    for (std::uint32_t i = 0; i < count; ++i) {
      VKMESH_TRY(const std::string_view type, name("the type of a field"));
      VKMESH_TRY(const std::string_view field, name("the name of a field"));
      const auto known = type_named(type);
      if (!known)
        return source_.bad_line(type.data(), "the field " + shown(field) + " is of the type " + shown(type) +
                                                 ", whose length is not known");
      descriptions.push_back({field, *known});
    }
    return descriptions;
  }

  Result<void> read_field(SceneNode& node, const std::vector<Description>& descriptions, std::size_t depth) {
    constexpr std::uint32_t kIgnored = 1, kConnected = 2, kDefault = 4;
    SceneField field;
    VKMESH_TRY(field.name, name("the name of a field"));
    const auto described = std::find_if(descriptions.begin(), descriptions.end(),
                                        [&](const Description& d) { return d.name == field.name; });
    const auto type = described != descriptions.end() ? described->type : type_of(node.type, field.name);
    if (!type)
      return source_.bad_line(field.name.data(), "the field " + shown(field.name) + " of the node " +
                                                     shown(node.type) +
                                                     " is none of OpenInventor, and nothing says its length");
    VKMESH_CHECK(read_value(field, *type, depth));
    const char* from = at_;
    VKMESH_TRY(const std::uint32_t flags, word());
    if ((flags & ~(kIgnored | kConnected | kDefault)) != 0)
      return source_.bad_line(from, "the value of the field " + shown(field.name) + " does not end here");
    if ((flags & kConnected) != 0) {
      ++connections_;
      VKMESH_CHECK(read_node(depth));
      VKMESH_CHECK(name("the field that another is connected to"));
    }
    const bool counts = (flags & kIgnored) == 0 && node.kind != 0;
    if (counts && std::find(fields_.begin(), fields_.end(), field.name) != fields_.end())
      node.fields.push_back(std::move(field));
    return {};
  }

  Result<void> read_value(SceneField& to, const ValueType& type, std::size_t depth) {
    std::uint32_t count = 1;
    if (type.multiple) {
      VKMESH_TRY(count, word());
    }
    switch (type.layout) {
      case Layout::kWhole:
      case Layout::kReal:
      case Layout::kOther: {
        VKMESH_TRY(to.text, words(std::uint64_t{count} * type.words));
        if (type.layout == Layout::kWhole) to.form = SceneForm::kWholeWords;
        if (type.layout == Layout::kReal) to.form = SceneForm::kRealWords;
        return {};
      }
      case Layout::kString:
        to.form = SceneForm::kCharacters;
        for (std::uint32_t i = 0; i < count; ++i) {
          VKMESH_TRY(const std::string_view text, string());
          if (i == 0) to.text = text;
        }
        return {};
      case Layout::kMask:
        to.form = SceneForm::kCharacters;
        for (std::uint32_t i = 0; i < count; ++i) VKMESH_CHECK(read_mask(to));
        return {};
      case Layout::kNode:
        for (std::uint32_t i = 0; i < count; ++i) {
          VKMESH_TRY(const std::uint32_t node, read_node(depth));
          to.nodes.push_back(node);
        }
        return {};
      case Layout::kImage:
        for (std::uint32_t i = 0; i < count; ++i) VKMESH_CHECK(skip_image());
        return {};
    }
    return {};
  }

  /// Names, the last of which is empty. The text runs over all of them.
  Result<void> read_mask(SceneField& to) {
    for (;;) {
      VKMESH_TRY(const std::string_view text, string());
      if (text.empty()) return {};
      const char* from = to.text.empty() ? text.data() : to.text.data();
      to.text = {from, static_cast<std::size_t>(text.data() + text.size() - from)};
    }
  }

  Result<void> skip_image() {
    const char* from = at_;
    VKMESH_TRY(const std::uint32_t width, word());
    VKMESH_TRY(const std::uint32_t height, word());
    VKMESH_TRY(const std::uint32_t components, word());
    if (width > 0xffff || height > 0xffff || components > 4)
      return source_.bad_line(from, "an image of a size that none has");
    const std::uint64_t texels = std::uint64_t{width} * height;
    // Before V2.1 each texel has a word of its own.
    const auto skipped = words(has_flags_ ? (texels * components + 3) / 4 : texels);
    return skipped ? Result<void>{} : tl::unexpected<Error>(skipped.error());
  }

  const Source& source_;
  const char* at_;
  bool has_flags_;  ///< V2.1: nodes have a word of flags.
  std::span<const KnownNode> known_;
  std::span<const std::string_view> fields_;
  IgnoredNodes& ignored_;
  SceneGraph graph_;
  std::map<std::string_view, std::uint32_t> defined_;
  bool in_ignored_ = false;
  std::size_t nodes_ = 0, undefined_ = 0, connections_ = 0;
};

}  // namespace

Result<SceneGraph> parse_binary_scene(const Source& source, const char* begin, bool has_flags,
                                      std::span<const KnownNode> known,
                                      std::span<const std::string_view> fields, IgnoredNodes& ignored,
                                      Notes& notes) {
  BinarySceneParser parser(source, begin, has_flags, known, fields, ignored);
  VKMESH_TRY(SceneGraph graph, parser.read());
  parser.add_to(notes);
  return graph;
}

}  // namespace vkmesh::detail
