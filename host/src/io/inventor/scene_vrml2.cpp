// VRML 97 (ISO/IEC 14772-1), also called VRML 2.0: scenes of shapes that each name what they are drawn with.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats.h"
#include "io/inventor/scene_graph.h"
#include "io/inventor/scene_mesh.h"
#include "io/inventor/scene_primitives.h"
#include "io/inventor/scene_transform.h"

namespace vkmesh::detail {
namespace {

enum Kind {
  kGroup = 1,
  kTransform,
  kSwitch,
  kLod,
  kShape,
  kAppearance,
  kMaterial,
  kIndexedFaceSet,
  kPointSet,
  kBox,
  kSphere,
  kCone,
  kCylinder,
  kElevationGrid,
  kExtrusion,
  kInline,
  kCoordinate,
  kNormal,
  kColor,
  kTextureCoordinate
};

constexpr KnownNode kNodes[] = {{"Group", kGroup},
                                {"Anchor", kGroup},
                                {"Billboard", kGroup},
                                {"Collision", kGroup},
                                {"Transform", kTransform},
                                {"Switch", kSwitch},
                                {"LOD", kLod},
                                {"Shape", kShape},
                                {"Appearance", kAppearance},
                                {"Material", kMaterial},
                                {"IndexedFaceSet", kIndexedFaceSet},
                                {"PointSet", kPointSet},
                                {"Box", kBox},
                                {"Sphere", kSphere},
                                {"Cone", kCone},
                                {"Cylinder", kCylinder},
                                {"ElevationGrid", kElevationGrid},
                                {"Extrusion", kExtrusion},
                                {"Inline", kInline},
                                {"Coordinate", kCoordinate},
                                {"Normal", kNormal},
                                {"Color", kColor},
                                {"TextureCoordinate", kTextureCoordinate}};

constexpr std::string_view kFields[] = {"children",
                                        "choice",
                                        "whichChoice",
                                        "level",
                                        "appearance",
                                        "geometry",
                                        "material",
                                        "diffuseColor",
                                        "coord",
                                        "coordIndex",
                                        "color",
                                        "colorIndex",
                                        "colorPerVertex",
                                        "normal",
                                        "normalIndex",
                                        "normalPerVertex",
                                        "texCoord",
                                        "texCoordIndex",
                                        "ccw",
                                        "point",
                                        "vector",
                                        "translation",
                                        "rotation",
                                        "scale",
                                        "scaleOrientation",
                                        "center",
                                        "size",
                                        "radius",
                                        "height",
                                        "bottomRadius",
                                        "side",
                                        "bottom",
                                        "top",
                                        "url",
                                        "xDimension",
                                        "zDimension",
                                        "xSpacing",
                                        "zSpacing",
                                        "spine",
                                        "crossSection",
                                        "orientation",
                                        "beginCap",
                                        "endCap"};

class Vrml2Reader {
 public:
  explicit Vrml2Reader(const Source& source) : source_(source), numbers_(source), mesh_(source, numbers_) {
    file_.format = FileFormat::kVrml2;
  }

  Result<MeshFile> read() {
    VKMESH_TRY(graph_, parse_scene(source_, kNodes, kFields, ignored_, file_.notes));
    VKMESH_CHECK(visit_all(graph_.roots, glm::dmat4(1.0), 0));
    VKMESH_TRY(file_.geometry, mesh_.finish(ignored_, file_.notes));
    ignored_.add_to(file_.notes);
    return std::move(file_);
  }

 private:
  Result<void> visit_all(const std::vector<std::uint32_t>& nodes, const glm::dmat4& matrix,
                         std::size_t depth) {
    for (const std::uint32_t node : nodes) VKMESH_CHECK(visit(node, matrix, depth));
    return {};
  }

  Result<void> visit_field(const SceneField* field, const glm::dmat4& matrix, std::size_t depth) {
    return field == nullptr ? Result<void>{} : visit_all(field->nodes, matrix, depth + 1);
  }

  Result<void> visit(std::uint32_t index, const glm::dmat4& matrix, std::size_t depth) {
    const SceneNode& node = graph_.nodes[index];
    VKMESH_TRY(const bool known, mesh_.enter(node, depth));
    if (!known) return {};
    switch (node.kind) {
      case kGroup:
        return visit_field(node.field("children"), matrix, depth);
      case kTransform: {
        VKMESH_TRY(const glm::dmat4 own, transform_of(numbers_, node, "scale"));
        const glm::dmat4 inner = matrix * own;
        if (!is_finite(inner))
          return source_.bad_line(node.type.data(), "the transform has elements that are not finite");
        return visit_field(node.field("children"), inner, depth);
      }
      case kSwitch: {
        std::int64_t which = -1;
        VKMESH_CHECK(numbers_.whole_number(node.field("whichChoice"), which));
        const SceneField* choice = node.field("choice");
        if (choice == nullptr) return {};
        const bool one = which >= 0 && static_cast<std::uint64_t>(which) < choice->nodes.size();
        mesh_.pass_choices(choice->nodes.size() - (one ? 1 : 0));
        return one ? visit(choice->nodes[static_cast<std::size_t>(which)], matrix, depth + 1)
                   : Result<void>{};
      }
      case kLod: {
        const SceneField* level = node.field("level");
        if (level == nullptr || level->nodes.empty()) return {};
        mesh_.pass_levels(level->nodes.size() - 1);
        return visit(level->nodes.front(), matrix, depth + 1);
      }
      case kShape:
        return shape(node, matrix);
      case kInline: {
        const SceneField* url = node.field("url");
        VKMESH_TRY(const bool read, mesh_.add_inline(node, url == nullptr ? std::string() : url->string(),
                                                     matrix, file_.notes));
        if (!read) ignored_.add(node.type);
        return {};
      }
      default:
        // A node that is no child of a group.
        ignored_.add(node.type);
        return {};
    }
  }

  /// The node of one of two types that a field holds, or nullptr.
  const SceneNode* child(const SceneNode& node, std::string_view field, int kind, int other = 0) const {
    const SceneField* f = node.field(field);
    if (f == nullptr || f->nodes.empty()) return nullptr;
    const SceneNode& found = graph_.nodes[f->nodes.front()];
    return found.kind != 0 && (found.kind == kind || found.kind == other) ? &found : nullptr;
  }

  /// The node that gives a shape its surface or points, or nullptr.
  const SceneNode* geometry_of(const SceneNode& node) const {
    const SceneField* field = node.field("geometry");
    if (field == nullptr || field->nodes.empty()) return nullptr;
    const SceneNode& found = graph_.nodes[field->nodes.front()];
    switch (found.kind) {
      case kIndexedFaceSet:
      case kPointSet:
      case kBox:
      case kSphere:
      case kCone:
      case kCylinder:
      case kElevationGrid:
      case kExtrusion:
        return &found;
      default:
        return nullptr;
    }
  }

  static bool is_true(const SceneNode& node, std::string_view field) {
    return node.word(field, "TRUE") != "FALSE";
  }

  Result<void> primitive(const SceneNode& node, SceneShape shape) {
    glm::dvec3 size(2.0);
    double radius = 1, bottom_radius = 1, height = 2;
    VKMESH_CHECK(numbers_.values(node.field("size"), {&size.x, 3}));
    VKMESH_CHECK(numbers_.values(node.field("radius"), {&radius, 1}));
    VKMESH_CHECK(numbers_.values(node.field("bottomRadius"), {&bottom_radius, 1}));
    // Only these have a single height.
    if (node.kind == kCone || node.kind == kCylinder)
      VKMESH_CHECK(numbers_.values(node.field("height"), {&height, 1}));
    const bool side = is_true(node, "side"), bottom = is_true(node, "bottom"), top = is_true(node, "top");
    if (node.kind == kExtrusion) return extrusion(node, std::move(shape));
    const bool round = node.kind != kBox;
    return mesh_.add_primitive(std::move(shape), node, round, [&] {
      switch (node.kind) {
        case kBox:
          return scene_box(size);
        case kSphere:
          return scene_sphere(radius);
        case kCone:
          return scene_cylinder(bottom_radius, 0, height, side, bottom, false);
        default:
          return scene_cylinder(radius, radius, height, side, bottom, top);
      }
    });
  }

  Result<void> elevation_grid(const SceneNode& node, SceneShape shape) {
    std::int64_t columns = 0, rows = 0;
    double x_spacing = 1, z_spacing = 1;
    VKMESH_CHECK(numbers_.whole_number(node.field("xDimension"), columns));
    VKMESH_CHECK(numbers_.whole_number(node.field("zDimension"), rows));
    VKMESH_CHECK(numbers_.values(node.field("xSpacing"), {&x_spacing, 1}));
    VKMESH_CHECK(numbers_.values(node.field("zSpacing"), {&z_spacing, 1}));
    VKMESH_TRY(const SceneDoubles* heights, numbers_.doubles(node.field("height"), 1));
    const std::size_t given = heights == nullptr ? 0 : heights->values.size();
    if (columns < 0 || rows < 0 ||
        (columns > 0 && static_cast<std::uint64_t>(rows) > given / static_cast<std::uint64_t>(columns)))
      return source_.bad_line(node.type.data(), std::to_string(columns) + " × " + std::to_string(rows) +
                                                    " heights are asked for, but there are " +
                                                    std::to_string(given));
    if (columns < 2 || rows < 2) return {};
    return mesh_.add_primitive(std::move(shape), node, false, [&] {
      return scene_elevation_grid(static_cast<int>(columns), static_cast<int>(rows), x_spacing, z_spacing,
                                  heights->values);
    });
  }

  template <class Row>
  Result<void> rows(const SceneNode& node, std::string_view field, std::vector<Row>& to) {
    constexpr unsigned kWidth = sizeof(Row) / sizeof(double);
    VKMESH_TRY(const SceneDoubles* values, numbers_.doubles(node.field(field), kWidth));
    if (values == nullptr) return {};
    to.resize(values->values.size() / kWidth);
    for (std::size_t i = 0; i < to.size(); ++i)
      for (unsigned k = 0; k < kWidth; ++k) to[i][static_cast<int>(k)] = values->values[i * kWidth + k];
    return {};
  }

  Result<void> extrusion(const SceneNode& node, SceneShape shape) {
    SceneSweep sweep;
    sweep.cross_section = {{1, 1}, {1, -1}, {-1, -1}, {-1, 1}, {1, 1}};
    sweep.spine = {{0, 0, 0}, {0, 1, 0}};
    VKMESH_CHECK(rows(node, "crossSection", sweep.cross_section));
    VKMESH_CHECK(rows(node, "spine", sweep.spine));
    VKMESH_CHECK(rows(node, "scale", sweep.scales));
    VKMESH_CHECK(rows(node, "orientation", sweep.orientations));
    sweep.begin_cap = is_true(node, "beginCap");
    sweep.end_cap = is_true(node, "endCap");
    VKMESH_CHECK(mesh_.spend(static_cast<std::uint64_t>(sweep.spine.size()) * sweep.cross_section.size()));
    return mesh_.add_primitive(std::move(shape), node, false, [&] { return scene_extrusion(sweep); });
  }

  Result<const SceneFloats*> values(const SceneNode& node, std::string_view field, int kind,
                                    std::string_view name, unsigned width) {
    const SceneNode* held = child(node, field, kind);
    if (held == nullptr) return nullptr;
    return numbers_.floats(held->field(name), width);
  }

  /// Binds the values of an attribute as its index and the field that says whether it is of vertices do.
  Result<void> bind(const SceneNode& node, std::string_view index, std::string_view per_vertex,
                    SceneAttribute& attribute) {
    VKMESH_TRY(attribute.index, numbers_.indices(node.field(index)));
    attribute.binding =
        node.word(per_vertex, "TRUE") == "FALSE" ? SceneBinding::kFaceIndexed : SceneBinding::kVertexIndexed;
    return {};
  }

  Result<void> shape(const SceneNode& node, const glm::dmat4& matrix) {
    const SceneNode* geometry = geometry_of(node);
    if (geometry == nullptr) return {};
    VKMESH_CHECK(mesh_.spend(geometry->fields.size()));
    SceneShape shape;
    shape.type = geometry->type;
    shape.matrix = matrix;
    shape.clockwise = geometry->word("ccw", "TRUE") == "FALSE";
    shape.uv.components = 2;
    if (const SceneNode* coord = child(*geometry, "coord", kCoordinate); coord != nullptr) {
      VKMESH_TRY(shape.points, numbers_.doubles(coord->field("point"), 3));
    }
    VKMESH_TRY(shape.color.values, values(*geometry, "color", kColor, "color", 3));
    if (shape.color.values == nullptr) {
      const SceneNode* appearance = child(node, "appearance", kAppearance);
      if (appearance != nullptr) {
        VKMESH_TRY(shape.color.values, values(*appearance, "material", kMaterial, "diffuseColor", 3));
        shape.color.binding = SceneBinding::kOverall;
      }
    } else {
      VKMESH_CHECK(bind(*geometry, "colorIndex", "colorPerVertex", shape.color));
    }
    if (geometry->kind == kPointSet) return mesh_.add_points(shape, -1, 0);
    if (geometry->kind != kIndexedFaceSet && geometry->kind != kElevationGrid)
      return primitive(*geometry, std::move(shape));
    VKMESH_TRY(shape.normal.values, values(*geometry, "normal", kNormal, "vector", 3));
    VKMESH_CHECK(bind(*geometry, "normalIndex", "normalPerVertex", shape.normal));
    VKMESH_TRY(shape.uv.values, values(*geometry, "texCoord", kTextureCoordinate, "point", 2));
    VKMESH_CHECK(bind(*geometry, "texCoordIndex", "", shape.uv));
    if (geometry->kind == kElevationGrid) return elevation_grid(*geometry, std::move(shape));
    VKMESH_TRY(const SceneIndices* index, numbers_.indices(geometry->field("coordIndex")));
    return mesh_.add_indexed_faces(shape, index);
  }

  const Source& source_;
  MeshFile file_;
  IgnoredNodes ignored_;
  SceneGraph graph_;
  SceneNumbers numbers_;
  SceneMesh mesh_;
};

}  // namespace

Result<MeshFile> parse_vrml2(const Source& source) {
  return Vrml2Reader(source).read();
}

}  // namespace vkmesh::detail
