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
                                {"Coordinate", kCoordinate},
                                {"Normal", kNormal},
                                {"Color", kColor},
                                {"TextureCoordinate", kTextureCoordinate}};

constexpr std::string_view kFields[] = {
    "children",        "choice",      "whichChoice",    "level",  "appearance",
    "geometry",        "material",    "diffuseColor",   "coord",  "coordIndex",
    "color",           "colorIndex",  "colorPerVertex", "normal", "normalIndex",
    "normalPerVertex", "texCoord",    "texCoordIndex",  "ccw",    "point",
    "vector",          "translation", "rotation",       "scale",  "scaleOrientation",
    "center"};

class Vrml2Reader {
 public:
  explicit Vrml2Reader(const Source& source) : source_(source), numbers_(source), mesh_(source, numbers_) {
    file_.format = FileFormat::kVrml2;
  }

  Result<MeshFile> read() {
    VKMESH_TRY(graph_, parse_scene(source_, kNodes, kFields, ignored_, file_.notes));
    VKMESH_CHECK(visit_all(graph_.roots, glm::dmat4(1.0), 0));
    VKMESH_TRY(file_.geometry, mesh_.finish(file_.notes));
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
    const SceneNode* geometry = child(node, "geometry", kIndexedFaceSet, kPointSet);
    if (geometry == nullptr) return {};
    VKMESH_CHECK(mesh_.spend(geometry->fields.size()));
    SceneShape shape;
    shape.type = geometry->type;
    shape.matrix = matrix;
    shape.clockwise = geometry->word("ccw", "TRUE") == "FALSE";
    shape.uv.components = 2;
    VKMESH_TRY(shape.points, values(*geometry, "coord", kCoordinate, "point", 3));
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
    VKMESH_TRY(shape.normal.values, values(*geometry, "normal", kNormal, "vector", 3));
    VKMESH_CHECK(bind(*geometry, "normalIndex", "normalPerVertex", shape.normal));
    VKMESH_TRY(shape.uv.values, values(*geometry, "texCoord", kTextureCoordinate, "point", 2));
    VKMESH_CHECK(bind(*geometry, "texCoordIndex", "", shape.uv));
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
