// Writing glTF 2.0 and GLB.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <span>
#include <streambuf>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <vkmesh/math/bounds.h>
#include <vkmesh/mesh/handles.h>

#include "base/distinct_rows.h"
#include "io/formats.h"
#include "io/gltf/gltf.h"
#include "io/gltf/tinygltf.h"

namespace vkmesh::detail {
namespace {

using Json = nlohmann::json;

/// Passes on what is written to a stream.
class OutputStream : public std::streambuf {
 public:
  explicit OutputStream(Output& out) : out_(out) {}

 private:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    out_.put({bytes, static_cast<std::size_t>(count)});
    return count;
  }
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    out_.put({&byte, 1});
    return c;
  }

  Output& out_;
};

/// Text as JSON must have it: bytes that are no UTF-8 become the replacement character.
std::string valid_utf8(const std::string& text) {
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(quoted).get<std::string>();
}

/// "_QUALITY" for "quality"; empty for a name that would not come back.
std::string attribute_name(const std::string& channel) {
  std::string name = "_";
  for (const char c : channel) {
    if (!(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c != '_') return "";
    name += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return name.size() > 1 && gltf_channel_name(name) == channel ? name : "";
}

/// Normals whose squared length is this near to 1 are unit vectors.
constexpr double kUnit = 1e-5;

/// The buffer of a file and what stands in it, of one mesh or of several.
class GltfFile {
 public:
  /// Leaves room for the JSON in the 32-bit length of a GLB file.
  static constexpr std::size_t kLargest = 0xffffffffu - (std::size_t{1} << 24);

  /// A buffer view and accessor over elements of `width` components that were appended from byte `begin` on.
  template <class T>
  int accessor(std::size_t begin, std::size_t count, unsigned width, std::size_t stride, int target,
               bool normalized) {
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = begin;
    view.byteLength = bytes.size() - begin;
    view.byteStride = stride == width * sizeof(T) ? 0 : stride;
    view.target = target;
    model.bufferViews.push_back(view);
    // Every view begins at a multiple of 4.
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return accessor_of<T>(static_cast<int>(model.bufferViews.size()) - 1, count, width, normalized);
  }

  /// The same over elements of vertices under this name. Where an earlier mesh has begun with the same, they
  /// are taken from there, and the appended bytes let go.
  template <class T>
  int vertex_accessor(const std::string& name, std::size_t begin, std::size_t count, unsigned width,
                      std::size_t stride, bool normalized) {
    const std::size_t size = bytes.size() - begin;
    const auto [known, is_new] = view_of_.try_emplace(name, static_cast<int>(model.bufferViews.size()));
    if (!is_new) {
      tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(known->second)];
      const tinygltf::Accessor& first = model.accessors[first_accessor_[name]];
      const bool alike = first.type == type_of(width) && first.componentType == component_type<T>() &&
                         first.normalized == normalized && size <= view.byteLength;
      if (alike && std::memcmp(&bytes[view.byteOffset], &bytes[begin], size) == 0) {
        bytes.resize(begin);
        view.byteStride = stride;  // which a view of several accessors has to say
        return accessor_of<T>(known->second, count, width, normalized);
      }
      known->second = static_cast<int>(model.bufferViews.size());
    }
    first_accessor_[name] = model.accessors.size();
    return accessor<T>(begin, count, width, stride, TINYGLTF_TARGET_ARRAY_BUFFER, normalized);
  }

  /// The materials of these names, in their order; -1 for an empty name, which stands for none.
  std::vector<int> materials(const std::vector<std::string>& names) {
    const auto [known, is_new] = materials_of_.try_emplace(names);
    if (!is_new) return known->second;
    for (const std::string& name : names) {
      known->second.push_back(name.empty() ? -1 : static_cast<int>(model.materials.size()));
      if (name.empty()) continue;
      model.materials.emplace_back();
      model.materials.back().name = valid_utf8(name);
    }
    return known->second;
  }

  template <class T>
  void append(T value) {
    const auto* from = reinterpret_cast<const unsigned char*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(value));
  }

  /// With the nodes that were added, of which those of the scene are its roots.
  Result<void> write(const WriteOptions& options, const tinygltf::Scene& scene, Output& out) {
    if (bytes.size() > kLargest) return fail(ErrorCode::kUnsuitable, "a glTF buffer holds less than 4 GiB");
    model.asset.version = "2.0";
    if (const std::vector<std::string> comment = comment_lines(options.comment); !comment.empty())
      model.asset.generator = valid_utf8(comment.front());
    tinygltf::Buffer buffer;
    buffer.data = std::move(bytes);
    model.buffers.push_back(std::move(buffer));
    model.scenes.push_back(scene);
    model.defaultScene = 0;
    OutputStream streambuf(out);
    std::ostream stream(&streambuf);
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, true,
                                                options.encoding != FileEncoding::kAscii);
    return {};
  }

  std::vector<unsigned char> bytes;
  tinygltf::Model model;

 private:
  static int type_of(unsigned width) {
    static constexpr int kTypes[] = {TINYGLTF_TYPE_SCALAR, TINYGLTF_TYPE_VEC2, TINYGLTF_TYPE_VEC3,
                                     TINYGLTF_TYPE_VEC4};
    return kTypes[width - 1];
  }
  template <class T>
  static constexpr int component_type() {
    return std::is_same_v<T, float>           ? TINYGLTF_COMPONENT_TYPE_FLOAT
           : std::is_same_v<T, std::int8_t>   ? TINYGLTF_COMPONENT_TYPE_BYTE
           : std::is_same_v<T, std::uint8_t>  ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE
           : std::is_same_v<T, std::int16_t>  ? TINYGLTF_COMPONENT_TYPE_SHORT
           : std::is_same_v<T, std::uint16_t> ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT
                                              : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  }
  template <class T>
  int accessor_of(int view, std::size_t count, unsigned width, bool normalized) {
    tinygltf::Accessor a;
    a.bufferView = view;
    a.componentType = component_type<T>();
    a.count = count;
    a.type = type_of(width);
    a.normalized = normalized;
    model.accessors.push_back(a);
    return static_cast<int>(model.accessors.size()) - 1;
  }

  std::map<std::string, int> view_of_;                 // of vertices, by the name of what they hold
  std::map<std::string, std::size_t> first_accessor_;  // over that view
  std::map<std::vector<std::string>, std::vector<int>> materials_of_;
};

/// Attributes of corners around a point, numbered by first appearance.
struct CornerRows {
  using Row = std::array<float, 11>;  // The point in two exact halves, a normal, uv, a colour.
  DistinctRows<11> distinct;
  std::vector<Row> rows;
  std::vector<std::uint32_t> point;  // of each row
};

/// Puts one mesh into a file.
class GltfMesh {
 public:
  GltfMesh(GltfFile& file, const IndexedFaceSet& mesh, Notes& notes)
      : file_(file), bytes_(file.bytes), model_(file.model), mesh_(mesh), notes_(notes) {
    choose();
  }

  /// Settles what its vertices are.
  void split() {
    CornerRows rows;
    static_cast<void>(split(rows));
  }
  /// The same, numbered on from those of coarser meshes, of whose points and rows it has all. False, with
  /// nothing done, where it has not.
  [[nodiscard]] bool split(CornerRows& rows) { return split_into(rows); }

  /// Appends the mesh to the model.
  void put(const std::string& name) {
    put_positions();
    put_normals();
    put_uv();
    put_colors();
    for (const Channel* c : custom_) put_custom(*c);
    put_faces();
    model_.meshes.back().name = name;
  }

 private:
  /// An attribute of points or corners that goes into the file.
  struct Attribute {
    const Channel* channel = nullptr;
    bool of_corners = false;
    explicit operator bool() const { return channel != nullptr; }
  };

  /// Settles which channels are written, and notes the others.
  void choose() {
    const auto pick = [&](const char* name, unsigned least, unsigned most) -> Attribute {
      const Channel* c = mesh_.corners.empty() ? nullptr : find_channel(mesh_.corner_channels, name);
      if (c != nullptr && c->components >= least && c->components <= most && finite(*c)) return {c, true};
      c = find_channel(mesh_.point_channels, name);
      if (c != nullptr && c->components >= least && c->components <= most && finite(*c)) return {c, false};
      return {};
    };
    normal_ = pick("normal", 3, 3);
    uv_ = pick("uv", 2, 2);
    color_ = pick("color", 3, 4);
    std::size_t zero = 0;
    for (std::size_t i = 0; normal_ && i < normal_.channel->scalar_count(); i += 3)
      zero += !(squared_length(*normal_.channel, i) > 0);
    const Channel* zero_normals = nullptr;
    if (zero > 0 && 3 * zero == normal_.channel->scalar_count()) {
      note_left_out(notes_, normal_.of_corners ? "corner" : "point", *normal_.channel,
                    "glTF holds unit normals, and these have no length");
      zero_normals = normal_.channel;
      normal_ = {};
    } else if (zero > 0) {
      notes_.push_back(
          {"replaced.normal", std::to_string(zero) +
                                  " normals without length written as (0, 0, 1): glTF holds unit "
                                  "normals"});
    }
    const auto taken = [&](const Channel& c) {
      return &c == normal_.channel || &c == uv_.channel || &c == color_.channel || &c == zero_normals;
    };
    for (const Channel& c : mesh_.point_channels) {
      if (taken(c)) continue;
      if (!finite(c))
        note_left_out(notes_, "point", c, "some of its values are not finite");
      else if (c.components >= 1 && c.components <= 4 && !attribute_name(c.name).empty() &&
               c.labels.empty() && !std::holds_alternative<std::vector<double>>(c.values) &&
               !std::holds_alternative<std::vector<std::int32_t>>(c.values) &&
               !std::holds_alternative<std::vector<std::uint32_t>>(c.values))
        custom_.push_back(&c);
      else
        note_left_out(notes_, "point", c, "glTF holds none of that name and type");
    }
    for (const Channel& c : mesh_.corner_channels)
      if (!taken(c))
        note_left_out(notes_, "corner", c,
                      finite(c) ? "glTF holds normals, uv and colours of corners"
                                : "some of its values are not finite");
    for (const Channel& c : mesh_.face_channels) {
      if (c.name == "material" && numbers_labels(c))
        material_ = &c;
      else
        note_left_out(notes_, "face", c, "glTF holds named materials of faces");
    }
  }

  static bool finite(const Channel& channel) {
    const std::size_t count = channel.scalar_count();
    for (std::size_t i = 0; i < count; ++i)
      if (!std::isfinite(channel_float(channel, i))) return false;
    return true;
  }

  static double squared_length(const Channel& channel, std::size_t i) {
    const DVec3 n(channel_float(channel, i), channel_float(channel, i + 1), channel_float(channel, i + 2));
    return glm::dot(n, n);
  }

  static std::optional<std::size_t> label_of(const Channel& channel, std::size_t face) {
    const double value =
        std::visit([&](const auto& v) { return static_cast<double>(v[face]); }, channel.values);
    if (!(value >= 0 && value < static_cast<double>(channel.labels.size())) || value != std::floor(value))
      return std::nullopt;
    return static_cast<std::size_t>(value);
  }

  bool numbers_labels(const Channel& channel) const {
    if (channel.components != 1) return false;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f)
      if (!label_of(channel, f)) return false;
    return true;
  }

  /// Where the attribute of a vertex of the file stands.
  [[nodiscard]] std::size_t source_of(const Attribute& attribute, std::size_t vertex) const {
    return attribute.of_corners ? vertex_corner_[vertex] : vertex_point_[vertex];
  }

  /// A vertex for each point; or, where corners have attributes, for each different row of those around a
  /// point, in order of first appearance, and for each point without corners at last.
  bool split_into(CornerRows& rows) {
    indices_ = mesh_.corners;
    vertex_corner_.clear();
    vertex_point_.resize(mesh_.points.size());
    for (std::size_t i = 0; i < vertex_point_.size(); ++i) vertex_point_[i] = static_cast<std::uint32_t>(i);
    const std::array<Attribute, 3> attributes = {normal_, uv_, color_};
    if (std::none_of(attributes.begin(), attributes.end(),
                     [](const Attribute& a) { return a && a.of_corners; }))
      return true;
    std::vector<bool> used(mesh_.points.size());
    vertex_corner_.assign(rows.point.size(), kInvalid);
    std::size_t found = 0;
    for (std::size_t c = 0; c < mesh_.corners.size(); ++c) {
      const std::uint32_t point = mesh_.corners[c];
      CornerRows::Row row = {static_cast<float>(point & 0xffffu), static_cast<float>(point >> 16)};
      std::size_t at = 2;
      for (const Attribute& a : attributes)
        if (a && a.of_corners)
          for (unsigned k = 0; k < a.channel->components; ++k)
            row[at++] = channel_float(*a.channel, c * a.channel->components + k);
      indices_[c] = rows.distinct.number(row.data(), rows.rows);
      used[point] = true;
      if (indices_[c] == rows.point.size()) {
        rows.point.push_back(point);
        vertex_corner_.push_back(kInvalid);
      }
      if (vertex_corner_[indices_[c]] != kInvalid) continue;
      vertex_corner_[indices_[c]] = static_cast<std::uint32_t>(c);
      ++found;
    }
    if (found < rows.point.size()) return false;
    vertex_point_ = rows.point;
    // No corner gives them attributes, so they have none.
    std::size_t alone = 0;
    for (std::size_t i = 0; i < used.size(); ++i) alone += !used[i];
    if (alone > 0)
      notes_.push_back(
          {"dropped.isolated_points",
           std::to_string(alone) + " points without a face left out: they have no attributes of corners"});
    return true;
  }

  /// One element for each vertex: value(vertex, k) gives its component k. Elements begin at multiples of 4
  /// bytes.
  template <class T, class Value>
  int put_vertices(const std::string& name, unsigned width, bool normalized, Value&& value) {
    const std::size_t begin = bytes_.size(), stride = (width * sizeof(T) + 3) / 4 * 4;
    for (std::size_t v = 0; v < vertex_point_.size(); ++v) {
      for (unsigned k = 0; k < width; ++k) file_.append(static_cast<T>(value(v, k)));
      bytes_.resize(begin + (v + 1) * stride);
    }
    const int index = file_.vertex_accessor<T>(name, begin, vertex_point_.size(), width, stride, normalized);
    attributes_[name] = index;
    return index;
  }

  void put_positions() {
    const int index = put_vertices<float>("POSITION", 3, false, [&](std::size_t v, unsigned k) {
      return mesh_.points[vertex_point_[v]][static_cast<int>(k)];
    });
    Bounds bounds;
    for (const std::uint32_t point : vertex_point_) bounds.add(mesh_.points[point]);
    const auto& [low, high] = bounds;
    tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(index)];
    a.minValues = {low.x, low.y, low.z};
    a.maxValues = {high.x, high.y, high.z};
  }

  void put_normals() {
    if (!normal_) return;
    std::size_t scaled = 0;
    put_vertices<float>("NORMAL", 3, false, [&](std::size_t v, unsigned k) {
      const std::size_t from = 3 * source_of(normal_, v);
      const double squared = squared_length(*normal_.channel, from);
      if (!(squared > 0)) return k == 2 ? 1.0f : 0.0f;
      const float value = channel_float(*normal_.channel, from + k);
      if (std::abs(squared - 1) <= kUnit) return value;
      scaled += k == 0;
      return static_cast<float>(value / std::sqrt(squared));
    });
    if (scaled > 0)
      notes_.push_back({"replaced.normal", std::to_string(scaled) + " normals brought to unit length"});
  }

  void put_uv() {
    if (!uv_) return;
    // Downwards in glTF, upwards here.
    put_vertices<float>("TEXCOORD_0", 2, false, [&](std::size_t v, unsigned k) {
      const float value = channel_float(*uv_.channel, 2 * source_of(uv_, v) + k);
      return k == 1 ? 1 - value : value;
    });
  }

  void put_colors() {
    if (!color_) return;
    const Channel& c = *color_.channel;
    const auto from = [&](std::size_t v, unsigned k) { return source_of(color_, v) * c.components + k; };
    if (std::holds_alternative<std::vector<std::uint8_t>>(c.values)) {
      put_vertices<std::uint8_t>("COLOR_0", c.components, true,
                                 [&](std::size_t v, unsigned k) { return color_byte(c, from(v, k)); });
      return;
    }
    std::size_t clamped = 0;
    put_vertices<float>("COLOR_0", c.components, false, [&](std::size_t v, unsigned k) {
      const float value = color_fraction(c, from(v, k)), within = std::clamp(value, 0.0f, 1.0f);
      clamped += value != within;
      return within;
    });
    if (clamped > 0)
      notes_.push_back(
          {"replaced.color", std::to_string(clamped) + " components of colours brought between 0 and 1"});
  }

  void put_custom(const Channel& channel) {
    std::visit(
        [&](const auto& values) {
          using T = std::decay_t<decltype(values[0])>;
          if constexpr (std::is_same_v<T, float> || sizeof(T) < 4)
            put_vertices<T>(
                attribute_name(channel.name), channel.components, false,
                [&](std::size_t v, unsigned k) { return values[vertex_point_[v] * channel.components + k]; });
        },
        channel.values);
  }

  /// One primitive for each material that faces have, in the order of the labels; faces keep their order
  /// within it.
  void put_faces() {
    model_.meshes.emplace_back();
    if (mesh_.face_count() == 0) {
      add_primitive(TINYGLTF_MODE_POINTS, -1, -1);
      return;
    }
    if (material_ == nullptr) {
      add_primitive(TINYGLTF_MODE_TRIANGLES, put_indices(indices_), -1);
      return;
    }
    std::vector<std::vector<std::uint32_t>> of_label(material_->labels.size());
    for (std::size_t f = 0; f < mesh_.face_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k) of_label[*label_of(*material_, f)].push_back(indices_[3 * f + k]);
    const std::vector<int> materials = file_.materials(material_->labels);
    for (std::size_t label = 0; label < of_label.size(); ++label)
      if (!of_label[label].empty())
        add_primitive(TINYGLTF_MODE_TRIANGLES, put_indices(of_label[label]), materials[label]);
  }

  int put_indices(const std::vector<std::uint32_t>& indices) {
    const std::size_t begin = bytes_.size();
    // 65,535 restarts primitives, and so is no index.
    const bool small = vertex_point_.size() <= 0xffff;
    for (const std::uint32_t i : indices) {
      if (small)
        file_.append(static_cast<std::uint16_t>(i));
      else
        file_.append(i);
    }
    constexpr int kTarget = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
    return small ? file_.accessor<std::uint16_t>(begin, indices.size(), 1, sizeof(std::uint16_t), kTarget,
                                                 false)
                 : file_.accessor<std::uint32_t>(begin, indices.size(), 1, sizeof(std::uint32_t), kTarget,
                                                 false);
  }

  void add_primitive(int mode, int indices, int material) {
    tinygltf::Primitive primitive;
    primitive.attributes = attributes_;
    primitive.indices = indices;
    primitive.material = material;
    primitive.mode = mode;
    model_.meshes.back().primitives.push_back(primitive);
  }

  GltfFile& file_;
  std::vector<unsigned char>& bytes_;
  tinygltf::Model& model_;
  const IndexedFaceSet& mesh_;
  Notes& notes_;
  Attribute normal_, uv_, color_;
  std::vector<const Channel*> custom_;
  const Channel* material_ = nullptr;
  std::vector<std::uint32_t> indices_, vertex_point_, vertex_corner_;
  std::map<std::string, int> attributes_;
};

tinygltf::Node node_at(const DVec3& offset) {
  tinygltf::Node node;
  if (offset != DVec3(0.0)) node.translation = {offset.x, offset.y, offset.z};
  return node;
}

}  // namespace

Result<void> encode_gltf(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  GltfFile file;
  GltfMesh writer(file, mesh, notes);
  writer.split();
  writer.put("");
  tinygltf::Node node = node_at(options.offset);
  node.mesh = 0;
  file.model.nodes.push_back(node);
  tinygltf::Scene scene;
  scene.nodes = {0};
  return file.write(options, scene, out);
}

Result<void> encode_gltf_levels(std::span<const IndexedFaceSet> levels, const LevelWriteOptions& options,
                                const WriteOptions& write, Output& out, Notes& notes) {
  GltfFile file;
  std::vector<Notes> of_level(levels.size());
  std::vector<GltfMesh> writers;
  writers.reserve(levels.size());
  for (std::size_t k = 0; k < levels.size(); ++k) writers.emplace_back(file, levels[k], of_level[k]);
  // Vertices are numbered from the coarsest level on, so that each has the first of those of the next.
  CornerRows rows;
  bool shared = options.shared_points;
  for (std::size_t k = levels.size(); k-- > 0;) {
    if (shared && !writers[k].split(rows)) shared = false;
    if (!shared) writers[k].split();
  }
  const std::string name = valid_utf8(options.name);
  const auto name_of_level = [&](std::size_t k) { return name + "_LOD" + std::to_string(k); };
  for (std::size_t k = 0; k < levels.size(); ++k) {
    writers[k].put(name_of_level(k));
    // What holds for several levels is told once.
    for (const FileNote& note : of_level[k])
      if (std::ranges::find(notes, note.code, &FileNote::code) == notes.end()) notes.push_back(note);
  }

  tinygltf::Scene scene;
  scene.nodes = {0};
  std::vector<tinygltf::Node>& nodes = file.model.nodes;
  const bool msft = options.layout == LevelLayout::kMsftLod;
  if (!msft) {
    nodes.push_back(node_at(write.offset));
    nodes.back().name = name;
  }
  std::vector<int> ids;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    ids.push_back(static_cast<int>(nodes.size()));
    nodes.push_back(node_at(msft ? write.offset : DVec3(0.0)));
    nodes.back().mesh = static_cast<int>(k);
    nodes.back().name = name_of_level(k);
  }
  if (msft && levels.size() > 1) {
    tinygltf::Value::Array coarser, coverage;
    for (std::size_t k = 1; k < ids.size(); ++k) coarser.emplace_back(ids[k]);
    for (const double share : options.screen_coverage) coverage.emplace_back(share);
    nodes[0].extensions["MSFT_lod"] =
        tinygltf::Value(tinygltf::Value::Object{{"ids", tinygltf::Value(coarser)}});
    if (!coverage.empty())
      nodes[0].extras =
          tinygltf::Value(tinygltf::Value::Object{{"MSFT_screencoverage", tinygltf::Value(coverage)}});
    file.model.extensionsUsed.emplace_back("MSFT_lod");
  } else if (!msft) {
    nodes[0].children = ids;
  }
  return file.write(write, scene, out);
}

}  // namespace vkmesh::detail
