// PLY, the Polygon File Format (G. Turk, "The PLY polygon file format", 1994).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "io/formats.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

static_assert(std::endian::native == std::endian::little, "byte orders are told apart on this assumption");

// ---------------------------------------------------------------------------------------------------- scalar
// types

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct ScalarName {
  std::string_view name;
  Scalar type;
};

// The first name of each type is the one that is written.
constexpr std::array kScalarNames = {
    ScalarName{"char", Scalar::kInt8},     ScalarName{"uchar", Scalar::kUint8},
    ScalarName{"short", Scalar::kInt16},   ScalarName{"ushort", Scalar::kUint16},
    ScalarName{"int", Scalar::kInt32},     ScalarName{"uint", Scalar::kUint32},
    ScalarName{"float", Scalar::kFloat},   ScalarName{"double", Scalar::kDouble},
    ScalarName{"int8", Scalar::kInt8},     ScalarName{"uint8", Scalar::kUint8},
    ScalarName{"int16", Scalar::kInt16},   ScalarName{"uint16", Scalar::kUint16},
    ScalarName{"int32", Scalar::kInt32},   ScalarName{"uint32", Scalar::kUint32},
    ScalarName{"float32", Scalar::kFloat}, ScalarName{"float64", Scalar::kDouble},
};

std::optional<Scalar> scalar_of(std::string_view name) {
  for (const ScalarName& s : kScalarNames)
    if (s.name == name) return s.type;
  return std::nullopt;
}

std::string_view name_of_scalar(Scalar type) {
  return kScalarNames[static_cast<std::size_t>(type)].name;
}

/// Calls f with a value of the C++ type.
template <class F>
decltype(auto) with_type(Scalar type, F&& f) {
  switch (type) {
    case Scalar::kInt8:
      return f(std::int8_t{});
    case Scalar::kUint8:
      return f(std::uint8_t{});
    case Scalar::kInt16:
      return f(std::int16_t{});
    case Scalar::kUint16:
      return f(std::uint16_t{});
    case Scalar::kInt32:
      return f(std::int32_t{});
    case Scalar::kUint32:
      return f(std::uint32_t{});
    case Scalar::kFloat:
      return f(float{});
    case Scalar::kDouble:
      break;
  }
  return f(double{});
}

std::size_t size_of(Scalar type) {
  return with_type(type, [](auto t) { return sizeof(t); });
}

bool is_integer(Scalar type) {
  return type != Scalar::kFloat && type != Scalar::kDouble;
}

template <class T>
T swap_bytes(T value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

// ----------------------------------------------------------------------------------------------------------
// header

struct Property {
  std::string name;
  Scalar type = Scalar::kFloat;
  bool list = false;
  Scalar count_type = Scalar::kUint8;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
  const char* at = nullptr;  ///< Its line in the header.

  [[nodiscard]] const Property* find(std::string_view property) const {
    for (const Property& p : properties)
      if (p.name == property) return &p;
    return nullptr;
  }
  [[nodiscard]] bool has_lists() const {
    return std::any_of(properties.begin(), properties.end(), [](const Property& p) { return p.list; });
  }
  /// The fewest bytes that one of these takes, as binary and as text (a digit and what parts it from the
  /// next).
  [[nodiscard]] std::uint64_t least_bytes(bool ascii) const {
    std::uint64_t bytes = 0;
    for (const Property& p : properties) bytes += ascii ? 2 : size_of(p.list ? p.count_type : p.type);
    return bytes;
  }
};

struct Header {
  FileEncoding encoding = FileEncoding::kAscii;
  std::vector<Element> elements;
  const char* body = nullptr;

  [[nodiscard]] const Element* find(std::string_view element) const {
    for (const Element& e : elements)
      if (e.name == element) return &e;
    return nullptr;
  }
};

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
    // The body begins after one line end of the kind that the first line has: what follows it may be data.
    if (carriage_return) text_.accept('\r');
    if (line_feed) text_.accept('\n');
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

// ------------------------------------------------------------------------------------- properties become
// channels

/// Properties that make up one channel.
struct Group {
  std::string channel;
  std::vector<const Property*> properties;
};

/// Components that a channel of a well-known name has; 0 for other names.
bool components_fit(const std::string& channel, std::size_t components) {
  if (channel == "normal") return components == 3;
  if (channel == "uv") return components == 2;
  if (channel == "color") return components == 3 || components == 4;
  if (channel == "quality") return components == 1;
  return true;
}

struct KnownGroup {
  const char* channel;
  std::vector<const char*> properties;
};

// Of several for one channel the first that fits is taken.
const std::vector<KnownGroup>& known_groups() {
  static const std::vector<KnownGroup> kGroups = {{"normal", {"nx", "ny", "nz"}},
                                                  {"color", {"red", "green", "blue", "alpha"}},
                                                  {"color", {"red", "green", "blue"}},
                                                  {"uv", {"s", "t"}},
                                                  {"uv", {"u", "v"}},
                                                  {"uv", {"texture_u", "texture_v"}}};
  return kGroups;
}

/// The channels that an element's scalar properties make, the taken ones left out.
std::vector<Group> group_properties(const Element& element, std::set<const Property*> taken, Notes& notes) {
  std::vector<Group> groups;
  const auto named = [&](const std::string& channel) {
    return std::any_of(groups.begin(), groups.end(), [&](const Group& g) { return g.channel == channel; });
  };
  const auto add = [&](Group group) {
    taken.insert(group.properties.begin(), group.properties.end());
    groups.push_back(std::move(group));
  };
  const auto joins = [&](const Property* p, const Group& group) {
    return p != nullptr && !p->list && !taken.contains(p) &&
           (group.properties.empty() || p->type == group.properties.front()->type);
  };

  for (const KnownGroup& known : known_groups()) {
    Group group{known.channel, {}};
    for (const char* name : known.properties)
      if (const Property* p = element.find(name); joins(p, group)) group.properties.push_back(p);
    if (group.properties.size() == known.properties.size() && !named(group.channel)) add(std::move(group));
  }
  for (const Property& p : element.properties) {
    if (taken.contains(&p)) continue;
    if (p.list) {
      notes.push_back("list property '" + p.name + "' of element '" + element.name + "' ignored");
      continue;
    }
    if (p.name.size() > 2 && p.name.ends_with("_0")) {
      Group group{p.name.substr(0, p.name.size() - 2), {}};
      for (const Property* next = &p; joins(next, group);
           next = element.find(group.channel + "_" + std::to_string(group.properties.size())))
        group.properties.push_back(next);
      if (group.properties.size() > 1 && components_fit(group.channel, group.properties.size()) &&
          element.find(group.channel) == nullptr && !named(group.channel)) {
        add(std::move(group));
        continue;
      }
    }
    if (components_fit(p.name, 1) && !named(p.name))
      add({p.name, {&p}});
    else
      notes.push_back("property '" + p.name + "' of element '" + element.name +
                      "' ignored: its name stands for something else here");
  }
  return groups;
}

// ------------------------------------------------------------------------------------------------------------
// body

/// Where the values of a scalar property go; nowhere by default.
struct Sink {
  std::byte* to = nullptr;
  std::size_t stride = 0;
  bool to_float = false;  ///< Coordinates become floats; all else keeps its type.
};

template <class T>
ChannelValues values_of(std::size_t count) {
  return std::vector<T>(count);
}

/// Makes the channels of the groups and points the properties' sinks at them.
void make_channels(const Element& element, const std::vector<Group>& groups, std::vector<Channel>& channels,
                   std::vector<Sink>& sinks) {
  channels.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::size_t components = groups[g].properties.size();
    const Scalar type = groups[g].properties.front()->type;
    channels[g].name = groups[g].channel;
    channels[g].components = static_cast<unsigned>(components);
    channels[g].values =
        with_type(type, [&](auto t) { return values_of<decltype(t)>(element.count * components); });
    auto* data =
        std::visit([](auto& v) { return reinterpret_cast<std::byte*>(v.data()); }, channels[g].values);
    if (element.count == 0) continue;  // An empty vector has no data to point into.
    for (std::size_t k = 0; k < components; ++k) {
      const auto place = static_cast<std::size_t>(groups[g].properties[k] - element.properties.data());
      sinks[place] = {data + k * size_of(type), components * size_of(type), false};
    }
  }
}

/// Reads scalars of text, an element to a line.
class AsciiBody {
 public:
  static constexpr bool kAscii = true;

  AsciiBody(const Source& source, const char* from)
      : source_(source), text_(source.bytes.substr(static_cast<std::size_t>(from - source.bytes.data()))) {}

  [[nodiscard]] const char* at() const { return text_.at(); }
  [[nodiscard]] std::uint64_t left() const { return text_.left(); }
  void begin_element() { text_.skip_to_content(); }
  template <class T>
  bool scalar(T& value) {
    return text_.number(value);
  }
  Result<void> end_element(const Element& element) {
    if (text_.line_done() || element.properties.empty()) return {};
    return source_.bad_line(text_.at(), "a line of element '" + element.name +
                                            "' holds more than its properties: " + text_.found());
  }
  /// Passes over elements whose values nobody wants.
  Result<void> skip(const Element& element) {
    if (element.properties.empty()) return {};
    for (std::uint64_t i = 0; i < element.count; ++i) {
      text_.skip_to_content();
      if (text_.at_end()) return bad(element, i, element.properties.front());
      text_.skip_to_line_end();
    }
    return {};
  }
  tl::unexpected<Error> bad(const Element& element, std::uint64_t i, const Property& p) const {
    return source_.bad_line(text_.at(), element.name + " " + std::to_string(i) + ": expected '" + p.name +
                                            "' (" + (p.list ? "list of " : "") +
                                            std::string(name_of_scalar(p.type)) + "), found " +
                                            text_.found());
  }
  tl::unexpected<Error> bad(const char* where, std::string message) const {
    return source_.bad_line(where, std::move(message));
  }
  Result<void> end() {
    text_.skip_to_content();
    if (text_.at_end()) return {};
    return source_.bad_line(text_.at(), "the file holds more than its header promises: " + text_.found());
  }

 private:
  const Source& source_;
  TextCursor text_;
};

/// Reads binary scalars.
template <bool kSwap>
class BinaryBody {
 public:
  static constexpr bool kAscii = false;
  static constexpr bool kNative = !kSwap;

  BinaryBody(const Source& source, const char* from)
      : source_(source), at_(from), end_(source.bytes.data() + source.bytes.size()) {}

  [[nodiscard]] const char* at() const { return at_; }
  [[nodiscard]] std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - at_); }
  void advance(std::size_t bytes) { at_ += bytes; }
  void begin_element() {}
  template <class T>
  bool scalar(T& value) {
    if (left() < sizeof(T)) return false;
    std::memcpy(&value, at_, sizeof(T));
    if constexpr (kSwap && sizeof(T) > 1) value = swap_bytes(value);
    at_ += sizeof(T);
    return true;
  }
  Result<void> end_element(const Element&) { return {}; }
  Result<void> skip(const Element& element) {
    if (!element.has_lists()) {
      at_ += element.count * element.least_bytes(false);
      return {};
    }
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const Property& p : element.properties) {
        const bool whole = p.list ? skip_list(p) : left() >= size_of(p.type);
        if (!whole) return bad(element, i, p);
        if (!p.list) at_ += size_of(p.type);
      }
    return {};
  }
  tl::unexpected<Error> bad(const Element& element, std::uint64_t i, const Property& p) const {
    return source_.bad_byte(
        at_, "the file ends within '" + p.name + "' of " + element.name + " " + std::to_string(i));
  }
  tl::unexpected<Error> bad(const char* where, std::string message) const {
    return source_.bad_byte(where, std::move(message));
  }
  Result<void> end() {
    // Some writers end the file with a line end of their own.
    const std::string_view rest(at_, left());
    if (rest.empty() || rest == "\n" || rest == "\r\n") return {};
    return source_.bad_byte(at_, std::to_string(rest.size()) + " bytes follow what the header promises");
  }

 private:
  bool skip_list(const Property& p) {
    return with_type(p.count_type, [&](auto count) {
      if (!scalar(count) || count < 0) return false;
      const std::uint64_t bytes = static_cast<std::uint64_t>(count) * size_of(p.type);
      if (bytes > left()) return false;
      at_ += bytes;
      return true;
    });
  }

  const Source& source_;
  const char* at_;
  const char* end_;
};

template <class Body>
class BodyReader {
 public:
  BodyReader(const Source& source, const Header& header, MeshFile& file)
      : source_(source), header_(header), body_(source, header.body), file_(file) {}

  Result<void> read() {
    points_ = header_.find("vertex")->count;
    for (const Element& element : header_.elements) {
      VKMESH_CHECK(check_promise(element));
      if (element.name == "vertex")
        VKMESH_CHECK(vertices(element));
      else if (element.name == "face")
        VKMESH_CHECK(faces(element));
      else
        VKMESH_CHECK(other(element));
    }
    return body_.end();
  }

 private:
  /// Nothing is allocated for more elements than the bytes that are there could hold.
  Result<void> check_promise(const Element& element) const {
    const std::uint64_t least = element.least_bytes(Body::kAscii);
    const std::uint64_t left = body_.left() + (Body::kAscii ? 1 : 0);  // The last line may lack its end.
    if (least > 0 && element.count > left / least)
      return source_.bad_line(element.at, "the header promises " + std::to_string(element.count) +
                                              " of element '" + element.name + "', at least " +
                                              std::to_string(least) + " bytes each, but only " +
                                              std::to_string(body_.left()) + " bytes are left for them");
    if (element.count > kMaxElements && (element.name == "vertex" || element.name == "face"))
      return source_.bad_line(element.at, "the header promises " + std::to_string(element.count) +
                                              " of element '" + element.name +
                                              "': more than 32-bit indices can number");
    return {};
  }

  Result<void> scalar(const Element& element, std::uint64_t i, const Property& p, const Sink& sink) {
    return with_type(p.type, [&](auto value) -> Result<void> {
      if (!body_.scalar(value)) return body_.bad(element, i, p);
      if (sink.to == nullptr) return {};
      std::byte* to = sink.to + i * sink.stride;
      if (sink.to_float) {
        const auto coordinate = static_cast<float>(value);
        std::memcpy(to, &coordinate, sizeof(coordinate));
      } else {
        std::memcpy(to, &value, sizeof(value));
      }
      return {};
    });
  }

  Result<void> skip_list(const Element& element, std::uint64_t i, const Property& p) {
    std::uint64_t count = 0;
    VKMESH_CHECK(list_count(element, i, p, count));
    return with_type(p.type, [&](auto value) -> Result<void> {
      for (std::uint64_t k = 0; k < count; ++k)
        if (!body_.scalar(value)) return body_.bad(element, i, p);
      return {};
    });
  }

  Result<void> list_count(const Element& element, std::uint64_t i, const Property& p, std::uint64_t& count) {
    const char* at = body_.at();
    return with_type(p.count_type, [&](auto value) -> Result<void> {
      if (!body_.scalar(value)) return body_.bad(element, i, p);
      if constexpr (std::is_signed_v<decltype(value)>)
        if (value < 0)
          return body_.bad(
              at, element.name + " " + std::to_string(i) + ": list '" + p.name + "' has a negative count");
      count = static_cast<std::uint64_t>(value);
      return {};
    });
  }

  Result<void> vertices(const Element& element) {
    IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file_.geometry);
    std::vector<Sink> sinks(element.properties.size());
    std::set<const Property*> taken;
    mesh.points.resize(element.count);
    for (const auto& [axis, name] : {std::pair{0, "x"}, {1, "y"}, {2, "z"}}) {
      const Property* p = element.find(name);
      if (p == nullptr || p->list)
        return source_.bad_line(element.at,
                                std::string("element 'vertex' has no scalar property '") + name + "'");
      taken.insert(p);
      if (element.count == 0) continue;
      sinks[static_cast<std::size_t>(p - element.properties.data())] = {
          reinterpret_cast<std::byte*>(mesh.points.data()) + static_cast<std::size_t>(axis) * sizeof(float),
          sizeof(Vec3), true};
    }
    make_channels(element, group_properties(element, std::move(taken), file_.notes), mesh.point_channels,
                  sinks);

    if constexpr (!Body::kAscii && requires { requires Body::kNative; })
      if (is_packed_floats(element)) return packed_points(mesh.points);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (Source::due(i)) VKMESH_CHECK(source_.tick(body_.at()));
      body_.begin_element();
      const char* at = body_.at();
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const Property& p = element.properties[k];
        VKMESH_CHECK(p.list ? skip_list(element, i, p) : scalar(element, i, p, sinks[k]));
      }
      if (!is_finite(mesh.points[i])) return not_finite(at, i);
      VKMESH_CHECK(body_.end_element(element));
    }
    return {};
  }

  static bool is_packed_floats(const Element& element) {
    if (element.properties.size() != 3) return false;
    for (std::size_t k = 0; k < 3; ++k)
      if (element.properties[k].type != Scalar::kFloat || element.properties[k].name[0] != "xyz"[k])
        return false;
    return true;
  }

  Result<void> packed_points(std::vector<Vec3>& points) {
    const char* from = body_.at();
    if (!points.empty()) std::memcpy(points.data(), from, points.size() * sizeof(Vec3));
    body_.advance(points.size() * sizeof(Vec3));
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!is_finite(points[i])) return not_finite(from + i * sizeof(Vec3), i);
    return source_.tick(body_.at());
  }

  static bool is_finite(const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }

  tl::unexpected<Error> not_finite(const char* at, std::uint64_t i) const {
    return body_.bad(
        at, "vertex " + std::to_string(i) + " has a coordinate that is not finite as a 32-bit float");
  }

  Result<void> faces(const Element& element) {
    IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file_.geometry);
    const Property* indices = element.find("vertex_indices");
    if (indices == nullptr) indices = element.find("vertex_index");
    if (indices == nullptr || !indices->list || !is_integer(indices->type)) {
      if (element.count == 0) return {};
      return source_.bad_line(element.at,
                              "element 'face' has no list of integers 'vertex_indices' or 'vertex_index'");
    }
    std::vector<Sink> sinks(element.properties.size());
    make_channels(element, group_properties(element, {indices}, file_.notes), mesh.face_channels, sinks);

    FaceCollector collector(mesh);
    std::uint64_t done = 0;
    if constexpr (!Body::kAscii && requires { requires Body::kNative; })
      if (element.properties.size() == 1 && indices->count_type == Scalar::kUint8 &&
          size_of(indices->type) == 4) {
        VKMESH_TRY(done, packed_triangles(element, mesh.corners));
      }
    collector.start_with_triangles(done);
    // A corner takes two bytes of text or at least one of binary data.
    if (done == 0)
      mesh.corners.reserve(std::min<std::uint64_t>(
          3 * element.count, body_.left() / (Body::kAscii ? 2 : size_of(indices->type))));
    for (std::uint64_t i = done; i < element.count; ++i) {
      if (Source::due(i)) VKMESH_CHECK(source_.tick(body_.at()));
      body_.begin_element();
      const char* at = body_.at();
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const Property& p = element.properties[k];
        if (&p == indices)
          VKMESH_CHECK(face(element, i, p, at, collector));
        else
          VKMESH_CHECK(p.list ? skip_list(element, i, p) : scalar(element, i, p, sinks[k]));
      }
      VKMESH_CHECK(body_.end_element(element));
    }
    return {};
  }

  Result<void> face(const Element& element, std::uint64_t i, const Property& p, const char* at,
                    FaceCollector& collector) {
    std::uint64_t count = 0;
    VKMESH_CHECK(list_count(element, i, p, count));
    if (count < 3)
      return body_.bad(at, "face " + std::to_string(i) + " has " + std::to_string(count) + " corners");
    VKMESH_CHECK(with_type(p.type, [&](auto index) -> Result<void> {
      for (std::uint64_t k = 0; k < count; ++k) {
        const char* corner_at = body_.at();
        if (!body_.scalar(index)) return body_.bad(element, i, p);
        if (index < 0 || static_cast<std::uint64_t>(index) >= points_)
          return bad_index(corner_at, i, std::to_string(index));
        collector.corner(static_cast<std::uint32_t>(index));
      }
      return {};
    }));
    if (!collector.end_face(count))
      return body_.bad(at, "the faces have more corners than 32-bit indices can number");
    return {};
  }

  tl::unexpected<Error> bad_index(const char* at, std::uint64_t face, const std::string& index) const {
    return body_.bad(at, "face " + std::to_string(face) + " names vertex " + index + ", but there are " +
                             std::to_string(points_) + " vertices, counted from 0");
  }

  /// Triangles as nearly every binary file has them: one byte 3, three 4-byte indices. Returns how many faces
  /// it took: all, or those before the first that is something else.
  Result<std::uint64_t> packed_triangles(const Element& element, std::vector<std::uint32_t>& corners) {
    constexpr std::size_t kBytes = 1 + 3 * sizeof(std::uint32_t);
    const char* from = body_.at();
    const std::uint64_t fit = std::min(element.count, body_.left() / kBytes);
    corners.resize(3 * fit);
    std::uint64_t f = 0;
    for (; f < fit && from[f * kBytes] == 3; ++f) {
      if (Source::due(f)) VKMESH_CHECK(source_.tick(from + f * kBytes));
      std::uint32_t* face = corners.data() + 3 * f;
      std::memcpy(face, from + f * kBytes + 1, kBytes - 1);
      if (std::max({face[0], face[1], face[2]}) < points_) continue;
      const auto k = std::find_if(face, face + 3, [&](std::uint32_t c) { return c >= points_; }) - face;
      const bool is_signed = element.properties[0].type == Scalar::kInt32;
      return bad_index(
          from + f * kBytes + 1 + static_cast<std::size_t>(k) * sizeof(std::uint32_t), f,
          is_signed ? std::to_string(static_cast<std::int32_t>(face[k])) : std::to_string(face[k]));
    }
    corners.resize(3 * f);
    body_.advance(f * kBytes);
    return f;
  }

  Result<void> other(const Element& element) {
    if (element.count > 0)
      file_.notes.push_back(std::to_string(element.count) + " of element '" + element.name + "' ignored");
    return body_.skip(element);
  }

  const Source& source_;
  const Header& header_;
  Body body_;
  MeshFile& file_;
  std::uint64_t points_ = 0;
};

}  // namespace

Result<MeshFile> parse_ply(const Source& source) {
  VKMESH_TRY(const Header header, HeaderReader(source).read());
  if (header.find("vertex") == nullptr)
    return source.bad_line(header.body - 1, "the header has no element 'vertex'");
  MeshFile file;
  file.geometry = IndexedFaceSet{};
  file.format = FileFormat::kPly;
  file.encoding = header.encoding;
  switch (header.encoding) {
    case FileEncoding::kAscii:
      VKMESH_CHECK(BodyReader<AsciiBody>(source, header, file).read());
      break;
    case FileEncoding::kBinaryLittleEndian:
      VKMESH_CHECK(BodyReader<BinaryBody<false>>(source, header, file).read());
      break;
    case FileEncoding::kBinaryBigEndian:
      VKMESH_CHECK(BodyReader<BinaryBody<true>>(source, header, file).read());
      break;
  }
  return file;
}

// ---------------------------------------------------------------------------------------------------------
// writing

namespace {

struct OutColumn {
  std::string property;
  const Channel* channel = nullptr;
  unsigned component = 0;
  Scalar type = Scalar::kFloat;
  bool as_byte = false;  ///< Colours are written as bytes, which is what readers of PLY expect.
};

/// The alternatives of ChannelValues, in their order.
Scalar scalar_type(const Channel& channel) {
  constexpr std::array kTypes = {Scalar::kFloat, Scalar::kDouble, Scalar::kInt8,  Scalar::kUint8,
                                 Scalar::kInt16, Scalar::kUint16, Scalar::kInt32, Scalar::kUint32};
  static_assert(kTypes.size() == std::variant_size_v<ChannelValues>);
  return kTypes[channel.values.index()];
}

/// The properties in which the channels are written; what has no place among them is noted.
std::vector<OutColumn> columns_of(const std::vector<Channel>& channels, std::set<std::string> used,
                                  const char* element, Notes& notes) {
  std::vector<OutColumn> columns;
  for (const Channel& channel : channels) {
    const Scalar type = scalar_type(channel);
    std::vector<std::string> names;
    const bool color = channel.name == "color" && (channel.components == 3 || channel.components == 4);
    if (channel.name == "normal" && channel.components == 3)
      names = {"nx", "ny", "nz"};
    else if (channel.name == "uv" && channel.components == 2)
      names = {"s", "t"};
    else if (color)
      names = {"red", "green", "blue", "alpha"};
    else if (channel.components == 1)
      names = {channel.name};
    else
      for (unsigned k = 0; k < channel.components; ++k)
        names.push_back(channel.name + "_" + std::to_string(k));
    names.resize(channel.components);

    const bool word = !channel.name.empty() &&
                      std::none_of(channel.name.begin(), channel.name.end(),
                                   [](char c) { return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f; });
    const bool free =
        std::none_of(names.begin(), names.end(), [&](const std::string& n) { return used.contains(n); });
    if (!word || !free || channel.components == 0) {
      note_left_out(notes, element, channel,
                    word ? "its property names are taken" : "its name is not one word");
      continue;
    }
    used.insert(names.begin(), names.end());
    if (color && !is_integer(type))
      notes.push_back(std::string(element) + " channel 'color' rounded to 8 bits");
    for (unsigned k = 0; k < channel.components; ++k)
      columns.push_back({names[k], &channel, k, color ? Scalar::kUint8 : type, color});
  }
  return columns;
}

template <FileEncoding kEncoding, class T>
char* put_scalar(char* to, T value) {
  if constexpr (kEncoding == FileEncoding::kAscii) {
    to = put_number(to, value);
    *to++ = ' ';
    return to;
  } else {
    if constexpr (kEncoding == FileEncoding::kBinaryBigEndian && sizeof(T) > 1) value = swap_bytes(value);
    std::memcpy(to, &value, sizeof(T));
    return to + sizeof(T);
  }
}

/// Ends a line of text: its last blank becomes the line end.
template <FileEncoding kEncoding>
void end_line(Output& out, char* to) {
  if constexpr (kEncoding == FileEncoding::kAscii) to[-1] = '\n';
  out.commit(to);
}

template <FileEncoding kEncoding>
void put_columns(Output& out, char*& to, const std::vector<OutColumn>& columns, std::size_t i) {
  for (const OutColumn& column : columns) {
    out.commit(to);
    to = out.room(64);
    const std::size_t at = i * column.channel->components + column.component;
    if (column.as_byte)
      to = put_scalar<kEncoding>(to, color_byte(*column.channel, at));
    else
      to = std::visit([&](const auto& values) { return put_scalar<kEncoding>(to, values[at]); },
                      column.channel->values);
  }
}

template <FileEncoding kEncoding>
void put_body(const IndexedFaceSet& mesh, const std::vector<OutColumn>& point_columns,
              const std::vector<OutColumn>& face_columns, bool wide_counts, Output& out) {
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    char* to = out.room(256);
    for (int axis = 0; axis < 3; ++axis) to = put_scalar<kEncoding>(to, mesh.points[i][axis]);
    put_columns<kEncoding>(out, to, point_columns, i);
    end_line<kEncoding>(out, to);
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(f);
    char* to = out.room(256);
    const auto count = static_cast<std::uint32_t>(corners.size());
    to = wide_counts ? put_scalar<kEncoding>(to, count)
                     : put_scalar<kEncoding>(to, static_cast<std::uint8_t>(count));
    for (const std::uint32_t c : corners) {
      out.commit(to);
      to = out.room(64);
      to = put_scalar<kEncoding>(to, c);
    }
    put_columns<kEncoding>(out, to, face_columns, f);
    end_line<kEncoding>(out, to);
  }
}

}  // namespace

void encode_ply(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  const auto point_columns = columns_of(mesh.point_channels, {"x", "y", "z"}, "point", notes);
  const auto face_columns = columns_of(mesh.face_channels, {"vertex_indices", "vertex_index"}, "face", notes);
  for (const Channel& c : mesh.corner_channels)
    note_left_out(notes, "corner", c, "PLY has no attributes of corners");

  std::size_t widest = 3;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) widest = std::max(widest, mesh.face(f).size());
  const bool wide_counts = widest > 255;

  std::string header = "ply\nformat " + name_of(options.encoding) + " 1.0\n";
  for (const std::string& line : comment_lines(options.comment)) header += "comment " + line + "\n";
  const auto property = [](const OutColumn& c) {
    return "property " + std::string(name_of_scalar(c.type)) + " " + c.property + "\n";
  };
  header += "element vertex " + std::to_string(mesh.points.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += std::string("property float ") + axis + "\n";
  for (const OutColumn& c : point_columns) header += property(c);
  header += "element face " + std::to_string(mesh.face_count()) + "\nproperty list ";
  header += wide_counts ? "uint " : "uchar ";
  header += mesh.points.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()) ? "uint"
                                                                                                    : "int";
  header += " vertex_indices\n";
  for (const OutColumn& c : face_columns) header += property(c);
  out.put(header + "end_header\n");

  switch (options.encoding) {
    case FileEncoding::kAscii:
      put_body<FileEncoding::kAscii>(mesh, point_columns, face_columns, wide_counts, out);
      break;
    case FileEncoding::kBinaryLittleEndian:
      put_body<FileEncoding::kBinaryLittleEndian>(mesh, point_columns, face_columns, wide_counts, out);
      break;
    case FileEncoding::kBinaryBigEndian:
      put_body<FileEncoding::kBinaryBigEndian>(mesh, point_columns, face_columns, wide_counts, out);
      break;
  }
}

}  // namespace vkmesh::detail
