// Pieces of binary OpenInventor files, byte by byte.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace vkmesh::test {

inline std::string iv_word(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((value >> shift) & 0xff);
  return bytes;
}

inline std::string iv_string(std::string_view text) {
  std::string bytes = iv_word(static_cast<std::uint32_t>(text.size())) + std::string(text);
  while (bytes.size() % 4 != 0) bytes += '\0';
  return bytes;
}

inline std::string iv_reals(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) bytes += iv_word(std::bit_cast<std::uint32_t>(value));
  return bytes;
}

inline std::string iv_wholes(std::initializer_list<std::int32_t> values) {
  std::string bytes;
  for (const std::int32_t value : values) bytes += iv_word(static_cast<std::uint32_t>(value));
  return bytes;
}

/// A list of `width` words each.
inline std::string iv_list(const std::string& words, std::size_t width = 1) {
  return iv_word(static_cast<std::uint32_t>(words.size() / (4 * width))) + words;
}

/// A field: its name, its value, and no flag unless one is given.
inline std::string iv_field(std::string_view name, const std::string& value, std::uint32_t flags = 0) {
  return iv_string(name) + value + iv_word(flags);
}

/// How version 2.0 and 2.1 write nodes.
struct InventorBytes {
  bool has_flags = true;  ///< 2.1.

  [[nodiscard]] std::string header() const {
    return has_flags ? "#Inventor V2.1 binary   \n" : "#Inventor V2.0 binary   \n";
  }
  [[nodiscard]] std::string node(std::string_view type, const std::vector<std::string>& fields) const {
    return start(type, 0) + number_of(fields);
  }
  [[nodiscard]] std::string group(std::string_view type, const std::vector<std::string>& fields,
                                  const std::vector<std::string>& children) const {
    std::string bytes = start(type, 2);
    if (has_flags || type != "Group") bytes += number_of(fields);
    bytes += iv_word(static_cast<std::uint32_t>(children.size()));
    for (const std::string& child : children) bytes += child;
    return bytes;
  }
  /// A node of a program's own class, which describes its fields: their types and names.
  [[nodiscard]] std::string described(std::string_view type, const std::vector<std::string>& descriptions,
                                      const std::vector<std::string>& fields,
                                      const std::vector<std::string>& children) const {
    std::string bytes = start(type, children.empty() ? 0 : 2);
    bytes += iv_word(0x4000 | static_cast<std::uint32_t>(fields.size()));
    for (const std::string& description : descriptions) bytes += iv_string(description);
    for (const std::string& field : fields) bytes += field;
    if (!children.empty()) bytes += iv_word(static_cast<std::uint32_t>(children.size()));
    for (const std::string& child : children) bytes += child;
    return bytes;
  }

 private:
  [[nodiscard]] std::string start(std::string_view type, std::uint32_t flags) const {
    return iv_string(type) + (has_flags ? iv_word(flags) : std::string());
  }
  static std::string number_of(const std::vector<std::string>& fields) {
    std::string bytes = iv_word(static_cast<std::uint32_t>(fields.size()));
    for (const std::string& field : fields) bytes += field;
    return bytes;
  }
};

/// The scene of all kinds of values that inventor_text() has as text.
inline std::string inventor_scene(const InventorBytes& iv) {
  const std::string points = iv_list(iv_reals({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}), 3);
  std::vector<std::string> children = {
      iv.node("Info", {iv_field("string", iv_string("made by a test"))}),
      iv.node("PerspectiveCamera",
              {iv_field("position", iv_reals({0, 0, 5})), iv_field("orientation", iv_reals({0, 0, 1, 0.5f})),
               iv_field("viewportMapping", iv_string("ADJUST_CAMERA"))}),
      iv.node("FontStyle", {iv_field("name", iv_string("Times")),
                            iv_field("style", iv_string("BOLD") + iv_string("ITALIC") + iv_string(""))}),
      iv.node("Texture2", {iv_field("filename", iv_string("")),
                           iv_field("image", iv_wholes({3, 2, 1}) +
                                                 (iv.has_flags ? iv_word(0x01020304) + iv_word(0x05060000)
                                                               : iv_wholes({1, 2, 3, 4, 5, 6})))}),
      iv.node("Texture2Transform", {iv_field("translation", iv_reals({1, 2}))}),
      iv_string("DEF") + iv_string("Points+0") + iv.node("Coordinate3", {iv_field("point", points)}),
      iv.node("Transform",
              {iv_field("translation", iv_reals({1, 2, 3})), iv_field("rotation", iv_reals({0, 0, 1, 1.5f})),
               iv_field("scaleFactor", iv_reals({1, 2, 1})), iv_field("center", iv_reals({1, 1, 1}))}),
      // A rotation that an engine turns while a program runs.
      iv.node("RotationXYZ",
              {iv_field("axis", iv_string("Y")),
               iv_field("angle", iv_reals({0.25f}), 2) +
                   iv.node("ElapsedTime", {iv_field("speed", iv_reals({2})), iv_field("on", iv_word(0))}) +
                   iv_string("timeOut")}),
      iv.node("Scale", {iv_field("scaleFactor", iv_reals({9, 9, 9}), 1)}),
      iv.node("Normal", {iv_field("vector", iv_list(iv_reals({0, 0, 1, 0, 1, 0}), 3))}),
      iv.node("NormalBinding", {iv_field("value", iv_string("PER_VERTEX_INDEXED"))}),
      iv.node("Material", {iv_field("diffuseColor", iv_list(iv_reals({1, 0, 0, 0, 1, 0}), 3)),
                           iv_field("shininess", iv_list(iv_reals({0.25f})))}),
      iv.node("MaterialBinding", {iv_field("value", iv_string("PER_FACE"))}),
      iv.node("IndexedFaceSet", {iv_field("coordIndex", iv_list(iv_wholes({0, 1, 2, -1, 0, 2, 3, -1}))),
                                 iv_field("normalIndex", iv_list(iv_wholes({0, 0, 1, -1, 1, 0, 1, -1})))}),
      iv.group("Switch", {iv_field("whichChild", iv_word(0))},
               {iv.group("Group", {},
                         {iv_string("USE") + iv_string("Points+0"),
                          iv.node("PointSet", {iv_field("numPoints", iv_word(2))})}),
                iv.node("Sphere", {})}),
      // A class that no reader knows; what it gives a name to can be used.
      iv.described("GearWheel",
                   {"SFFloat", "teeth", "MFTime", "times", "SFNode", "alternateRep", "MFString", "names"},
                   {iv_field("teeth", iv_reals({12})), iv_field("times", iv_list(iv_wholes({1, 2, 3, 4}), 2)),
                    iv_field("alternateRep", iv_string("NULL")),
                    iv_field("names", iv_word(2) + iv_string("a") + iv_string("bcde"))},
                   iv.has_flags ? std::vector{iv_string("DEF") + iv_string("Box") +
                                              iv.node("Cube", {iv_field("width", iv_reals({3}))})}
                                : std::vector<std::string>()),
      iv.node("Cone", {iv_field("parts", iv_string("SIDES") + iv_string(""))}),
      iv.node("Cube", {iv_field("depth", iv_reals({0.5f}))})};
  if (iv.has_flags) {
    children.push_back(iv_string("USE") + iv_string("Box"));
    children.push_back(iv.node(
        "IndexedTriangleStripSet",
        {iv_field("vertexProperty",
                  iv.node("VertexProperty",
                          {iv_field("vertex", points),
                           iv_field("orderedRGBA", iv_list(iv_word(0xff0000ff) + iv_word(0x00ff0080))),
                           iv_field("materialBinding", iv_string("PER_FACE"))})),
         iv_field("coordIndex", iv_list(iv_wholes({0, 1, 2, 3, -1})))}));
  } else {
    children.push_back(iv.node("PackedColor", {iv_field("rgba", iv_list(iv_word(0x80ff7f40)))}));
    children.push_back(iv.node("FaceSet", {iv_field("numVertices", iv_list(iv_word(3)))}));
  }
  return iv.group("Separator", {iv_field("renderCaching", iv_string("OFF"))}, children);
}

inline std::string inventor_text(bool has_flags) {
  return std::string("#Inventor V2.") + (has_flags ? "1" : "0") + R"( ascii
Separator { renderCaching OFF
  Info { string "made by a test" }
  PerspectiveCamera { position 0 0 5 orientation 0 0 1 0.5 viewportMapping ADJUST_CAMERA }
  FontStyle { name "Times" style (BOLD | ITALIC) }
  Texture2 { filename "" image 3 2 1 1 2 3 4 5 6 }
  Texture2Transform { translation 1 2 }
  DEF Points+0 Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }
  Transform { translation 1 2 3 rotation 0 0 1 1.5 scaleFactor 1 2 1 center 1 1 1 }
  RotationXYZ { axis Y angle 0.25 = ElapsedTime { speed 2 on FALSE } . timeOut }
  Scale { scaleFactor 9 9 9 ~ }
  Normal { vector [ 0 0 1, 0 1 0 ] }
  NormalBinding { value PER_VERTEX_INDEXED }
  Material { diffuseColor [ 1 0 0, 0 1 0 ] shininess 0.25 }
  MaterialBinding { value PER_FACE }
  IndexedFaceSet { coordIndex [ 0, 1, 2, -1, 0, 2, 3, -1 ] normalIndex [ 0, 0, 1, -1, 1, 0, 1, -1 ] }
  Switch { whichChild 0 Group { USE Points+0 PointSet { numPoints 2 } } Sphere { } }
  GearWheel { fields [ SFFloat teeth ] teeth 12 DEF Box Cube { width 3 } }
  Cone { parts SIDES }
  Cube { depth 0.5 }
)" +
         (has_flags ? R"(
  USE Box
  IndexedTriangleStripSet { vertexProperty VertexProperty { vertex [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ]
    orderedRGBA [ 0xff0000ff, 0x00ff0080 ] materialBinding PER_FACE } coordIndex [ 0, 1, 2, 3, -1 ] }
})"
                    : R"(
  PackedColor { rgba [ 0x80ff7f40 ] }
  FaceSet { numVertices [ 3 ] }
})");
}

}  // namespace vkmesh::test
