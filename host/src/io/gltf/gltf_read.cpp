// Reading glTF 2.0 and its binary container GLB (Khronos Group, glTF 2.0 specification, ISO/IEC 12113:2022):
// the triangles and points of a scene.
//
// tinygltf takes the structure out of the JSON, and writes files. It checks few numbers, so everything here
// is checked before use; and the bytes of buffers are fetched here, because it looks for files in the current
// folder and reads past the end of a GLB chunk.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <nlohmann/json.hpp>

#include "io/formats.h"
#include "io/gltf/gltf.h"
#include "io/gltf/tinygltf.h"

namespace vkmesh::detail {
namespace {

using Json = nlohmann::json;
using glm::dmat3;
using glm::dmat4;
using glm::dvec4;

constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
/// Deeper JSON is refused, so that recursion over it needs little stack.
constexpr int kDeepest = 64;
/// The points and corners that instances, shared accessors and accessors without bytes may give: some for any
/// file, and more in proportion to its size.
constexpr std::uint64_t kFreeElements = std::uint64_t{1} << 24, kElementsPerByte = 256;

// ---- container

struct Container {
  std::string_view json;
  std::optional<std::string_view> binary;
};

std::uint32_t load_u32(const char* at) {
  std::uint32_t value = 0;
  std::memcpy(&value, at, sizeof(value));
  return value;
}

Result<Container> open_glb(const Source& source) {
  const std::string_view bytes = source.bytes;
  const char* begin = bytes.data();
  if (bytes.size() < kGlbHeader + kChunkHeader)
    return source.bad_byte(begin + bytes.size(), "the file ends within the 20 bytes that begin a GLB file");
  if (load_u32(begin + 4) != 2)
    return source.bad_byte(begin + 4, "version " + std::to_string(load_u32(begin + 4)) +
                                          " of the GLB container is not supported, only 2");
  const std::size_t length = load_u32(begin + 8);
  if (length > bytes.size())
    return source.bad_byte(begin + 8, "the header promises " + std::to_string(length) +
                                          " bytes, but the file has " + std::to_string(bytes.size()));
  Container container;
  for (std::size_t at = kGlbHeader; at < length;) {
    if (length - at < kChunkHeader) return source.bad_byte(begin + at, "a chunk header is cut short");
    const std::size_t size = load_u32(begin + at), left = length - at - kChunkHeader;
    const std::uint32_t type = load_u32(begin + at + 4);
    if (size > left)
      return source.bad_byte(begin + at, "a chunk promises " + std::to_string(size) + " bytes, but " +
                                             std::to_string(left) + " are left");
    const std::string_view chunk = bytes.substr(at + kChunkHeader, size);
    if (at == kGlbHeader && type != kJsonChunk)
      return source.bad_byte(begin + at, "the first chunk is no JSON");
    if (at == kGlbHeader)
      container.json = chunk;
    else if (type == kBinaryChunk && !container.binary)
      container.binary = chunk;
    at += kChunkHeader + size;
  }
  if (container.json.empty()) return source.bad_byte(begin + kGlbHeader, "the JSON chunk is empty");
  return container;
}

/// Whether brackets nest deeper than `limit`, strings apart.
bool nests_deeper(std::string_view json, int limit) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > limit) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

// ---- document

const Json* member(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto it = object.find(key);
  return it == object.end() ? nullptr : &*it;
}

std::string string_member(const Json& object, const char* key) {
  const Json* value = member(object, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

std::size_t array_size(const Json& document, const char* key) {
  const Json* value = member(document, key);
  return value != nullptr && value->is_array() ? value->size() : 0;
}

/// Percent-encoded bytes decoded (RFC 3986, section 2.1).
std::string decode_percents(const std::string& uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned byte = 0;
    if (uri[i] == '%' && uri.size() - i > 2 &&
        std::from_chars(&uri[i + 1], &uri[i] + 3, byte, 16).ptr == &uri[i] + 3) {
      out += static_cast<char>(byte);
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

/// Base64 (RFC 4648), percent-encoded or not, as far as `limit` bytes. False for other characters.
bool decode_base64(std::string_view text, std::uint64_t limit, std::vector<unsigned char>& to) {
  std::string decoded;
  if (text.find('%') != std::string_view::npos) {
    decoded = decode_percents(std::string(text));
    text = decoded;
  }
  while (text.ends_with('=')) text.remove_suffix(1);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+' || c == '-' ? 62
                      : c == '/' || c == '_' ? 63
                                             : -1;
    if (value < 0) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    if (to.size() < limit) to.push_back(static_cast<unsigned char>(bits >> count & 0xff));
  }
  return true;
}

/// What a file holds for a mesh: the structure, the bytes, and the names of the materials.
struct Asset {
  tinygltf::Model model;
  std::vector<std::string_view> buffers;
  std::deque<std::vector<unsigned char>> owned;  ///< The bytes of those buffers that lie outside the file.
  std::vector<std::string> materials;

  struct Skin {
    std::vector<int> joints;
    int inverse_bind_matrices = -1;
  };
  std::vector<Skin> skins;  ///< tinygltf asks for matrices, which the specification leaves out at will.
};

class AssetReader {
 public:
  AssetReader(const Source& source, const Container& container, Notes& notes)
      : source_(source), container_(container), notes_(notes) {}

  Result<void> read(Asset& to) {
    if (nests_deeper(container_.json, kDeepest))
      return bad("the JSON nests deeper than " + std::to_string(kDeepest) + " levels");
    Json document;
    try {
      document = Json::parse(container_.json.begin(), container_.json.end());
    } catch (const Json::parse_error& e) {
      const std::size_t at = std::min(e.byte > 0 ? e.byte - 1 : 0, container_.json.size());
      return source_.bad_byte(container_.json.data() + at, "the JSON is malformed");
    } catch (const Json::exception&) {
      return bad("the JSON holds a number out of range");
    }
    VKMESH_CHECK(check_version(document));
    VKMESH_CHECK(check_extensions(document));
    VKMESH_CHECK(fetch_buffers(document, to));
    if (const Json* materials = member(document, "materials"); materials != nullptr && materials->is_array())
      for (const Json& material : *materials) to.materials.push_back(string_member(material, "name"));
    read_skins(document, to);
    note_ignored(document);
    return read_structure(document, to.model);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> bad(std::string message) const {
    return fail(ErrorCode::kUnreadable, std::move(message), {source_.name, {}, {}});
  }

  Result<void> check_version(const Json& document) const {
    const Json* asset = member(document, "asset");
    if (asset == nullptr) return bad("the JSON has no 'asset', so that it is no glTF");
    const std::string version = string_member(*asset, "version"), least = string_member(*asset, "minVersion");
    if (!version.starts_with("2.") || (!least.empty() && least != "2.0"))
      return bad("version '" + (least.empty() ? version : least) + "' of glTF is not supported, only 2.0");
    return {};
  }

  Result<void> check_extensions(const Json& document) {
    // Those that concern how a surface looks, not where it is.
    static constexpr std::string_view kHarmless[] = {"KHR_materials_", "KHR_texture_",         "EXT_texture_",
                                                     "MSFT_texture_",  "KHR_lights_",          "EXT_lights_",
                                                     "KHR_xmp",        "KHR_animation_pointer"};
    const auto names = [&](const char* key) {
      std::vector<std::string> found;
      if (const Json* list = member(document, key); list != nullptr && list->is_array())
        for (const Json& name : *list)
          if (name.is_string() && name != "KHR_mesh_quantization" && name != "EXT_mesh_gpu_instancing" &&
              name != "MSFT_lod")
            found.push_back(name.get<std::string>());
      return found;
    };
    for (const std::string& name : names("extensionsRequired"))
      if (std::none_of(std::begin(kHarmless), std::end(kHarmless),
                       [&](std::string_view start) { return name.starts_with(start); }))
        return bad("the file requires the extension " + name + ", which is not supported");
    std::string ignored;
    for (const std::string& name : names("extensionsUsed")) ignored += (ignored.empty() ? "" : ", ") + name;
    if (!ignored.empty()) notes_.push_back({"dropped.extensions", "extensions ignored: " + ignored});
    return {};
  }

  Result<void> fetch_buffers(const Json& document, Asset& to) {
    const Json* buffers = member(document, "buffers");
    if (buffers == nullptr || !buffers->is_array()) return {};
    for (const Json& buffer : *buffers) {
      const std::string name = "buffer " + std::to_string(to.buffers.size());
      const Json* length = member(buffer, "byteLength");
      if (length == nullptr || !length->is_number_unsigned()) return bad(name + " has no byteLength");
      const auto promised = length->get<std::uint64_t>();
      std::string_view bytes;
      if (member(buffer, "uri") == nullptr) {
        if (!to.buffers.empty() || !container_.binary)
          return bad(name + " has neither a uri nor a chunk of this file");
        bytes = *container_.binary;
      } else {
        std::vector<unsigned char>& owned = to.owned.emplace_back();
        VKMESH_CHECK(fetch(string_member(buffer, "uri"), name, promised, owned));
        bytes = {reinterpret_cast<const char*>(owned.data()), owned.size()};
      }
      if (bytes.size() < promised)
        return bad(name + " promises " + std::to_string(promised) + " bytes, but has " +
                   std::to_string(bytes.size()));
      to.buffers.push_back(bytes.substr(0, promised));
    }
    return {};
  }

  Result<void> fetch(const std::string& uri, const std::string& name, std::uint64_t promised,
                     std::vector<unsigned char>& to) {
    if (uri.starts_with("data:")) {
      // Any media type, or none: the bytes are the buffer's whatever it says.
      const std::size_t comma = uri.find(',');
      if (comma == std::string::npos || !uri.substr(0, comma).ends_with(";base64") ||
          !decode_base64(std::string_view(uri).substr(comma + 1), promised, to))
        return bad(name + " has a data URI that is no base64");
      return {};
    }
    const std::string shown = "'" + uri.substr(0, 200) + "'";
    if (uri.empty()) return bad(name + " has an empty uri");
    if (uri.find(':') < uri.find('/'))
      return bad(name + " lies at " + shown + ", and only files and data: URIs are read");
    const std::filesystem::path relative = decode_percents(uri);
    if (relative.is_absolute())
      return bad(name + " lies at the absolute path " + shown + ", and only relative ones are read");
    if (!source_.folder)
      return bad(name + " lies in the file " + shown +
                 ", which only a glTF file read from a folder can name");
    if (relative.lexically_normal().string().starts_with(".."))
      notes_.push_back(
          {"repaired.place", name + " was read from " + shown + ", outside the folder of the file"});
    const std::filesystem::path path = *source_.folder / relative;
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code))
      return bad(name + " lies in " + shown + ", which is no file");
    const std::uintmax_t size = std::filesystem::file_size(path, code);
    std::ifstream file(path, std::ios::binary);
    to.resize(code ? 0 : static_cast<std::size_t>(std::min<std::uintmax_t>(size, promised)));
    if (code || !file ||
        !file.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size())))
      return bad(name + " lies in " + shown + ", which cannot be read");
    return {};
  }

  /// What is malformed in a skin counts only where a mesh uses it: a joint of -1 is none.
  static void read_skins(const Json& document, Asset& to) {
    const Json* skins = member(document, "skins");
    if (skins == nullptr || !skins->is_array()) return;
    const auto number = [](const Json* value) {
      return value != nullptr && value->is_number_unsigned() && value->get<std::uint64_t>() < 0x7fffffffu
                 ? static_cast<int>(value->get<std::uint64_t>())
                 : -1;
    };
    for (const Json& skin : *skins) {
      Asset::Skin& made = to.skins.emplace_back();
      made.inverse_bind_matrices = number(member(skin, "inverseBindMatrices"));
      if (const Json* joints = member(skin, "joints"); joints != nullptr && joints->is_array())
        for (const Json& joint : *joints) made.joints.push_back(number(&joint));
    }
  }

  void note_ignored(const Json& document) {
    const auto note = [&](const char* key, const char* code, const char* what) {
      if (const std::size_t count = array_size(document, key); count > 0)
        notes_.push_back({code, std::to_string(count) + " " + what});
    };
    note("images", "dropped.images", "images ignored");
    note("skins", "dropped.skin", "skins not kept: meshes are read as they pose them");
    note("animations", "dropped.animation", "animations ignored");
  }

  Result<void> read_structure(Json& document, tinygltf::Model& to) const {
    Json kept = Json::object();
    for (const char* key : {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews"})
      if (const auto it = document.find(key); it != document.end()) kept[key] = std::move(*it);
    const std::map<std::pair<std::size_t, std::size_t>, int> zeros = take_indices_without_view(kept);
    const std::string text = kept.dump();
    if (text.size() > std::numeric_limits<unsigned>::max()) return bad("the JSON exceeds 4 GiB");
    std::string error, warning;
    tinygltf::TinyGLTF loader;
    // Complaints that do not stop it tell of something that it dropped.
    if (!loader.LoadASCIIFromString(&to, &error, &warning, text.data(), static_cast<unsigned>(text.size()),
                                    "") ||
        !error.empty())
      return bad("the glTF structure is malformed: " +
                 error.substr(0, std::min(error.find('\n'), error.size())));
    for (const auto& [place, accessor] : zeros)
      if (place.first < to.meshes.size() && place.second < to.meshes[place.first].primitives.size())
        to.meshes[place.first].primitives[place.second].indices = accessor;
    return {};
  }

  /// tinygltf refuses indices without a buffer view, which the specification (3.6.2.1) makes zeros: they are
  /// taken out of its sight. Returns their accessors by the numbers of mesh and primitive.
  static std::map<std::pair<std::size_t, std::size_t>, int> take_indices_without_view(Json& document) {
    std::map<std::pair<std::size_t, std::size_t>, int> taken;
    const Json* accessors = member(document, "accessors");
    const auto meshes = document.find("meshes");
    if (accessors == nullptr || !accessors->is_array() || meshes == document.end() || !meshes->is_array())
      return taken;
    for (std::size_t m = 0; m < meshes->size(); ++m) {
      Json& mesh = (*meshes)[m];
      if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array()) continue;
      for (std::size_t p = 0; p < mesh["primitives"].size(); ++p) {
        Json& primitive = mesh["primitives"][p];
        const Json* indices = member(primitive, "indices");
        if (indices == nullptr || !indices->is_number_unsigned()) continue;
        const auto index = indices->get<std::uint64_t>();
        if (index >= accessors->size() || member((*accessors)[index], "bufferView") != nullptr) continue;
        taken[{m, p}] = static_cast<int>(index);
        primitive.erase("indices");
      }
    }
    return taken;
  }

  const Source& source_;
  const Container& container_;
  Notes& notes_;
};

// ---- accessors

/// Calls visit with a value of the type that a component type names. False for one that names none.
template <class Visit>
bool with_component(int type, Visit&& visit) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      visit(std::int8_t{});
      return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      visit(std::uint8_t{});
      return true;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      visit(std::int16_t{});
      return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      visit(std::uint16_t{});
      return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      visit(std::uint32_t{});
      return true;
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      visit(float{});
      return true;
    default:
      return false;
  }
}

std::size_t component_size(int type) {
  std::size_t size = 0;
  with_component(type, [&](auto value) { size = sizeof(value); });
  return size;
}

/// 1 to 4, 16 for matrices of four columns, 0 for others, whose columns are padded.
unsigned components_of(const tinygltf::Accessor& accessor) {
  switch (accessor.type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

/// A stored component as a value: whole numbers of a normalised accessor are fractions (specification, 3.11).
template <class To, class From>
To converted(From value, bool normalized) {
  if constexpr (std::is_floating_point_v<To> && std::is_integral_v<From>) {
    if (normalized)
      return std::max(static_cast<To>(value) / static_cast<To>(std::numeric_limits<From>::max()), To{-1});
  }
  return static_cast<To>(value);
}

/// Gets the elements of accessors out of the buffers, never past what was promised.
class AccessorReader {
 public:
  AccessorReader(const Source& source, const Asset& asset)
      : source_(source), asset_(asset), budget_(kFreeElements + kElementsPerByte * source.bytes.size()) {
    for (const std::string_view buffer : asset.buffers) budget_ += kElementsPerByte * buffer.size();
  }

  [[nodiscard]] tl::unexpected<Error> bad(std::string message) const {
    return fail(ErrorCode::kUnreadable, std::move(message), {source_.name, {}, {}});
  }

  Result<const tinygltf::Accessor*> accessor(int index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= asset_.model.accessors.size())
      return bad("accessor " + std::to_string(index) + " of " +
                 std::to_string(asset_.model.accessors.size()) + " is named");
    return &asset_.model.accessors[static_cast<std::size_t>(index)];
  }

  /// All components of an accessor as To. Errors: kUnreadable when it reaches beyond its bytes, or when the
  /// elements asked for so far are out of all proportion to the file.
  template <class To>
  Result<std::vector<To>> components(int index) {
    VKMESH_TRY(const tinygltf::Accessor* const a, accessor(index));
    const std::string name = "accessor " + std::to_string(index);
    const unsigned width = components_of(*a);
    const std::size_t size = component_size(a->componentType);
    if (width == 0 || size == 0) return bad(name + " has a type that no vertex has");
    if (a->count > std::min(budget_, kMaxElements))
      return bad(name + " brings more elements than a file of this size may have");
    budget_ -= a->count;

    std::string_view bytes;
    std::size_t stride = width * size;
    if (a->bufferView >= 0) {
      VKMESH_TRY(bytes, view(a->bufferView, name));
      if (const std::size_t given =
              asset_.model.bufferViews[static_cast<std::size_t>(a->bufferView)].byteStride;
          given > 0) {
        if (given < stride) return bad(name + " has elements longer than the stride");
        stride = given;
      }
      VKMESH_TRY(bytes, part(bytes, a->byteOffset, a->count, width * size, stride, name));
    }
    std::vector<To> out(a->count * width);
    if (a->bufferView >= 0)
      with_component(a->componentType, [&](auto type) {
        for (std::size_t i = 0; i < a->count; ++i)
          for (std::size_t k = 0; k < width; ++k)
            out[i * width + k] = load<To>(bytes.data() + i * stride + k * size, type, a->normalized);
      });
    if (a->sparse.isSparse) VKMESH_CHECK(overwrite(*a, name, out));
    return out;
  }

 private:
  template <class To, class From>
  static To load(const char* at, From value, bool normalized) {
    std::memcpy(&value, at, sizeof(value));
    return converted<To>(value, normalized);
  }

  Result<std::string_view> view(int index, const std::string& user) const {
    if (index < 0 || static_cast<std::size_t>(index) >= asset_.model.bufferViews.size())
      return bad(user + " names buffer view " + std::to_string(index) + " of " +
                 std::to_string(asset_.model.bufferViews.size()));
    const tinygltf::BufferView& view = asset_.model.bufferViews[static_cast<std::size_t>(index)];
    const std::string name = "buffer view " + std::to_string(index);
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= asset_.buffers.size())
      return bad(name + " names buffer " + std::to_string(view.buffer) + " of " +
                 std::to_string(asset_.buffers.size()));
    const std::string_view buffer = asset_.buffers[static_cast<std::size_t>(view.buffer)];
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
      return bad(name + " reaches beyond its buffer");
    return buffer.substr(view.byteOffset, view.byteLength);
  }

  /// The bytes from `offset` on, if `count` elements fit there.
  Result<std::string_view> part(std::string_view bytes, std::size_t offset, std::size_t count,
                                std::size_t element, std::size_t stride, const std::string& name) const {
    if (offset > bytes.size() || (count > 0 && (bytes.size() - offset < element ||
                                                count - 1 > (bytes.size() - offset - element) / stride)))
      return bad(name + " reaches beyond its buffer view");
    return bytes.substr(offset);
  }

  template <class To>
  Result<void> overwrite(const tinygltf::Accessor& a, const std::string& name, std::vector<To>& out) const {
    const std::size_t width = components_of(a), size = component_size(a.componentType);
    const std::size_t index_size = component_size(a.sparse.indices.componentType);
    if (a.sparse.count < 0 || static_cast<std::size_t>(a.sparse.count) > a.count || index_size == 0 ||
        a.sparse.indices.byteOffset < 0 || a.sparse.values.byteOffset < 0)
      return bad(name + " is sparse in a malformed way");
    const auto count = static_cast<std::size_t>(a.sparse.count);
    VKMESH_TRY(std::string_view indices, view(a.sparse.indices.bufferView, name));
    VKMESH_TRY(indices, part(indices, static_cast<std::size_t>(a.sparse.indices.byteOffset), count,
                             index_size, index_size, name));
    VKMESH_TRY(std::string_view values, view(a.sparse.values.bufferView, name));
    VKMESH_TRY(values, part(values, static_cast<std::size_t>(a.sparse.values.byteOffset), count, width * size,
                            width * size, name));
    for (std::size_t i = 0; i < count; ++i) {
      // Every 32-bit index is exact in a double.
      double at = -1;
      with_component(a.sparse.indices.componentType,
                     [&](auto type) { at = load<double>(indices.data() + i * index_size, type, false); });
      if (!(at >= 0 && at < static_cast<double>(a.count)))
        return bad(name + " replaces an element that it does not have");
      with_component(a.componentType, [&](auto type) {
        for (std::size_t k = 0; k < width; ++k)
          out[static_cast<std::size_t>(at) * width + k] =
              load<To>(values.data() + (i * width + k) * size, type, a.normalized);
      });
    }
    return {};
  }

  const Source& source_;
  const Asset& asset_;
  std::uint64_t budget_;
};

// ---- scene

/// An attribute of points that grows primitive by primitive. Points of a primitive without it get the fill
/// value.
struct GrowingChannel {
  unsigned components = 0;
  float fill = 0;
  std::vector<float> values;
  std::optional<int> component_type;  ///< What all primitives stored.
  bool same_type = true, normalized = false;

  /// Makes room for elements of `wanted` components.
  void widen(unsigned wanted) {
    if (wanted <= components) return;
    std::vector<float> wider;
    for (std::size_t i = 0; components > 0 && i < values.size(); ++i) {
      wider.push_back(values[i]);
      if ((i + 1) % components == 0) wider.insert(wider.end(), wanted - components, fill);
    }
    values = std::move(wider);
    components = wanted;
  }

  void append(const std::vector<float>& more, unsigned width) {
    for (std::size_t i = 0; i < more.size(); i += width) {
      values.insert(values.end(), more.begin() + static_cast<std::ptrdiff_t>(i),
                    more.begin() + static_cast<std::ptrdiff_t>(i + width));
      values.insert(values.end(), components - width, fill);
    }
  }

  /// Whole numbers come back as they were stored, and colours of bytes as bytes.
  Channel finish(const std::string& name, std::size_t points) {
    values.resize(points * components, fill);
    Channel channel{name, components, {}};
    const bool whole = same_type && component_type && normalized == (name == "color") &&
                       *component_type != TINYGLTF_COMPONENT_TYPE_FLOAT &&
                       (name == "color" ? *component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE
                                        : *component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) &&
                       name != "uv" && name != "normal";
    if (!whole) {
      channel.values = std::move(values);
      return channel;
    }
    with_component(*component_type, [&](auto type) {
      using T = decltype(type);
      std::vector<T> stored;
      stored.reserve(values.size());
      for (const float v : values)
        stored.push_back(static_cast<T>(name == "color" ? std::lround(v * 255) : std::lround(v)));
      channel.values = std::move(stored);
    });
    return channel;
  }
};

class SceneReader {
 public:
  SceneReader(const Source& source, const Asset& asset, Notes& notes)
      : source_(source),
        model_(asset.model),
        materials_(asset.materials),
        skins_(asset.skins),
        notes_(notes),
        accessors_(source, asset),
        level_(source.level) {}

  /// The levels of detail of the object that has most, when the scene has been read.
  [[nodiscard]] std::size_t levels() const { return levels_; }

  Result<IndexedFaceSet> read() {
    if (model_.scenes.empty())
      for (std::size_t m = 0; m < model_.meshes.size(); ++m)
        VKMESH_CHECK(add_mesh(static_cast<int>(m), dmat4(1)));
    else
      VKMESH_CHECK(walk());
    if (mesh_.points.empty()) return accessors_.bad("the file holds no points that a scene shows");
    if (levels_ > 1 && level_ == 0)
      notes_.push_back({"dropped.levels", std::to_string(levels_ - 1) + " coarser levels of detail ignored"});
    finish();
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> bad(std::string message) const {
    return accessors_.bad(std::move(message));
  }

  Result<void> walk() {
    std::vector<int> roots;
    if (model_.defaultScene >= 0) {
      if (static_cast<std::size_t>(model_.defaultScene) >= model_.scenes.size())
        return bad("the default scene is " + std::to_string(model_.defaultScene) + " of " +
                   std::to_string(model_.scenes.size()));
      roots = model_.scenes[static_cast<std::size_t>(model_.defaultScene)].nodes;
      if (model_.scenes.size() > 1)
        notes_.push_back({"dropped.scenes", std::to_string(model_.scenes.size() - 1) +
                                                " scenes beside the default one ignored"});
    } else {
      // Scenes may share roots.
      std::set<int> seen;
      for (const tinygltf::Scene& scene : model_.scenes)
        for (const int root : scene.nodes)
          if (seen.insert(root).second) roots.push_back(root);
    }

    struct Visit {
      int node;
      dmat4 parent;
    };
    std::vector<Visit> open;
    const auto push = [&](const std::vector<int>& children, const dmat4& parent) {
      const std::vector<int> nodes = at_level(children);
      for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) open.push_back({*it, parent});
    };
    push(roots, dmat4(1));
    std::vector<bool> reached(model_.nodes.size());
    worlds_.assign(model_.nodes.size(), dmat4(1));
    std::vector<std::size_t> shown;
    while (!open.empty()) {
      const Visit visit = open.back();
      open.pop_back();
      const auto index = static_cast<std::size_t>(visit.node);
      if (visit.node < 0 || index >= reached.size())
        return bad("node " + std::to_string(visit.node) + " of " + std::to_string(reached.size()) +
                   " is named");
      if (reached[index])
        return bad("node " + std::to_string(visit.node) +
                   " is reached twice, so that the nodes form no tree");
      reached[index] = true;
      const tinygltf::Node& node = model_.nodes[index];
      dmat4 local(1);
      VKMESH_CHECK(transform(node, index, local));
      const dmat4 world = visit.parent * local;
      worlds_[index] = world;
      if (node.mesh >= 0) shown.push_back(index);
      push(node.children, world);
    }
    // Joints may stand anywhere in the scene: all places are settled first.
    for (const std::size_t index : shown) {
      const tinygltf::Node& node = model_.nodes[index];
      if (node.skin >= 0)
        VKMESH_CHECK(add_skinned(node));
      else
        VKMESH_CHECK(add_instances(node, index, worlds_[index]));
    }
    return {};
  }

  /// "chair" and 2 for "chair_LOD2" or "chair_lod2".
  static std::optional<std::pair<std::string, std::size_t>> named_level(const std::string& name) {
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    if (digits == name.size() || name.size() - digits > 3 || digits < 4) return std::nullopt;
    const std::string mark = name.substr(digits - 4, 4);
    if (mark != "_LOD" && mark != "_lod") return std::nullopt;
    return std::pair(name.substr(0, digits - 4), static_cast<std::size_t>(std::stoul(name.substr(digits))));
  }

  /// Those of several nodes beside each other that show the level of detail that is asked for, or the
  /// coarsest that there is.
  std::vector<int> at_level(const std::vector<int>& nodes) {
    const auto node_of = [&](int index) -> const tinygltf::Node* {
      return index >= 0 && static_cast<std::size_t>(index) < model_.nodes.size()
                 ? &model_.nodes[static_cast<std::size_t>(index)]
                 : nullptr;
    };
    // By name: which node shows each object, and its level.
    std::map<std::string, std::pair<std::size_t, int>> best;
    std::map<std::string, std::size_t> count;
    for (const int index : nodes)
      if (const tinygltf::Node* node = node_of(index); node != nullptr)
        if (const auto named = named_level(node->name)) {
          ++count[named->first];
          auto& [level, shown] = best.try_emplace(named->first, named->second, index).first->second;
          const bool nearer = named->second <= level_ ? level > level_ || named->second > level
                                                      : level > level_ && named->second < level;
          if (!nearer) continue;
          level = named->second;
          shown = index;
        }
    std::vector<int> kept;
    for (const int index : nodes) {
      const tinygltf::Node* node = node_of(index);
      if (node == nullptr) {
        kept.push_back(index);
        continue;
      }
      if (const auto named = named_level(node->name); named && count[named->first] > 1) {
        levels_ = std::max(levels_, count[named->first]);
        if (best[named->first].second != index) continue;
      }
      const std::vector<int> coarser = coarser_nodes(*node);
      levels_ = std::max(levels_, coarser.size() + 1);
      kept.push_back(level_ == 0 || coarser.empty() ? index : coarser[std::min(level_, coarser.size()) - 1]);
    }
    return kept;
  }

  /// The nodes that MSFT_lod names for further levels, the finer first.
  static std::vector<int> coarser_nodes(const tinygltf::Node& node) {
    std::vector<int> coarser;
    const auto extension = node.extensions.find("MSFT_lod");
    if (extension == node.extensions.end() || !extension->second.IsObject()) return coarser;
    const tinygltf::Value& ids = extension->second.Get("ids");
    for (std::size_t i = 0; ids.IsArray() && i < ids.ArrayLen(); ++i)
      if (const tinygltf::Value& id = ids.Get(static_cast<int>(i)); id.IsNumber())
        coarser.push_back(id.GetNumberAsInt());
    return coarser;
  }

  /// A mesh that a skin poses: where its joints are, and not where its node is (specification, 3.7.3.3).
  Result<void> add_skinned(const tinygltf::Node& node) {
    const std::string name = "skin " + std::to_string(node.skin);
    if (static_cast<std::size_t>(node.skin) >= skins_.size())
      return bad(name + " of " + std::to_string(skins_.size()) + " is named");
    const Asset::Skin& skin = skins_[static_cast<std::size_t>(node.skin)];
    std::vector<double> inverse;
    if (skin.inverse_bind_matrices >= 0) {
      VKMESH_TRY(const tinygltf::Accessor* const accessor, accessors_.accessor(skin.inverse_bind_matrices));
      if (accessor->type != TINYGLTF_TYPE_MAT4 || accessor->count < skin.joints.size())
        return bad(name + " has no inverse bind matrix for each joint");
      VKMESH_TRY(inverse, accessors_.components<double>(skin.inverse_bind_matrices));
    }
    joints_.clear();
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      if (skin.joints[j] < 0 || static_cast<std::size_t>(skin.joints[j]) >= worlds_.size())
        return bad(name + " names node " + std::to_string(skin.joints[j]) + " of " +
                   std::to_string(worlds_.size()));
      dmat4 bind(1);
      for (std::size_t i = 0; i < 16 && !inverse.empty(); ++i)
        bind[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = inverse[16 * j + i];
      joints_.push_back(worlds_[static_cast<std::size_t>(skin.joints[j])] * bind);
    }
    // A mesh that has no weights stays as it is.
    const Result<void> added = add_mesh(node.mesh, dmat4(1));
    joints_.clear();
    return added;
  }

  /// A mesh in its place, or in each of those that EXT_mesh_gpu_instancing gives it.
  Result<void> add_instances(const tinygltf::Node& node, std::size_t index, const dmat4& world) {
    const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
    if (extension == node.extensions.end()) return add_mesh(node.mesh, world);
    const tinygltf::Value& attributes = extension->second.Get("attributes");
    std::optional<std::size_t> count;
    const auto values = [&](const char* name, unsigned width) -> Result<std::vector<double>> {
      if (!attributes.IsObject() || !attributes.Has(name)) return std::vector<double>{};
      const int accessor_index = attributes.Get(name).GetNumberAsInt();
      VKMESH_TRY(const tinygltf::Accessor* const accessor, accessors_.accessor(accessor_index));
      if (components_of(*accessor) != width || accessor->count != count.value_or(accessor->count))
        return bad("accessor " + std::to_string(accessor_index) + " does not fit the instances of node " +
                   std::to_string(index));
      count = accessor->count;
      return accessors_.components<double>(accessor_index);
    };
    VKMESH_TRY(const std::vector<double> translations, values("TRANSLATION", 3));
    VKMESH_TRY(const std::vector<double> rotations, values("ROTATION", 4));
    VKMESH_TRY(const std::vector<double> scales, values("SCALE", 3));
    for (std::size_t i = 0; i < count.value_or(1); ++i) {
      tinygltf::Node instance;
      const auto take = [&](const std::vector<double>& from, std::size_t width, std::vector<double>& to) {
        if (!from.empty())
          to.assign(from.begin() + static_cast<std::ptrdiff_t>(width * i),
                    from.begin() + static_cast<std::ptrdiff_t>(width * (i + 1)));
      };
      take(translations, 3, instance.translation);
      take(rotations, 4, instance.rotation);
      take(scales, 3, instance.scale);
      dmat4 local(1);
      VKMESH_CHECK(transform(instance, index, local));
      VKMESH_CHECK(add_mesh(node.mesh, world * local));
    }
    return {};
  }

  Result<void> transform(const tinygltf::Node& node, std::size_t index, dmat4& to) const {
    const auto fits = [](const std::vector<double>& v, std::size_t size) {
      return v.empty() || v.size() == size;
    };
    if (!fits(node.matrix, 16) || !fits(node.translation, 3) || !fits(node.rotation, 4) ||
        !fits(node.scale, 3))
      return bad("node " + std::to_string(index) + " has a transformation of the wrong size");
    if (!node.matrix.empty()) {
      for (int i = 0; i < 16; ++i) to[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
      return {};
    }
    if (!node.rotation.empty()) {
      const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
      to = glm::mat4_cast(glm::normalize(q));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      if (!node.scale.empty()) to[axis] *= node.scale[i];
      if (!node.translation.empty()) to[3][axis] = node.translation[i];
    }
    return {};
  }

  /// Normals go with the inverse transpose; up to their length that is the matrix of cofactors, which always
  /// exists.
  static dmat3 normal_matrix(const dmat3& linear) {
    const dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                          glm::cross(linear[0], linear[1]));
    return glm::determinant(linear) < 0 ? -cofactors : cofactors;
  }

  Result<void> add_mesh(int index, const dmat4& world) {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.meshes.size())
      return bad("mesh " + std::to_string(index) + " of " + std::to_string(model_.meshes.size()) +
                 " is named");
    const dmat3 linear(world);
    place_ = {world, normal_matrix(linear), glm::determinant(linear) < 0, world == dmat4(1)};
    // Primitives of one mesh that name the same accessors have their points in common.
    std::map<std::map<std::string, int>, std::uint32_t> first_points;
    for (const tinygltf::Primitive& primitive : model_.meshes[static_cast<std::size_t>(index)].primitives)
      VKMESH_CHECK(add_primitive(primitive, first_points));
    return {};
  }

  Result<void> add_primitive(const tinygltf::Primitive& primitive,
                             std::map<std::map<std::string, int>, std::uint32_t>& first_points) {
    VKMESH_CHECK(source_.tick(source_.bytes.data() + source_.bytes.size() / 2));
    morphed_ += !primitive.targets.empty();
    switch (primitive.mode) {
      case TINYGLTF_MODE_LINE:
      case TINYGLTF_MODE_LINE_LOOP:
      case TINYGLTF_MODE_LINE_STRIP:
        ++lines_;
        return {};
      case TINYGLTF_MODE_POINTS:
      case TINYGLTF_MODE_TRIANGLES:
      case TINYGLTF_MODE_TRIANGLE_STRIP:
      case TINYGLTF_MODE_TRIANGLE_FAN:
        break;
      default:
        return bad("a primitive has the mode " + std::to_string(primitive.mode) + ", which there is not");
    }
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) {
      ++without_position_;
      return {};
    }
    if (primitive.material >= 0 && static_cast<std::size_t>(primitive.material) >= materials_.size())
      return bad("material " + std::to_string(primitive.material) + " of " +
                 std::to_string(materials_.size()) + " is named");
    VKMESH_TRY(const tinygltf::Accessor* const points, accessors_.accessor(position->second));
    const auto [known, is_new] =
        first_points.try_emplace(primitive.attributes, static_cast<std::uint32_t>(mesh_.points.size()));
    if (is_new) VKMESH_CHECK(add_points(primitive, position->second));
    if (primitive.mode == TINYGLTF_MODE_POINTS) return {};

    std::vector<std::uint32_t> order;
    if (primitive.indices >= 0) {
      VKMESH_TRY(const tinygltf::Accessor* const indices, accessors_.accessor(primitive.indices));
      if (indices->type != TINYGLTF_TYPE_SCALAR ||
          (indices->componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
           indices->componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
           indices->componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        return bad("accessor " + std::to_string(primitive.indices) + " holds no indices");
      VKMESH_TRY(order, accessors_.components<std::uint32_t>(primitive.indices));
    } else {
      order.resize(points->count);
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
    }
    for (const std::uint32_t i : order)
      if (i >= points->count)
        return bad("accessor " + std::to_string(primitive.indices) + " names point " + std::to_string(i) +
                   " of " + std::to_string(points->count));
    return add_faces(primitive, order, known->second);
  }

  Result<void> add_points(const tinygltf::Primitive& primitive, int position) {
    const std::size_t before = mesh_.points.size();
    VKMESH_TRY(const std::vector<float> coordinates, accessors_.components<float>(position));
    VKMESH_TRY(const tinygltf::Accessor* const accessor, accessors_.accessor(position));
    if (components_of(*accessor) != 3)
      return bad("accessor " + std::to_string(position) + " holds no positions");
    if (before + accessor->count > kMaxElements)
      return bad("there are more points than 32-bit indices can number");
    VKMESH_TRY(poses_, poses(primitive, accessor->count));
    for (std::size_t i = 0; i < accessor->count; ++i) {
      DVec3 exact(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]);
      if (!poses_.empty())
        exact = DVec3(poses_[i] * dvec4(exact, 1));
      else if (!place_.identity)
        exact = DVec3(place_.world * dvec4(exact, 1));
      const Vec3 p = source_.positions->place(exact);
      if (!all_finite(p))
        return bad("point " + std::to_string(i) + " of accessor " + std::to_string(position) +
                   " has a coordinate that is not finite");
      mesh_.points.push_back(p);
    }
    for (const auto& [attribute, index] : primitive.attributes)
      if (attribute != "POSITION") VKMESH_CHECK(add_attribute(attribute, index, before));
    return {};
  }

  /// The matrix that the joints give each point; none where nothing poses them.
  Result<std::vector<dmat4>> poses(const tinygltf::Primitive& primitive, std::size_t points) {
    std::vector<dmat4> found;
    if (joints_.empty()) return found;
    std::vector<double> sums;
    for (int set = 0;; ++set) {
      const auto joints = primitive.attributes.find("JOINTS_" + std::to_string(set));
      const auto weights = primitive.attributes.find("WEIGHTS_" + std::to_string(set));
      if (joints == primitive.attributes.end() || weights == primitive.attributes.end()) break;
      VKMESH_TRY(const std::vector<double> of_point, accessors_.components<double>(joints->second));
      VKMESH_TRY(const std::vector<double> share, accessors_.components<double>(weights->second));
      if (of_point.size() != 4 * points || share.size() != 4 * points)
        return bad("accessor " + std::to_string(joints->second) + " does not fit the joints of " +
                   std::to_string(points) + " points");
      found.resize(points, dmat4(0));
      sums.resize(points);
      for (std::size_t i = 0; i < 4 * points; ++i) {
        if (!(share[i] > 0)) continue;
        if (!(of_point[i] < static_cast<double>(joints_.size())))
          return bad("accessor " + std::to_string(joints->second) + " names a joint that its skin lacks");
        found[i / 4] += share[i] * joints_[static_cast<std::size_t>(of_point[i])];
        sums[i / 4] += share[i];
      }
    }
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = sums[i] > 0 ? found[i] / sums[i] : dmat4(1);
    return found;
  }

  Result<void> add_attribute(const std::string& attribute, int index, std::size_t before) {
    const bool of_skin = attribute.starts_with("JOINTS_") || attribute.starts_with("WEIGHTS_");
    if (of_skin && !poses_.empty()) return {};  // Told as the skin.
    const std::string name = gltf_channel_name(attribute);
    if (name.empty()) {
      ignored_attributes_.insert(attribute);
      return {};
    }
    VKMESH_TRY(const tinygltf::Accessor* const accessor, accessors_.accessor(index));
    const unsigned width = components_of(*accessor);
    const bool fits = name == "normal"  ? width == 3
                      : name == "uv"    ? width == 2
                      : name == "color" ? width == 3 || width == 4
                                        : width > 0 && width <= 4;
    if (!fits || accessor->count != mesh_.points.size() - before)
      return bad("accessor " + std::to_string(index) + " does not fit the attribute " + attribute + " of " +
                 std::to_string(mesh_.points.size() - before) + " points");
    VKMESH_TRY(std::vector<float> values, accessors_.components<float>(index));
    if (name == "normal" && (!place_.identity || !poses_.empty()))
      for (std::size_t i = 0; i < values.size(); i += 3) {
        const dmat3 turn = poses_.empty() ? place_.normals : normal_matrix(dmat3(poses_[i / 3]));
        const DVec3 n = turn * DVec3(values[i], values[i + 1], values[i + 2]);
        const double length = glm::length(n);
        const Vec3 unit = length > 0 ? Vec3(n / length) : Vec3(0);
        for (int axis = 0; axis < 3; ++axis) values[i + static_cast<std::size_t>(axis)] = unit[axis];
      }
    // Upwards here, as in OBJ; downwards in glTF.
    if (name == "uv")
      for (std::size_t i = 1; i < values.size(); i += 2) values[i] = 1 - values[i];
    GrowingChannel& channel = channels_[name];
    channel.fill = name == "color" ? 1.0f : 0.0f;
    channel.widen(width);
    channel.values.resize(before * channel.components, channel.fill);
    channel.append(values, width);
    if (!channel.component_type) {
      channel.component_type = accessor->componentType;
      channel.normalized = accessor->normalized;
    }
    channel.same_type = channel.same_type && *channel.component_type == accessor->componentType &&
                        channel.normalized == accessor->normalized;
    return {};
  }

  Result<void> add_faces(const tinygltf::Primitive& primitive, const std::vector<std::uint32_t>& order,
                         std::uint32_t first) {
    const std::size_t n = order.size();
    const bool separate = primitive.mode == TINYGLTF_MODE_TRIANGLES;
    const std::size_t faces = separate ? n / 3 : n < 3 ? 0 : n - 2;
    if (mesh_.corners.size() + 3 * faces > kMaxElements)
      return bad("the faces have more corners than 32-bit indices can number");
    left_over_ += separate ? n % 3 : n < 3 ? n : 0;
    const auto material = primitive.material >= 0 ? static_cast<std::uint32_t>(primitive.material)
                                                  : static_cast<std::uint32_t>(materials_.size());
    for (std::size_t f = 0; f < faces; ++f) {
      std::array<std::size_t, 3> at = {3 * f, 3 * f + 1, 3 * f + 2};
      if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) at = {f, f + 1 + f % 2, f + 2 - f % 2};
      if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) at = {f + 1, f + 2, 0};
      if (place_.mirrored) std::swap(at[1], at[2]);
      const std::array<std::uint32_t, 3> face = {order[at[0]], order[at[1]], order[at[2]]};
      // Strips turn corners and jump by triangles without area.
      if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP &&
          (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])) {
        ++turns_;
        continue;
      }
      for (const std::uint32_t corner : face) mesh_.corners.push_back(first + corner);
      face_materials_.push_back(material);
    }
    return {};
  }

  void finish() {
    for (auto& [name, channel] : channels_)
      mesh_.point_channels.push_back(channel.finish(name, mesh_.points.size()));
    const auto none = static_cast<std::uint32_t>(materials_.size());
    const auto without =
        static_cast<std::size_t>(std::count(face_materials_.begin(), face_materials_.end(), none));
    if (without < face_materials_.size()) {
      Channel channel{"material", 1, std::move(face_materials_), materials_};
      for (std::size_t i = 0; i < channel.labels.size(); ++i)
        if (channel.labels[i].empty()) channel.labels[i] = "material " + std::to_string(i);
      if (without > 0) channel.labels.emplace_back();
      mesh_.face_channels.push_back(std::move(channel));
    }
    const auto note = [&](std::size_t count, const char* code, const std::string& what) {
      if (count > 0) notes_.push_back({code, std::to_string(count) + " " + what});
    };
    note(lines_, "dropped.lines", "primitives of lines ignored");
    note(without_position_, "dropped.primitives", "primitives without positions ignored");
    note(morphed_, "dropped.morph_targets", "primitives with morph targets read without them");
    note(left_over_, "skipped.corners", "corners that complete no triangle ignored");
    note(turns_, "skipped.strip_turns", "triangles without area that join strips ignored");
    for (const std::string& attribute : ignored_attributes_)
      notes_.push_back({"dropped." + attribute, "attribute " + attribute + " ignored"});
  }

  struct Place {
    dmat4 world;
    dmat3 normals;
    bool mirrored, identity;
  };

  const Source& source_;
  const tinygltf::Model& model_;
  const std::vector<std::string>& materials_;
  const std::vector<Asset::Skin>& skins_;
  Notes& notes_;
  AccessorReader accessors_;
  Place place_{dmat4(1), dmat3(1), false, true};
  std::vector<dmat4> worlds_;  ///< Where each node stands.
  std::vector<dmat4> poses_;   ///< For each point of the present primitive, where a skin poses it.
  std::vector<dmat4> joints_;  ///< Those of the skin that poses the present mesh; empty without one.
  IndexedFaceSet mesh_;
  std::map<std::string, GrowingChannel> channels_;
  std::vector<std::uint32_t> face_materials_;  ///< materials_.size() for none.
  std::set<std::string> ignored_attributes_;
  std::size_t level_ = 0, levels_ = 1;  // of detail: the one that is read, and how many there are
  std::size_t lines_ = 0, without_position_ = 0, morphed_ = 0, left_over_ = 0, turns_ = 0;
};

}  // namespace

std::string gltf_channel_name(const std::string& attribute) {
  if (attribute == "NORMAL") return "normal";
  if (attribute == "TEXCOORD_0") return "uv";
  if (attribute == "COLOR_0") return "color";
  if (!attribute.starts_with('_')) return "";
  std::string name = attribute.substr(1);
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return name == "normal" || name == "uv" || name == "color" ? "" : name;
}

bool is_gltf(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return true;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && bytes[start] == '{' &&
         bytes.find("\"asset\"") != std::string_view::npos;
}

Result<MeshFile> parse_gltf(const Source& source) {
  MeshFile file;
  file.format = FileFormat::kGltf;
  Container container{source.bytes, {}};
  if (source.bytes.starts_with("glTF")) {
    file.encoding = FileEncoding::kBinaryLittleEndian;
    VKMESH_TRY(container, open_glb(source));
  }
  Asset asset;
  VKMESH_CHECK(AssetReader(source, container, file.notes).read(asset));
  SceneReader scene(source, asset, file.notes);
  VKMESH_TRY(file.geometry, scene.read());
  file.levels = scene.levels();
  return file;
}

}  // namespace vkmesh::detail
