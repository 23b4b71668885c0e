// Reading PLY. What is large is read in parts at the same time; where a part does not come out, all is read
// again in its order, so that the first error of the file is the one that is told.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
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

#include "base/parallel.h"
#include "io/ply/ply.h"
#include "io/text.h"

namespace vkmesh::detail::ply {
namespace {

// ---- properties become channels
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

// The first that fits is taken where several serve one channel.
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
      notes.push_back(
          {"dropped." + p.name, "list property '" + p.name + "' of element '" + element.name + "' ignored"});
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
      notes.push_back({"dropped." + p.name, "property '" + p.name + "' of element '" + element.name +
                                                "' ignored: its name stands for something else here"});
  }
  return groups;
}

/// Where the values of a scalar property go; nowhere by default.
struct Sink {
  std::byte* to = nullptr;
  std::size_t stride = 0;
  bool to_float = false;  ///< Coordinates become floats; all else keeps its type.
  int axis = -1;          ///< The axis of a coordinate that is placed in double precision.
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
      sinks[place] = {data + k * size_of(type), components * size_of(type), false, -1};
    }
  }
}

// ---- the body

/// Reads scalars of text, an element to a line.
class AsciiBody {
 public:
  static constexpr bool kAscii = true;

  AsciiBody(const Source& source, std::string_view text) : source_(&source), text_(text) {}

  [[nodiscard]] const char* at() const { return text_.at(); }
  [[nodiscard]] std::uint64_t left() const { return text_.left(); }
  void begin_element() { text_.skip_to_content(); }
  /// Some writers print whole numbers with a point.
  template <class T>
  bool scalar(T& value) {
    if (text_.number(value)) return true;
    if constexpr (std::is_integral_v<T>) {
      const TextCursor before = text_;
      double number = 0;
      if (text_.number(number) && number >= std::numeric_limits<T>::min() &&
          number <= std::numeric_limits<T>::max() && number == std::floor(number)) {
        value = static_cast<T>(number);
        return true;
      }
      text_ = before;
      text_.skip_blanks();
    }
    return false;
  }
  bool end_element() { return text_.line_done(); }
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
  void skip_lines(std::uint64_t count) {
    for (; count > 0; --count) {
      text_.skip_to_content();
      text_.skip_to_line_end();
    }
  }
  tl::unexpected<Error> bad(const Element& element, std::uint64_t i, const Property& p) const {
    return source_->bad_line(text_.at(), element.name + " " + std::to_string(i) + ": expected '" + p.name +
                                             "' (" + (p.list ? "list of " : "") +
                                             std::string(name_of_scalar(p.type)) + "), found " +
                                             text_.found());
  }
  tl::unexpected<Error> bad(const char* where, std::string message) const {
    return source_->bad_line(where, std::move(message));
  }
  tl::unexpected<Error> bad_end(const Element& element) const {
    return source_->bad_line(text_.at(), "a line of element '" + element.name +
                                             "' holds more than its properties: " + text_.found());
  }
  Result<void> end() {
    text_.skip_to_content();
    if (text_.at_end()) return {};
    return source_->bad_line(text_.at(), "the file holds more than its header promises: " + text_.found());
  }

 private:
  const Source* source_;
  TextCursor text_;
};

/// Reads binary scalars.
template <bool kSwap>
class BinaryBody {
 public:
  static constexpr bool kAscii = false;

  BinaryBody(const Source& source, std::string_view bytes)
      : source_(&source), at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  [[nodiscard]] const char* at() const { return at_; }
  [[nodiscard]] std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - at_); }
  void advance(std::size_t bytes) { at_ += bytes; }
  void begin_element() {}
  template <class T>
  static T value_at(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    if constexpr (kSwap && sizeof(T) > 1) value = swap_bytes(value);
    return value;
  }
  template <class T>
  bool scalar(T& value) {
    if (left() < sizeof(T)) return false;
    value = value_at<T>(at_);
    at_ += sizeof(T);
    return true;
  }
  bool end_element() { return true; }
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
  void skip_lines(std::uint64_t) {}
  tl::unexpected<Error> bad(const Element& element, std::uint64_t i, const Property& p) const {
    return source_->bad_byte(
        at_, "the file ends within '" + p.name + "' of " + element.name + " " + std::to_string(i));
  }
  tl::unexpected<Error> bad(const char* where, std::string message) const {
    return source_->bad_byte(where, std::move(message));
  }
  tl::unexpected<Error> bad_end(const Element& element) const {
    return source_->bad_byte(at_, "element '" + element.name + "' does not end here");
  }
  Result<void> end() {
    // Some writers end the file with a line end of their own.
    const std::string_view rest(at_, left());
    if (rest.empty() || rest == "\n" || rest == "\r\n") return {};
    return source_->bad_byte(at_, std::to_string(rest.size()) + " bytes follow what the header promises");
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

  const Source* source_;
  const char* at_;
  const char* end_;
};

/// Lines of text that are parsed together.
struct Block {
  std::string_view text;
  std::uint64_t first = 0;  ///< Lines with content before this block.
  std::uint64_t lines = 0;  ///< Lines with content in it.
};

/// Lines that hold something.
std::uint64_t count_lines(std::string_view text) {
  const bool line_feeds_only = text.find('\r') == std::string_view::npos;
  const char* end = text.data() + text.size();
  std::uint64_t lines = 0;
  TextCursor cursor(text);
  for (cursor.skip_to_content(); !cursor.at_end(); cursor.skip_to_content()) {
    ++lines;
    if (line_feeds_only) {
      // The library's search for one character is several times as fast as a look at each.
      const void* found = std::memchr(cursor.at(), '\n', cursor.left());
      if (found == nullptr) break;
      const char* at = static_cast<const char*>(found) + 1;
      cursor = TextCursor(std::string_view(at, static_cast<std::size_t>(end - at)));
    } else {
      cursor.skip_to_line_end();
    }
  }
  return lines;
}

/// Cuts text behind line ends into blocks of about `bytes` and numbers their lines.
std::vector<Block> cut_into_blocks(std::string_view text, std::size_t bytes) {
  std::vector<Block> blocks;
  while (!text.empty()) {
    std::size_t end = text.size();
    if (end > bytes) end = std::min(text.find_first_of("\r\n", bytes - 1), end - 1) + 1;
    blocks.push_back({text.substr(0, end), 0, 0});
    text.remove_prefix(end);
  }
  parallel_ranges(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) blocks[b].lines = count_lines(blocks[b].text);
  });
  for (std::size_t b = 1; b < blocks.size(); ++b) blocks[b].first = blocks[b - 1].first + blocks[b - 1].lines;
  return blocks;
}

/// A stretch of the body that holds the elements [first, last) whole, behind `skip` lines of others.
struct Part {
  std::string_view bytes;
  std::uint64_t skip = 0, first = 0, last = 0;
};

/// What the points of a part were like.
struct PartPoints {
  Positions placed;
  NonFinitePoints not_finite;
};

/// What the faces of a part had beside their points.
struct PartFaces {
  std::vector<std::uint64_t> skipped;  ///< Those of fewer than three corners.
  std::vector<float> uv;               ///< Two for each corner.
  std::size_t without_uv = 0;          ///< Corners.
};

template <class Body>
class BodyReader {
 public:
  BodyReader(const Source& source, const Header& header, std::size_t block_bytes, MeshFile& file)
      : source_(source),
        header_(header),
        block_bytes_(block_bytes),
        body_(source, rest_from(header.body)),
        file_(file) {}

  Result<void> read() {
    points_ = header_.find("vertex")->count;
    if (Body::kAscii && body_.left() > block_bytes_)
      blocks_ = cut_into_blocks(rest_from(header_.body), block_bytes_);
    for (const Element& element : header_.elements) {
      VKMESH_CHECK(check_promise(element));
      if (element.name == "vertex")
        VKMESH_CHECK(vertices(element));
      else if (element.name == "face")
        VKMESH_CHECK(faces(element));
      else if (element.name == "tristrips")
        VKMESH_CHECK(strips(element));
      else
        VKMESH_CHECK(other(element));
      if (!element.properties.empty()) lines_ += element.count;
    }
    VKMESH_CHECK(body_.end());
    IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file_.geometry);
    if (mesh.corners.empty() && unknown_faces_ != nullptr)
      return source_.bad_line(unknown_faces_->at, "the only faces stand in element '" + unknown_faces_->name +
                                                      "', which is not known");
    if (source_.positions != nullptr) source_.positions->add(placed_);
    return not_finite_.drop(source_, !Body::kAscii, mesh, file_.notes);
  }

 private:
  [[nodiscard]] std::string_view rest_from(const char* at) const {
    return source_.bytes.substr(static_cast<std::size_t>(at - source_.bytes.data()));
  }

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

  /// The parts in which an element can be read; none where it is to be read in one go.
  [[nodiscard]] std::vector<Part> parts_of(const Element& element) const {
    std::vector<Part> parts;
    if constexpr (Body::kAscii) {
      const std::uint64_t end = lines_ + element.count;
      if (blocks_.empty() || blocks_.back().first + blocks_.back().lines < end) return {};
      for (const Block& block : blocks_) {
        const std::uint64_t from = std::max(block.first, lines_);
        const std::uint64_t to = std::min(block.first + block.lines, end);
        if (from < to) parts.push_back({block.text, from - block.first, from - lines_, to - lines_});
      }
    } else if (!element.has_lists()) {
      const std::uint64_t size = element.least_bytes(false);
      const std::uint64_t step = std::max<std::uint64_t>(block_bytes_ / size, 1);
      for (std::uint64_t first = 0; first < element.count; first += step) {
        const std::uint64_t last = std::min(first + step, element.count);
        parts.push_back({{body_.at() + first * size, (last - first) * size}, 0, first, last});
      }
    }
    return parts;
  }

  /// Reads parts at the same time by rows(body, first, last, number of the part, counted from 1). False when
  /// one of them fails: then nothing is passed over.
  template <class Rows>
  Result<bool> in_parts(const std::vector<Part>& parts, const Rows& rows) {
    constexpr std::size_t kWave = 256;  // Parts between two calls of the progress callback.
    std::atomic<bool> whole = true;
    const char* end = nullptr;
    for (std::size_t wave = 0; wave < parts.size(); wave += kWave) {
      VKMESH_CHECK(source_.tick(std::max(parts[wave].bytes.data(), body_.at())));
      parallel_ranges(std::min(kWave, parts.size() - wave), 1, [&](std::size_t begin, std::size_t stop) {
        for (std::size_t p = wave + begin; p < wave + stop && whole; ++p) {
          Body body(source_, parts[p].bytes);
          body.skip_lines(parts[p].skip);
          if (!rows(body, parts[p].first, parts[p].last, p + 1)) whole = false;
          if (p + 1 == parts.size()) end = body.at();
        }
      });
      if (!whole) return false;
    }
    body_ = Body(source_, rest_from(end));
    return true;
  }

  /// Reads the elements from `first` on in their order.
  template <class Rows>
  Result<void> in_order(const Element& element, std::uint64_t first, const Rows& rows) {
    constexpr std::uint64_t kStep = 65536;  // Elements between two calls of the progress callback.
    for (; first < element.count; first += std::min(kStep, element.count - first)) {
      VKMESH_CHECK(source_.tick(body_.at()));
      VKMESH_CHECK(rows(body_, first, std::min(first + kStep, element.count), 0));
    }
    return {};
  }

  Result<void> scalar(Body& body, const Element& element, std::uint64_t i, const Property& p,
                      const Sink& sink, DVec3& exact) const {
    return with_type(p.type, [&](auto value) -> Result<void> {
      if (!body.scalar(value)) return body.bad(element, i, p);
      if (sink.axis >= 0) exact[sink.axis] = static_cast<double>(value);
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

  Result<void> skip_list(Body& body, const Element& element, std::uint64_t i, const Property& p) const {
    std::uint64_t count = 0;
    VKMESH_CHECK(list_count(body, element, i, p, count));
    return with_type(p.type, [&](auto value) -> Result<void> {
      for (std::uint64_t k = 0; k < count; ++k)
        if (!body.scalar(value)) return body.bad(element, i, p);
      return {};
    });
  }

  Result<void> list_count(Body& body, const Element& element, std::uint64_t i, const Property& p,
                          std::uint64_t& count) const {
    const char* at = body.at();
    return with_type(p.count_type, [&](auto value) -> Result<void> {
      if (!body.scalar(value)) return body.bad(element, i, p);
      if constexpr (std::is_signed_v<decltype(value)>)
        if (value < 0)
          return body.bad(
              at, element.name + " " + std::to_string(i) + ": list '" + p.name + "' has a negative count");
      count = static_cast<std::uint64_t>(value);
      return {};
    });
  }

  Result<void> vertices(const Element& element) {
    IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file_.geometry);
    std::set<const Property*> taken;
    for (const char* name : {"x", "y", "z"}) {
      const Property* p = element.find(name);
      if (p == nullptr || p->list)
        return source_.bad_line(element.at,
                                std::string("element 'vertex' has no scalar property '") + name + "'");
      taken.insert(p);
    }
    const bool moved = source_.offset != DVec3(0.0);
    if constexpr (!Body::kAscii)
      if (is_packed_floats(element) && !moved) return packed_points(mesh.points);
    // Floats lose nothing where they are.
    const bool exact = moved || std::any_of(taken.begin(), taken.end(),
                                            [](const Property* p) { return p->type != Scalar::kFloat; });

    std::vector<Sink> sinks(element.properties.size());
    mesh.points.resize(element.count);
    for (const Property* p : taken)
      if (element.count > 0)
        sinks[static_cast<std::size_t>(p - element.properties.data())] =
            exact ? Sink{nullptr, 0, false, p->name[0] - 'x'}
                  : Sink{reinterpret_cast<std::byte*>(mesh.points.data()) +
                             static_cast<std::size_t>(p->name[0] - 'x') * sizeof(float),
                         sizeof(Vec3), true, -1};
    make_channels(element, group_properties(element, std::move(taken), file_.notes), mesh.point_channels,
                  sinks);

    const auto parts = parts_of(element);
    std::vector<PartPoints> points_of(parts.size() + 1, PartPoints{Positions(source_.offset), {}});
    const auto rows = [&](Body& body, std::uint64_t first, std::uint64_t last,
                          std::size_t part) -> Result<void> {
      PartPoints& seen = points_of[part];
      for (std::uint64_t i = first; i < last; ++i) {
        body.begin_element();
        const char* at = body.at();
        DVec3 coordinates;
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
          const Property& p = element.properties[k];
          VKMESH_CHECK(p.list ? skip_list(body, element, i, p)
                              : scalar(body, element, i, p, sinks[k], coordinates));
        }
        if (exact) mesh.points[i] = seen.placed.place(coordinates);
        if (!all_finite(mesh.points[i])) seen.not_finite.add(i, at);
        if (!body.end_element()) return body.bad_end(element);
      }
      return {};
    };
    bool whole = false;
    if (parts.size() > 1) {
      VKMESH_TRY(whole, in_parts(parts, rows));
    }
    if (!whole) {
      points_of.assign(1, PartPoints{Positions(source_.offset), {}});
      VKMESH_CHECK(in_order(element, 0, rows));
    }
    for (const PartPoints& seen : points_of) {
      placed_.add(seen.placed);
      not_finite_.add(seen.not_finite);
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

  /// Nothing but coordinates: a piece at a time, which the processor's first cache holds.
  Result<void> packed_points(std::vector<Vec3>& points) {
    std::array<Vec3, 1024> piece;
    points.reserve(points_);
    while (points.size() < points_) {
      if (Source::due(points.size())) VKMESH_CHECK(source_.tick(body_.at()));
      const std::size_t count = std::min<std::size_t>(piece.size(), points_ - points.size());
      bool finite = true;
      for (std::size_t i = 0; i < count; ++i) {
        const char* at = body_.at() + i * sizeof(Vec3);
        for (int axis = 0; axis < 3; ++axis)
          piece[i][axis] =
              Body::template value_at<float>(at + static_cast<std::size_t>(axis) * sizeof(float));
        finite = finite && all_finite(piece[i]);
      }
      for (std::size_t i = 0; i < count && !finite; ++i)
        if (!all_finite(piece[i])) not_finite_.add(points.size() + i, body_.at() + i * sizeof(Vec3));
      points.insert(points.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(count));
      body_.advance(count * sizeof(Vec3));
    }
    return {};
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
    // MeshLab and others give corners their texture coordinates so.
    const Property* wedges = element.find("texcoord");
    if (wedges != nullptr && (!wedges->list || is_integer(wedges->type))) wedges = nullptr;
    std::vector<Sink> sinks(element.properties.size());
    std::set<const Property*> taken = {indices};
    if (wedges != nullptr) taken.insert(wedges);
    make_channels(element, group_properties(element, std::move(taken), file_.notes), mesh.face_channels,
                  sinks);

    // In these types any index that names a point is a number.
    const bool triangles = Body::kAscii && element.properties.size() == 1 && size_of(indices->type) == 4 &&
                           points_ <= std::numeric_limits<std::int32_t>::max();
    const auto parts = parts_of(element);
    std::vector<IndexedFaceSet> faces_of(parts.size());  // What each part holds.
    std::vector<PartFaces> seen_of(parts.size() + 1);
    const auto rows = [&](Body& body, std::uint64_t first, std::uint64_t last,
                          std::size_t part) -> Result<void> {
      IndexedFaceSet& into = part == 0 ? mesh : faces_of[part - 1];
      PartFaces& seen = seen_of[part];
      FaceCollector collector(into);
      collector.start_with_triangles(into.face_count());
      std::vector<float> uv;
      DVec3 unused;
      // Room for triangles, but for no more than there is: a corner takes two bytes of text or at least one
      // of binary.
      const std::uint64_t least = Body::kAscii ? 2 : size_of(indices->type);
      if (into.corners.empty())
        into.corners.reserve(
            std::min<std::uint64_t>(3 * (part == 0 ? element.count : last - first), body.left() / least));
      for (std::uint64_t i = first; i < last; ++i) {
        body.begin_element();
        if (triangles && triangle(body, into, collector)) continue;
        const char* at = body.at();
        const std::size_t before = into.corners.size();
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
          const Property& p = element.properties[k];
          if (&p == indices) {
            VKMESH_TRY(const bool kept, face(body, element, i, p, at, collector));
            if (!kept) seen.skipped.push_back(i);
          } else if (&p == wedges) {
            VKMESH_CHECK(list(body, element, i, p, uv));
          } else {
            VKMESH_CHECK(p.list ? skip_list(body, element, i, p)
                                : scalar(body, element, i, p, sinks[k], unused));
          }
        }
        if (wedges != nullptr) {
          const std::size_t corners = into.corners.size() - before;
          if (uv.size() != 2 * corners) seen.without_uv += corners;
          uv.resize(uv.size() == 2 * corners ? uv.size() : 0);
          uv.resize(2 * corners, 0.0f);
          seen.uv.insert(seen.uv.end(), uv.begin(), uv.end());
        }
        if (!body.end_element()) return body.bad_end(element);
      }
      return {};
    };
    if (parts.size() > 1) {
      VKMESH_TRY(const bool whole, in_parts(parts, rows));
      if (whole && join(faces_of, mesh)) {
        finish_faces(seen_of, wedges != nullptr, element.count, mesh);
        return {};
      }
      faces_of.clear();
      seen_of.assign(1, {});
    }
    std::uint64_t done = 0;
    if constexpr (!Body::kAscii)
      if (element.properties.size() == 1 && indices->count_type == Scalar::kUint8 &&
          size_of(indices->type) == 4) {
        VKMESH_TRY(done, packed_triangles(element, mesh.corners));
      }
    VKMESH_CHECK(in_order(element, done, rows));
    finish_faces(seen_of, wedges != nullptr, element.count, mesh);
    return {};
  }

  /// Drops what face channels hold of skipped faces, and makes the channel of the corners' texture
  /// coordinates.
  void finish_faces(const std::vector<PartFaces>& seen_of, bool has_wedges, std::uint64_t count,
                    IndexedFaceSet& mesh) {
    std::size_t skipped = 0, without_uv = 0;
    for (const PartFaces& seen : seen_of) {
      skipped += seen.skipped.size();
      without_uv += seen.without_uv;
    }
    if (skipped > 0) {
      std::vector<bool> is_kept(count, true);
      for (const PartFaces& seen : seen_of)
        for (const std::uint64_t f : seen.skipped) is_kept[f] = false;
      std::vector<std::uint32_t> kept;
      kept.reserve(count - skipped);
      for (std::uint64_t f = 0; f < count; ++f)
        if (is_kept[f]) kept.push_back(static_cast<std::uint32_t>(f));
      mesh.face_channels = gather(mesh.face_channels, kept);
      note_small_faces(file_.notes, skipped);
    }
    if (!has_wedges || without_uv == mesh.corners.size()) return;
    std::vector<float> uv;
    uv.reserve(2 * mesh.corners.size());
    for (const PartFaces& seen : seen_of) uv.insert(uv.end(), seen.uv.begin(), seen.uv.end());
    if (without_uv > 0)
      file_.notes.push_back({"partial.uv", std::to_string(without_uv) + " corners without 'uv' got 0"});
    mesh.corner_channels.push_back({"uv", 2, std::move(uv)});
  }

  /// Triangle strips, as in files of the Stanford archive: lists of points in which -1 begins another strip.
  Result<void> strips(const Element& element) {
    IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file_.geometry);
    const Property* indices = element.find("vertex_indices");
    if (indices == nullptr) indices = element.find("vertex_index");
    if (indices == nullptr || !indices->list || !is_integer(indices->type)) return other(element);
    for (Channel& channel : mesh.face_channels)
      file_.notes.push_back({"dropped." + channel.name, "face channel '" + channel.name +
                                                            "' ignored: the triangles of strips have none"});
    mesh.face_channels.clear();
    if (!mesh.corner_channels.empty()) {
      file_.notes.push_back({"dropped.uv", "corner channel 'uv' ignored: the triangles of strips have none"});
      mesh.corner_channels.clear();
    }
    FaceCollector collector(mesh);
    collector.start_with_triangles(mesh.face_count());
    std::size_t turns = 0;
    const auto rows = [&](Body& body, std::uint64_t first, std::uint64_t last, std::size_t) -> Result<void> {
      DVec3 unused;
      for (std::uint64_t i = first; i < last; ++i) {
        body.begin_element();
        for (const Property& p : element.properties) {
          if (&p == indices)
            VKMESH_CHECK(strip(body, element, i, p, collector, turns));
          else
            VKMESH_CHECK(p.list ? skip_list(body, element, i, p)
                                : scalar(body, element, i, p, Sink{}, unused));
        }
        if (!body.end_element()) return body.bad_end(element);
      }
      return {};
    };
    VKMESH_CHECK(in_order(element, 0, rows));
    if (turns > 0)
      file_.notes.push_back({"skipped.strip_turns",
                             std::to_string(turns) + " triangles without area that join strips ignored"});
    return {};
  }

  Result<void> strip(Body& body, const Element& element, std::uint64_t i, const Property& p,
                     FaceCollector& collector, std::size_t& turns) const {
    std::uint64_t count = 0;
    VKMESH_CHECK(list_count(body, element, i, p, count));
    return with_type(p.type, [&](auto index) -> Result<void> {
      std::array<std::uint32_t, 3> last{};
      std::uint64_t in_strip = 0;
      for (std::uint64_t k = 0; k < count; ++k) {
        if (Source::due(k)) VKMESH_CHECK(source_.tick(body.at()));
        const char* at = body.at();
        if (!body.scalar(index)) return body.bad(element, i, p);
        if constexpr (std::is_signed_v<decltype(index)>)
          if (index == -1) {
            in_strip = 0;
            continue;
          }
        if (index < 0 || static_cast<std::uint64_t>(index) >= points_)
          return bad_index(body, at, i, std::to_string(index));
        last = {last[1], last[2], static_cast<std::uint32_t>(index)};
        if (++in_strip < 3) continue;
        if (last[0] == last[1] || last[1] == last[2] || last[2] == last[0]) {
          ++turns;
          continue;
        }
        // Every second triangle is turned so that all face one way.
        const bool odd = in_strip % 2 == 0;
        for (const std::size_t corner :
             {std::size_t{odd ? 1u : 0u}, std::size_t{odd ? 0u : 1u}, std::size_t{2}})
          collector.corner(last[corner]);
        if (collector.end_face(3) == FaceCollector::Face::kTooMany)
          return body.bad(at, "the faces have more corners than 32-bit indices can number");
      }
      return {};
    });
  }

  /// The values of a list.
  Result<void> list(Body& body, const Element& element, std::uint64_t i, const Property& p,
                    std::vector<float>& to) const {
    std::uint64_t count = 0;
    VKMESH_CHECK(list_count(body, element, i, p, count));
    to.clear();
    return with_type(p.type, [&](auto value) -> Result<void> {
      for (std::uint64_t k = 0; k < count; ++k) {
        if (!body.scalar(value)) return body.bad(element, i, p);
        to.push_back(static_cast<float>(value));
      }
      return {};
    });
  }

  /// Puts the faces of the parts together. False, with nothing done, when there are more corners than 32-bit
  /// indices can number.
  static bool join(std::vector<IndexedFaceSet>& parts, IndexedFaceSet& mesh) {
    std::size_t corners = 0, faces = 0;
    bool triangles = true;
    for (const IndexedFaceSet& part : parts) {
      corners += part.corners.size();
      faces += part.face_count();
      triangles = triangles && part.is_triangles();
    }
    if (corners > kMaxElements) return false;
    mesh.corners.reserve(corners);
    if (!triangles) {
      mesh.face_offsets.reserve(faces + 1);
      mesh.face_offsets.push_back(0);
    }
    for (IndexedFaceSet& part : parts) {
      mesh.corners.insert(mesh.corners.end(), part.corners.begin(), part.corners.end());
      if (!triangles)
        for (std::size_t f = 0; f < part.face_count(); ++f)
          mesh.face_offsets.push_back(mesh.face_offsets.back() +
                                      static_cast<std::uint32_t>(part.face(f).size()));
      part = {};
    }
    return true;
  }

  /// A line that is a triangle and nothing else, as most are. False, with nothing passed over, for any other.
  bool triangle(Body& body, const IndexedFaceSet& into, FaceCollector& collector) const {
    Body cursor = body;
    std::uint32_t count = 0;
    std::array<std::uint32_t, 3> corners{};
    if (!cursor.scalar(count) || count != 3 || into.corners.size() + 3 > kMaxElements) return false;
    for (std::uint32_t& c : corners)
      if (!cursor.scalar(c) || c >= points_) return false;
    if (!cursor.end_element()) return false;
    for (const std::uint32_t c : corners) collector.corner(c);
    body = cursor;
    return collector.end_face(3) == FaceCollector::Face::kKept;
  }

  /// Whether the face is kept.
  Result<bool> face(Body& body, const Element& element, std::uint64_t i, const Property& p, const char* at,
                    FaceCollector& collector) const {
    std::uint64_t count = 0;
    VKMESH_CHECK(list_count(body, element, i, p, count));
    VKMESH_CHECK(with_type(p.type, [&](auto index) -> Result<void> {
      for (std::uint64_t k = 0; k < count; ++k) {
        const char* corner_at = body.at();
        if (!body.scalar(index)) return body.bad(element, i, p);
        if (index < 0 || static_cast<std::uint64_t>(index) >= points_)
          return bad_index(body, corner_at, i, std::to_string(index));
        collector.corner(static_cast<std::uint32_t>(index));
      }
      return {};
    }));
    const FaceCollector::Face kept = collector.end_face(count);
    if (kept == FaceCollector::Face::kTooMany)
      return body.bad(at, "the faces have more corners than 32-bit indices can number");
    return kept == FaceCollector::Face::kKept;
  }

  tl::unexpected<Error> bad_index(const Body& body, const char* at, std::uint64_t face,
                                  const std::string& index) const {
    return body.bad(at, "face " + std::to_string(face) + " names vertex " + index + ", but there are " +
                            std::to_string(points_) + " vertices, counted from 0");
  }

  /// Triangles as nearly every binary file has them: one byte 3, three 4-byte indices, a piece at a time.
  /// Returns how many faces it took: all, or those before the first that is something else.
  Result<std::uint64_t> packed_triangles(const Element& element, std::vector<std::uint32_t>& corners) {
    constexpr std::size_t kIndex = sizeof(std::uint32_t), kFace = 1 + 3 * kIndex, kPiece = 1024;
    std::array<std::uint32_t, 3 * kPiece> piece;
    const std::uint64_t fit = std::min(element.count, body_.left() / kFace);
    corners.reserve(3 * fit);
    std::uint64_t done = 0;
    for (std::uint64_t count = kPiece; count == kPiece; done += count) {
      if (Source::due(done)) VKMESH_CHECK(source_.tick(body_.at()));
      const char* from = body_.at();
      std::uint32_t highest = 0;
      for (count = 0; count < std::min<std::uint64_t>(kPiece, fit - done) && from[count * kFace] == 3;
           ++count)
        for (std::size_t k = 0; k < 3; ++k) {
          const auto corner = Body::template value_at<std::uint32_t>(from + count * kFace + 1 + k * kIndex);
          piece[3 * count + k] = corner;
          highest = std::max(highest, corner);
        }
      for (std::size_t c = 0; c < 3 * count && highest >= points_; ++c)
        if (piece[c] >= points_)
          return bad_index(body_, from + c / 3 * kFace + 1 + c % 3 * kIndex, done + c / 3,
                           element.properties[0].type == Scalar::kInt32
                               ? std::to_string(static_cast<std::int32_t>(piece[c]))
                               : std::to_string(piece[c]));
      corners.insert(corners.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(3 * count));
      body_.advance(count * kFace);
    }
    return done;
  }

  Result<void> other(const Element& element) {
    if (element.count > 0) {
      file_.notes.push_back(
          {"dropped.element", std::to_string(element.count) + " of element '" + element.name + "' ignored"});
      const auto names_points = [](const Property& p) {
        return p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
      };
      if (std::any_of(element.properties.begin(), element.properties.end(), names_points))
        unknown_faces_ = &element;
    }
    return body_.skip(element);
  }

  const Source& source_;
  const Header& header_;
  std::size_t block_bytes_;
  Body body_;
  MeshFile& file_;
  std::uint64_t points_ = 0;
  Positions placed_{source_.offset};
  NonFinitePoints not_finite_;
  const Element* unknown_faces_ = nullptr;  ///< An ignored element whose lists name points.
  std::vector<Block> blocks_;               ///< Parts of a text that is long enough for more than one.
  std::uint64_t lines_ = 0;                 ///< Lines of the elements before the present one.
};

}  // namespace

Result<MeshFile> parse(const Source& source, std::size_t block_bytes) {
  VKMESH_TRY(const Header header, read_header(source));
  if (header.find("vertex") == nullptr)
    return source.bad_line(header.body - 1, "the header has no element 'vertex'");
  MeshFile file;
  file.geometry = IndexedFaceSet{};
  file.format = FileFormat::kPly;
  file.encoding = header.encoding;
  const auto read = [&](auto body) -> Result<void> {
    return BodyReader<decltype(body)>(source, header, block_bytes, file).read();
  };
  switch (header.encoding) {
    case FileEncoding::kAscii:
      VKMESH_CHECK(read(AsciiBody(source, {})));
      break;
    case FileEncoding::kBinaryLittleEndian:
      VKMESH_CHECK(read(BinaryBody<false>(source, {})));
      break;
    case FileEncoding::kBinaryBigEndian:
      VKMESH_CHECK(read(BinaryBody<true>(source, {})));
      break;
  }
  return file;
}

}  // namespace vkmesh::detail::ply

namespace vkmesh::detail {

Result<MeshFile> parse_ply(const Source& source) {
  return ply::parse(source, ply::kBlockBytes);
}

}  // namespace vkmesh::detail
