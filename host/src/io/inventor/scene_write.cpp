// Writes OpenInventor 2.1 ascii, VRML 1 and VRML 97.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/distinct_rows.h"
#include "io/formats.h"

namespace vkmesh::detail {
namespace {

/// The normals, texture coordinates or colours of a mesh, as rows and, for corners, the number of each one's
/// row.
struct OutAttribute {
  enum class Of { kNone, kPoints, kCorners, kFaces };
  Of of = Of::kNone;
  const Channel* channel = nullptr;
  std::size_t width = 3;
  bool packed = false;  ///< Rows are the four bytes of one number.
  std::vector<std::array<float, 4>> rows;
  std::vector<std::uint32_t> row_of_corner;
};

class SceneWriter {
 public:
  SceneWriter(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes)
      : mesh_(mesh), options_(options), out_(out), notes_(notes) {}

  void write() {
    const bool vrml2 = options_.format == FileFormat::kVrml2;
    choose();
    out_.put(options_.format == FileFormat::kInventor ? "#Inventor V2.1 ascii\n"
             : vrml2                                  ? "#VRML V2.0 utf8\n"
                                                      : "#VRML V1.0 ascii\n");
    for (const std::string& line : comment_lines(options_.comment)) out_.put("# " + line + "\n");
    if (vrml2)
      write_vrml2();
    else
      write_inventor();
  }

 private:
  [[nodiscard]] bool is_cloud() const { return mesh_.corners.empty(); }

  void choose() {
    using Of = OutAttribute::Of;
    const bool vrml2 = options_.format == FileFormat::kVrml2;
    const auto take = [&](OutAttribute& attribute, const char* name, bool faces) {
      const auto fitting = [&](const std::vector<Channel>& channels) -> const Channel* {
        const Channel* c = find_channel(channels, name);
        const bool fits = c != nullptr &&
                          (c->components == attribute.width || (&attribute == &color_ && c->components == 4));
        return fits ? c : nullptr;
      };
      const auto use = [&](const std::vector<Channel>& channels, Of of) {
        if (attribute.channel != nullptr) return;
        attribute.channel = fitting(channels);
        if (attribute.channel != nullptr) attribute.of = of;
      };
      if (!is_cloud()) use(mesh_.corner_channels, Of::kCorners);
      use(mesh_.point_channels, Of::kPoints);
      if (faces && !is_cloud()) use(mesh_.face_channels, Of::kFaces);
    };
    uv_.width = 2;
    take(color_, "color", true);
    if (!vrml2 || !is_cloud()) {
      take(normal_, "normal", true);
      take(uv_, "uv", false);
    }
    if (color_.channel != nullptr && color_.channel->components == 4) {
      // Eight bits with an opacity are what Inventor's packed colours hold.
      if (options_.format == FileFormat::kInventor &&
          std::holds_alternative<std::vector<std::uint8_t>>(color_.channel->values)) {
        color_.packed = true;
        color_.width = 4;
      } else {
        notes_.push_back(
            {"dropped.opacities", "opacities of colours left out: written are red, green and blue"});
      }
    }
    const std::string reason = vrml2 && is_cloud()
                                   ? "VRML 2 holds colours of point sets"
                                   : name_of(options_.format) + " holds one each of normals, uv and colours";
    const auto note = [&](const char* element, const std::vector<Channel>& channels) {
      for (const Channel& c : channels)
        if (&c != normal_.channel && &c != uv_.channel && &c != color_.channel)
          note_left_out(notes_, element, c, reason);
    };
    note("point", mesh_.point_channels);
    note("corner", mesh_.corner_channels);
    note("face", mesh_.face_channels);
    for (OutAttribute* attribute : {&normal_, &uv_, &color_}) make_rows(*attribute);
  }

  void make_rows(OutAttribute& attribute) {
    if (attribute.channel == nullptr) return;
    const Channel& channel = *attribute.channel;
    const std::size_t count = channel.scalar_count() / channel.components;
    const auto row_at = [&](std::size_t i) {
      std::array<float, 4> row{};
      for (std::size_t k = 0; k < attribute.width; ++k) {
        const std::size_t at = i * channel.components + k;
        row[k] = attribute.packed        ? static_cast<float>(color_byte(channel, at))
                 : &attribute == &color_ ? color_fraction(channel, at)
                                         : channel_float(channel, at);
      }
      return row;
    };
    if (attribute.of != OutAttribute::Of::kCorners) {
      for (std::size_t i = 0; i < count; ++i) attribute.rows.push_back(row_at(i));
      return;
    }
    DistinctRows<4> distinct;
    for (std::size_t i = 0; i < count; ++i)
      attribute.row_of_corner.push_back(distinct.number(row_at(i).data(), attribute.rows));
  }

  void put_row(const float* row, std::size_t width) {
    char* to = out_.room(256);
    for (std::size_t k = 0; k < width; ++k) {
      *to++ = ' ';
      to = put_number(to, row[k]);
    }
    out_.commit(to);
  }

  void put_points() {
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      out_.put(i == 0 ? "\n" : ",\n");
      char* to = out_.room(256);
      for (int axis = 0; axis < 3; ++axis) {
        *to++ = ' ';
        to = put_coordinate(to, mesh_.points[i][axis], options_.offset[axis]);
      }
      out_.commit(to);
    }
  }

  void put_rows(const OutAttribute& attribute) {
    for (std::size_t i = 0; i < attribute.rows.size(); ++i) {
      const std::array<float, 4>& row = attribute.rows[i];
      out_.put(i == 0 ? "\n" : ",\n");
      if (!attribute.packed) {
        put_row(row.data(), attribute.width);
        continue;
      }
      std::string number = " 0x";
      for (const float byte : row)
        for (const unsigned shift : {4u, 0u})
          number += "0123456789abcdef"[(static_cast<unsigned>(byte) >> shift) & 15];
      out_.put(number);
    }
  }

  /// `name [ ... ]` with a number for each corner, each face ended by -1.
  template <class NumberOf>
  void put_index(std::string_view name, NumberOf&& number_of) {
    out_.put("    " + std::string(name) + " [");
    for (std::size_t f = 0, corner = 0; f < mesh_.face_count(); ++f) {
      out_.put(f == 0 ? "\n" : ",\n");
      for (std::size_t k = mesh_.face(f).size(); k > 0; --k) {
        char* to = out_.room(64);
        to = put_number(to, number_of(corner++));
        *to++ = ',';
        *to++ = ' ';
        out_.commit(to);
      }
      out_.put("-1");
    }
    out_.put("\n    ]\n");
  }

  void put_attribute_index(std::string_view name, const OutAttribute& attribute) {
    if (attribute.of == OutAttribute::Of::kCorners)
      put_index(name, [&](std::size_t corner) { return attribute.row_of_corner[corner]; });
  }

  void put_coordinate_index() {
    put_index("coordIndex", [&](std::size_t corner) { return mesh_.corners[corner]; });
  }

  void put_binding(std::string_view node, const OutAttribute& attribute) {
    out_.put("  " + std::string(node) + " { value " +
             (attribute.of == OutAttribute::Of::kFaces ? "PER_FACE"
              : is_cloud()                             ? "PER_VERTEX"
                                                       : "PER_VERTEX_INDEXED") +
             " }\n");
  }

  void write_inventor() {
    out_.put("Separator {\n");
    // Polygons that need not be convex, seen from both sides.
    if (!is_cloud())
      out_.put("  ShapeHints {\n    vertexOrdering COUNTERCLOCKWISE\n    faceType UNKNOWN_FACE_TYPE\n  }\n");
    out_.put("  Coordinate3 {\n    point [");
    put_points();
    out_.put("\n    ]\n  }\n");
    if (normal_.channel != nullptr) {
      out_.put("  Normal {\n    vector [");
      put_rows(normal_);
      out_.put("\n    ]\n  }\n");
      put_binding("NormalBinding", normal_);
    }
    if (uv_.channel != nullptr) {
      out_.put("  TextureCoordinate2 {\n    point [");
      put_rows(uv_);
      out_.put("\n    ]\n  }\n");
    }
    if (color_.channel != nullptr) {
      out_.put(color_.packed ? "  PackedColor {\n    orderedRGBA [" : "  Material {\n    diffuseColor [");
      put_rows(color_);
      out_.put("\n    ]\n  }\n");
      put_binding("MaterialBinding", color_);
    }
    if (is_cloud()) {
      out_.put("  PointSet {\n  }\n}\n");
      return;
    }
    out_.put("  IndexedFaceSet {\n");
    put_coordinate_index();
    put_attribute_index("normalIndex", normal_);
    put_attribute_index("textureCoordIndex", uv_);
    put_attribute_index("materialIndex", color_);
    out_.put("  }\n}\n");
  }

  void put_node(std::string_view field, std::string_view opening, const OutAttribute& attribute) {
    if (attribute.channel == nullptr) return;
    out_.put("    " + std::string(field) + " " + std::string(opening) + " [");
    put_rows(attribute);
    out_.put("\n    ] }\n");
    if (attribute.of == OutAttribute::Of::kFaces) out_.put("    " + std::string(field) + "PerVertex FALSE\n");
  }

  void write_vrml2() {
    out_.put("Shape {\n  appearance Appearance { material Material { } }\n  geometry ");
    out_.put(is_cloud() ? "PointSet {\n" : "IndexedFaceSet {\n    solid FALSE\n    convex FALSE\n");
    out_.put("    coord Coordinate { point [");
    put_points();
    out_.put("\n    ] }\n");
    put_node("normal", "Normal { vector", normal_);
    put_node("texCoord", "TextureCoordinate { point", uv_);
    put_node("color", "Color { color", color_);
    if (!is_cloud()) {
      put_coordinate_index();
      put_attribute_index("normalIndex", normal_);
      put_attribute_index("texCoordIndex", uv_);
      put_attribute_index("colorIndex", color_);
    }
    out_.put("  }\n}\n");
  }

  const IndexedFaceSet& mesh_;
  const WriteOptions& options_;
  Output& out_;
  Notes& notes_;
  OutAttribute normal_, uv_, color_;
};

}  // namespace

void encode_scene(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  SceneWriter(mesh, options, out, notes).write();
}

}  // namespace vkmesh::detail
