// OpenInventor 2, as text and binary, and VRML 1 (Wernecke, The Inventor Mentor, 1994; Bell, Parisi and
// Pesce, The Virtual Reality Modeling Language, version 1.0): scenes whose nodes change a state that later
// shapes draw with.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "io/formats.h"
#include "io/inventor/scene_graph.h"
#include "io/inventor/scene_mesh.h"
#include "io/inventor/scene_primitives.h"
#include "io/inventor/scene_transform.h"

namespace vkmesh::detail {
namespace {

enum Kind {
  kSeparator = 1,
  kGroup,
  kTransformSeparator,
  kSwitch,
  kLod,
  kCoordinate3,
  kCoordinate4,
  kVertexProperty,
  kNormal,
  kNormalBinding,
  kTextureCoordinate2,
  kTextureCoordinateBinding,
  kMaterial,
  kBaseColor,
  kPackedColor,
  kMaterialBinding,
  kShapeHints,
  kTransform,
  kMatrixTransform,
  kTranslation,
  kRotation,
  kRotationXyz,
  kScale,
  kResetTransform,
  kUnits,
  kIndexedFaceSet,
  kFaceSet,
  kIndexedTriangleStripSet,
  kTriangleStripSet,
  kQuadMesh,
  kPointSet,
  kCube,
  kSphere,
  kCone,
  kCylinder,
  kInline
};

constexpr KnownNode kNodes[] = {{"Separator", kSeparator},
                                {"Annotation", kSeparator},
                                {"Selection", kSeparator},
                                {"WWWAnchor", kSeparator},
                                {"Group", kGroup},
                                {"TransformSeparator", kTransformSeparator},
                                {"Switch", kSwitch},
                                {"LOD", kLod},
                                {"LevelOfDetail", kLod},
                                {"Coordinate3", kCoordinate3},
                                {"Coordinate4", kCoordinate4},
                                {"VertexProperty", kVertexProperty},
                                {"Normal", kNormal},
                                {"NormalBinding", kNormalBinding},
                                {"TextureCoordinate2", kTextureCoordinate2},
                                {"TextureCoordinateBinding", kTextureCoordinateBinding},
                                {"Material", kMaterial},
                                {"BaseColor", kBaseColor},
                                {"PackedColor", kPackedColor},
                                {"MaterialBinding", kMaterialBinding},
                                {"ShapeHints", kShapeHints},
                                {"Transform", kTransform},
                                {"MatrixTransform", kMatrixTransform},
                                {"Translation", kTranslation},
                                {"Rotation", kRotation},
                                {"RotationXYZ", kRotationXyz},
                                {"Scale", kScale},
                                {"ResetTransform", kResetTransform},
                                {"Units", kUnits},
                                {"IndexedFaceSet", kIndexedFaceSet},
                                {"FaceSet", kFaceSet},
                                {"IndexedTriangleStripSet", kIndexedTriangleStripSet},
                                {"TriangleStripSet", kTriangleStripSet},
                                {"QuadMesh", kQuadMesh},
                                {"PointSet", kPointSet},
                                {"Cube", kCube},
                                {"Sphere", kSphere},
                                {"Cone", kCone},
                                {"Cylinder", kCylinder},
                                {"WWWInline", kInline},
                                {"File", kInline}};

constexpr std::string_view kFields[] = {"whichChild",
                                        "point",
                                        "vertex",
                                        "normal",
                                        "texCoord",
                                        "orderedRGBA",
                                        "rgba",
                                        "normalBinding",
                                        "materialBinding",
                                        "vector",
                                        "value",
                                        "diffuseColor",
                                        "rgb",
                                        "vertexOrdering",
                                        "translation",
                                        "rotation",
                                        "scaleFactor",
                                        "scaleOrientation",
                                        "center",
                                        "matrix",
                                        "axis",
                                        "angle",
                                        "whatToReset",
                                        "units",
                                        "vertexProperty",
                                        "coordIndex",
                                        "normalIndex",
                                        "textureCoordIndex",
                                        "materialIndex",
                                        "numVertices",
                                        "startIndex",
                                        "verticesPerRow",
                                        "verticesPerColumn",
                                        "numPoints",
                                        "width",
                                        "height",
                                        "depth",
                                        "radius",
                                        "bottomRadius",
                                        "parts",
                                        "name"};

struct BindingName {
  std::string_view name;
  SceneBinding binding;
};

constexpr BindingName kBindings[] = {{"OVERALL", SceneBinding::kOverall},
                                     {"PER_PART", SceneBinding::kPart},
                                     {"PER_PART_INDEXED", SceneBinding::kPartIndexed},
                                     {"PER_FACE", SceneBinding::kFace},
                                     {"PER_FACE_INDEXED", SceneBinding::kFaceIndexed},
                                     {"PER_VERTEX", SceneBinding::kVertex},
                                     {"PER_VERTEX_INDEXED", SceneBinding::kVertexIndexed}};

struct UnitName {
  std::string_view name;
  double meters;
};

constexpr UnitName kUnitNames[] = {{"METERS", 1},         {"CENTIMETERS", 1e-2},   {"MILLIMETERS", 1e-3},
                                   {"MICROMETERS", 1e-6}, {"MICRONS", 1e-6},       {"NANOMETERS", 1e-9},
                                   {"ANGSTROMS", 1e-10},  {"KILOMETERS", 1e3},     {"FEET", 0.3048},
                                   {"INCHES", 0.0254},    {"POINTS", 0.0254 / 72}, {"YARDS", 0.9144},
                                   {"MILES", 1609.344},   {"NAUTICAL_MILES", 1852}};

/// What nodes change and shapes use.
struct State {
  const SceneDoubles* points = nullptr;
  unsigned width = 3;
  SceneAttribute normal{nullptr, 3, SceneBinding::kVertexIndexed, nullptr, false};
  SceneAttribute uv{nullptr, 2, SceneBinding::kVertexIndexed, nullptr, false};
  SceneAttribute color{nullptr, 3, SceneBinding::kOverall, nullptr, false};
  glm::dmat4 matrix{1.0};
  double meters = 1;
  bool clockwise = false;
};

class InventorReader {
 public:
  InventorReader(const Source& source, FileFormat format, FileEncoding encoding)
      : source_(source), numbers_(source), mesh_(source, numbers_) {
    file_.format = format;
    file_.encoding = encoding;
  }

  Result<MeshFile> read() {
    VKMESH_TRY(graph_, parse());
    State state;
    for (const std::uint32_t root : graph_.roots) VKMESH_CHECK(visit(root, state, 0));
    VKMESH_TRY(file_.geometry, mesh_.finish(ignored_, file_.notes));
    ignored_.add_to(file_.notes);
    return std::move(file_);
  }

 private:
  Result<SceneGraph> parse() {
    if (file_.encoding == FileEncoding::kAscii)
      return parse_scene(source_, kNodes, kFields, ignored_, file_.notes);
    const std::string_view bytes = source_.bytes;
    const std::size_t line = std::min(bytes.find_first_of("\r\n"), bytes.size());
    const bool has_flags = !bytes.substr(0, line).starts_with("#Inventor V2.0");
    return parse_binary_scene(source_, bytes.data() + std::min(line + 1, bytes.size()), has_flags, kNodes,
                              kFields, ignored_, file_.notes);
  }

  Result<void> visit_all(const SceneNode& node, State& state, std::size_t depth) {
    for (const std::uint32_t child : node.children) VKMESH_CHECK(visit(child, state, depth + 1));
    return {};
  }

  Result<void> visit(std::uint32_t index, State& state, std::size_t depth) {
    const SceneNode& node = graph_.nodes[index];
    VKMESH_TRY(const bool known, mesh_.enter(node, depth));
    if (!known) return {};
    switch (node.kind) {
      case kSeparator: {
        State inner = state;
        return visit_all(node, inner, depth);
      }
      case kTransformSeparator: {
        const glm::dmat4 matrix = state.matrix;
        VKMESH_CHECK(visit_all(node, state, depth));
        state.matrix = matrix;
        return {};
      }
      case kGroup:
        return visit_all(node, state, depth);
      case kSwitch:
        return visit_switch(node, state, depth);
      case kLod:
        if (node.children.empty()) return {};
        mesh_.pass_levels(node.children.size() - 1);
        return visit(node.children.front(), state, depth + 1);
      case kIndexedFaceSet:
      case kFaceSet:
      case kIndexedTriangleStripSet:
      case kTriangleStripSet:
      case kQuadMesh:
      case kPointSet:
        return shape(node, state);
      case kCube:
      case kSphere:
      case kCone:
      case kCylinder:
        return primitive(node, state);
      case kInline: {
        const SceneField* name = node.field("name");
        VKMESH_TRY(const bool read, mesh_.add_inline(node, name == nullptr ? std::string() : name->string(),
                                                     state.matrix, file_.notes));
        if (!read) ignored_.add(node.type);
        return {};
      }
      case kTransform:
      case kMatrixTransform:
      case kTranslation:
      case kRotation:
      case kRotationXyz:
      case kScale:
      case kResetTransform:
      case kUnits:
        return transform(node, state);
      default:
        return property(node, state);
    }
  }

  Result<void> visit_switch(const SceneNode& node, State& state, std::size_t depth) {
    constexpr std::int64_t kAll = -3;
    std::int64_t which = -1;
    VKMESH_CHECK(numbers_.whole_number(node.field("whichChild"), which));
    if (which == kAll) return visit_all(node, state, depth);
    const bool one = which >= 0 && static_cast<std::uint64_t>(which) < node.children.size();
    mesh_.pass_choices(node.children.size() - (one ? 1 : 0));
    return one ? visit(node.children[static_cast<std::size_t>(which)], state, depth + 1) : Result<void>{};
  }

  Result<void> transform(const SceneNode& node, State& state) {
    glm::dmat4 matrix(1.0);
    switch (node.kind) {
      case kTransform: {
        VKMESH_TRY(matrix, transform_of(numbers_, node, "scaleFactor"));
        break;
      }
      case kMatrixTransform:
        // The file multiplies rows by the matrix, GLM the matrix by columns: rows here are columns there.
        VKMESH_CHECK(numbers_.values(node.field("matrix"), {&matrix[0][0], 16}));
        break;
      case kTranslation: {
        glm::dvec3 by(0.0);
        VKMESH_CHECK(numbers_.values(node.field("translation"), {&by.x, 3}));
        matrix = glm::translate(matrix, by);
        break;
      }
      case kRotation: {
        glm::dvec4 by(0, 0, 1, 0);
        VKMESH_CHECK(numbers_.values(node.field("rotation"), {&by.x, 4}));
        matrix = axis_rotation(by);
        break;
      }
      case kRotationXyz: {
        double angle = 0;
        VKMESH_CHECK(numbers_.values(node.field("angle"), {&angle, 1}));
        const std::string_view axis = node.word("axis", "X");
        matrix = axis_rotation({axis == "X" ? 1 : 0, axis == "Y" ? 1 : 0, axis == "Z" ? 1 : 0, angle});
        break;
      }
      case kScale: {
        glm::dvec3 by(1.0);
        VKMESH_CHECK(numbers_.values(node.field("scaleFactor"), {&by.x, 3}));
        matrix = glm::scale(matrix, by);
        break;
      }
      case kUnits: {
        const std::string_view name = node.word("units", "METERS");
        for (const UnitName& unit : kUnitNames)
          if (unit.name == name) {
            matrix = glm::scale(matrix, glm::dvec3(unit.meters / state.meters));
            state.meters = unit.meters;
          }
        break;
      }
      default:
        if (node.word("whatToReset", "TRANSFORM").find("TRANSFORM") != std::string_view::npos)
          state.matrix = matrix;
        return {};
    }
    state.matrix = state.matrix * matrix;
    if (!is_finite(state.matrix))
      return source_.bad_line(node.type.data(), "the transform has elements that are not finite");
    return {};
  }

  Result<void> bind(const SceneNode& node, std::string_view field, SceneBinding otherwise,
                    SceneAttribute& attribute) {
    const std::string_view name = node.word(field, "DEFAULT");
    attribute.binding = otherwise;
    for (const BindingName& known : kBindings)
      if (known.name == name) attribute.binding = known.binding;
    return {};
  }

  Result<void> property(const SceneNode& node, State& state) {
    switch (node.kind) {
      case kCoordinate3:
      case kCoordinate4: {
        state.width = node.kind == kCoordinate3 ? 3 : 4;
        VKMESH_TRY(state.points, numbers_.doubles(node.field("point"), state.width));
        return {};
      }
      case kNormal: {
        VKMESH_TRY(state.normal.values, numbers_.floats(node.field("vector"), 3));
        return {};
      }
      case kNormalBinding:
        return bind(node, "value", SceneBinding::kVertexIndexed, state.normal);
      case kTextureCoordinate2: {
        VKMESH_TRY(state.uv.values, numbers_.floats(node.field("point"), 2));
        return {};
      }
      case kTextureCoordinateBinding:
        return bind(node, "value", SceneBinding::kVertexIndexed, state.uv);
      case kMaterial:
      case kBaseColor: {
        const SceneField* field = node.field(node.kind == kMaterial ? "diffuseColor" : "rgb");
        VKMESH_TRY(state.color.values, numbers_.floats(field, 3));
        state.color.components = 3;
        state.color.bytes = false;
        return {};
      }
      case kPackedColor:
        return packed(node, state);
      case kMaterialBinding:
        return bind(node, "value", SceneBinding::kOverall, state.color);
      case kShapeHints:
        state.clockwise = node.word("vertexOrdering", "") == "CLOCKWISE";
        return {};
      default:
        return vertex_property(node, state);
    }
  }

  Result<void> packed(const SceneNode& node, State& state) {
    // Version 2.0 has another field, whose first byte is the last of this.
    const SceneField* ordered = node.field("orderedRGBA");
    VKMESH_TRY(state.color.values, ordered != nullptr ? numbers_.packed_colors(ordered)
                                                      : numbers_.packed_colors(node.field("rgba"), true));
    state.color.components = 4;
    state.color.bytes = true;
    return {};
  }

  /// Only the fields that hold something replace what the state has.
  Result<void> vertex_property(const SceneNode& node, State& state) {
    VKMESH_TRY(const SceneDoubles* points, numbers_.doubles(node.field("vertex"), 3));
    if (points != nullptr && !points->values.empty()) {
      state.points = points;
      state.width = 3;
    }
    VKMESH_TRY(const SceneFloats* normals, numbers_.floats(node.field("normal"), 3));
    if (normals != nullptr && !normals->values.empty()) {
      state.normal.values = normals;
      VKMESH_CHECK(bind(node, "normalBinding", SceneBinding::kVertexIndexed, state.normal));
    }
    VKMESH_TRY(const SceneFloats* uv, numbers_.floats(node.field("texCoord"), 2));
    if (uv != nullptr && !uv->values.empty()) state.uv.values = uv;
    VKMESH_TRY(const SceneFloats* colors, numbers_.packed_colors(node.field("orderedRGBA")));
    if (colors != nullptr && !colors->values.empty()) VKMESH_CHECK(packed(node, state));
    if ((colors != nullptr && !colors->values.empty()) || node.field("materialBinding") != nullptr)
      VKMESH_CHECK(bind(node, "materialBinding", SceneBinding::kOverall, state.color));
    return {};
  }

  /// Whether the `parts` of a primitive have this one.
  static bool has_part(const SceneNode& node, std::string_view part) {
    const std::string_view parts = node.word("parts", "ALL");
    return parts.find("ALL") != std::string_view::npos || parts.find(part) != std::string_view::npos;
  }

  Result<void> primitive(const SceneNode& node, const State& state) {
    glm::dvec3 size(2.0);
    double radius = 1, bottom_radius = 1;
    VKMESH_CHECK(numbers_.values(node.field("width"), {&size.x, 1}));
    VKMESH_CHECK(numbers_.values(node.field("height"), {&size.y, 1}));
    VKMESH_CHECK(numbers_.values(node.field("depth"), {&size.z, 1}));
    VKMESH_CHECK(numbers_.values(node.field("radius"), {&radius, 1}));
    VKMESH_CHECK(numbers_.values(node.field("bottomRadius"), {&bottom_radius, 1}));
    const bool sides = has_part(node, "SIDES"), bottom = has_part(node, "BOTTOM");
    SceneShape shape;
    shape.type = node.type;
    shape.matrix = state.matrix;
    shape.color = state.color;
    // Primitives have parts of their own; the first colour stands for all.
    shape.color.binding = SceneBinding::kOverall;
    return mesh_.add_primitive(std::move(shape), node, node.kind != kCube, [&] {
      switch (node.kind) {
        case kCube:
          return scene_box(size);
        case kSphere:
          return scene_sphere(radius);
        case kCone:
          return scene_cylinder(bottom_radius, 0, size.y, sides, bottom, false);
        default:
          return scene_cylinder(radius, radius, size.y, sides, bottom, has_part(node, "TOP"));
      }
    });
  }

  Result<void> shape(const SceneNode& node, const State& outside) {
    State state = outside;
    if (const SceneField* property = node.field("vertexProperty"))
      for (const std::uint32_t index : property->nodes)
        if (graph_.nodes[index].kind == kVertexProperty)
          VKMESH_CHECK(vertex_property(graph_.nodes[index], state));
    SceneShape shape;
    shape.type = node.type;
    shape.points = state.points;
    shape.width = state.width;
    shape.matrix = state.matrix;
    shape.clockwise = state.clockwise;
    shape.normal = state.normal;
    shape.uv = state.uv;
    shape.color = state.color;
    std::int64_t start = 0;
    VKMESH_CHECK(numbers_.whole_number(node.field("startIndex"), start));
    if (node.kind == kIndexedFaceSet || node.kind == kIndexedTriangleStripSet) {
      VKMESH_TRY(shape.normal.index, numbers_.indices(node.field("normalIndex")));
      VKMESH_TRY(shape.uv.index, numbers_.indices(node.field("textureCoordIndex")));
      VKMESH_TRY(shape.color.index, numbers_.indices(node.field("materialIndex")));
      VKMESH_TRY(const SceneIndices* index, numbers_.indices(node.field("coordIndex")));
      return node.kind == kIndexedFaceSet ? mesh_.add_indexed_faces(shape, index)
                                          : mesh_.add_indexed_strips(shape, index);
    }
    // Without indices the indexed bindings say what the others do.
    for (SceneAttribute* attribute : {&shape.normal, &shape.uv, &shape.color}) {
      SceneBinding& binding = attribute->binding;
      if (binding == SceneBinding::kPartIndexed) binding = SceneBinding::kPart;
      if (binding == SceneBinding::kFaceIndexed) binding = SceneBinding::kFace;
      if (binding == SceneBinding::kVertexIndexed) binding = SceneBinding::kVertex;
    }
    if (node.kind == kQuadMesh) {
      std::int64_t per_row = 1, per_column = 1;
      VKMESH_CHECK(numbers_.whole_number(node.field("verticesPerRow"), per_row));
      VKMESH_CHECK(numbers_.whole_number(node.field("verticesPerColumn"), per_column));
      return mesh_.add_quads(shape, per_row, per_column, start);
    }
    if (node.kind == kPointSet) {
      std::int64_t count = -1;
      VKMESH_CHECK(numbers_.whole_number(node.field("numPoints"), count));
      return mesh_.add_points(shape, count, start);
    }
    VKMESH_TRY(const SceneIndices* counts, numbers_.indices(node.field("numVertices")));
    return node.kind == kFaceSet ? mesh_.add_faces(shape, counts, start)
                                 : mesh_.add_strips(shape, counts, start);
  }

  const Source& source_;
  MeshFile file_;
  IgnoredNodes ignored_;
  SceneGraph graph_;
  SceneNumbers numbers_;
  SceneMesh mesh_;
};

}  // namespace

Result<MeshFile> parse_inventor(const Source& source, FileFormat format) {
  return InventorReader(source, format, FileEncoding::kAscii).read();
}

Result<MeshFile> parse_binary_inventor(const Source& source) {
  Source without_lines = source;
  without_lines.has_lines = false;
  return InventorReader(without_lines, FileFormat::kInventor, FileEncoding::kBinaryBigEndian).read();
}

}  // namespace vkmesh::detail
