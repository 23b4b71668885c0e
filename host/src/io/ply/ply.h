// PLY, the Polygon File Format (G. Turk, "The PLY polygon file format", 1994): what reading and writing
// share.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/io/mesh_io.h>

#include "io/formats.h"

namespace vkmesh::detail::ply {

static_assert(std::endian::native == std::endian::little, "byte orders are told apart on this assumption");

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct ScalarName {
  std::string_view name;
  Scalar type;
};

// The first name of each type is the one that is written.
inline constexpr std::array kScalarNames = {
    ScalarName{"char", Scalar::kInt8},     ScalarName{"uchar", Scalar::kUint8},
    ScalarName{"short", Scalar::kInt16},   ScalarName{"ushort", Scalar::kUint16},
    ScalarName{"int", Scalar::kInt32},     ScalarName{"uint", Scalar::kUint32},
    ScalarName{"float", Scalar::kFloat},   ScalarName{"double", Scalar::kDouble},
    ScalarName{"int8", Scalar::kInt8},     ScalarName{"uint8", Scalar::kUint8},
    ScalarName{"int16", Scalar::kInt16},   ScalarName{"uint16", Scalar::kUint16},
    ScalarName{"int32", Scalar::kInt32},   ScalarName{"uint32", Scalar::kUint32},
    ScalarName{"float32", Scalar::kFloat}, ScalarName{"float64", Scalar::kDouble},
};

inline std::optional<Scalar> scalar_of(std::string_view name) {
  for (const ScalarName& s : kScalarNames)
    if (s.name == name) return s.type;
  return std::nullopt;
}

inline std::string_view name_of_scalar(Scalar type) {
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

inline std::size_t size_of(Scalar type) {
  return with_type(type, [](auto t) { return sizeof(t); });
}

inline bool is_integer(Scalar type) {
  return type != Scalar::kFloat && type != Scalar::kDouble;
}

template <class T>
T swap_bytes(T value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

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

/// Reads what stands before the body.
[[nodiscard]] Result<Header> read_header(const Source& source);

/// Text of more than this is cut into blocks of as much, which are parsed at the same time.
inline constexpr std::size_t kBlockBytes = std::size_t{1} << 18;

/// parse_ply with blocks of another size. The result and the errors do not depend on it.
[[nodiscard]] Result<MeshFile> parse(const Source& source, std::size_t block_bytes);

}  // namespace vkmesh::detail::ply
