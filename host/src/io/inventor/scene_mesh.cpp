#include "io/inventor/scene_mesh.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <variant>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace vkmesh::detail {
namespace {

constexpr const char* kAttributeNames[] = {"normal", "uv", "color"};
constexpr const char* kPlurals[] = {"normals", "texture coordinates", "colours"};

/// The matrix whose columns are the cross products of the others': the transposed inverse but for its scale,
/// and defined for every matrix. Its sign follows the determinant, so that normals of a mirrored surface keep
/// their side.
glm::dmat3 normal_matrix_of(const glm::dmat4& matrix) {
  const glm::dmat3 m(matrix);
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

bool is_identity(const glm::dmat4& matrix) {
  return matrix == glm::dmat4(1.0);
}

}  // namespace

Result<void> SceneMesh::spend(std::uint64_t steps) {
  if (steps > budget_)
    return fail(ErrorCode::kUnreadable,
                "the nodes that are used again and again make a scene out of proportion to the file",
                {source_.name, {}, {}});
  budget_ -= steps;
  return {};
}

Result<bool> SceneMesh::enter(const SceneNode& node, std::size_t depth) {
  VKMESH_CHECK(spend(1));
  if (node.kind == 0) return false;
  VKMESH_CHECK(spend(node.fields.size()));
  if (Source::due(visits_++)) VKMESH_CHECK(numbers_.tick(node.type.data()));
  if (depth > kMaxSceneDepth)
    return source_.bad_line(node.type.data(),
                            "nodes stand in more than " + std::to_string(kMaxSceneDepth) + " others");
  return true;
}

/// Appends the points of the shape, unless an earlier one had the same under the same transform. Returns the
/// number of the first.
Result<std::size_t> SceneMesh::add_block(const SceneShape& shape) {
  std::array<double, 16> key{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      key[static_cast<std::size_t>(4 * column + row)] = shape.matrix[column][row];
  const auto [found, is_new] = blocks_.try_emplace({shape.points, key}, mesh_.points.size());
  if (!is_new) return found->second;

  const std::vector<double>& values = shape.points->values;
  const std::size_t count = values.size() / shape.width;
  VKMESH_CHECK(spend(count));
  if (mesh_.points.size() + count > kMaxElements)
    return source_.bad_line(shape.type.data(), "there are more points than 32-bit indices can number");
  const bool moved = !is_identity(shape.matrix);
  for (std::size_t i = 0; i < count; ++i) {
    const double* row = values.data() + i * shape.width;
    DVec3 exact{row[0], row[1], row[2]};
    if (moved || shape.width == 4) {
      glm::dvec4 p{exact, shape.width == 4 ? row[3] : 1.0};
      if (moved) p = shape.matrix * p;
      exact = DVec3(p) / p.w;
    }
    const Vec3 point = source_.positions->place(exact);
    if (!all_finite(point))
      return numbers_.bad_number(*shape.points, i * shape.width,
                                 "point " + std::to_string(i) + " has a coordinate that is not finite");
    mesh_.points.push_back(point);
  }
  return found->second;
}

/// Settles which row each face or corner has. Lists of their own must be right; values that are too few
/// without one are left out and counted, for state is inherited by shapes it was not meant for.
Result<SceneMesh::Kept> SceneMesh::settle(const SceneAttribute& attribute, std::size_t which,
                                          const ScenePolygons& polygons) {
  Kept kept;
  if (attribute.values == nullptr || attribute.values->values.empty()) return kept;
  kept.values = &attribute.values->values;
  kept.components = attribute.components;
  kept.bytes = attribute.bytes;
  const std::size_t count = kept.values->size() / attribute.components;
  const SceneBinding binding = attribute.binding;
  const bool indexed = binding == SceneBinding::kPartIndexed || binding == SceneBinding::kFaceIndexed ||
                       binding == SceneBinding::kVertexIndexed;
  const SceneIndices* index = indexed ? attribute.index : nullptr;

  bool too_few = false;
  const auto row_at = [&](std::size_t place) -> Result<std::uint32_t> {
    if (index == nullptr) {
      too_few = too_few || place >= count;
      return static_cast<std::uint32_t>(place);
    }
    const std::size_t given = index->values.size();
    if (place >= given)
      return source_.bad_line(index->text.data(), "the list of " + std::string(kPlurals[which]) + " has " +
                                                      std::to_string(given) +
                                                      " indices, too few for the shape");
    const std::int32_t row = index->values[place];
    if (row < 0 || static_cast<std::size_t>(row) >= count)
      return numbers_.bad_number(*index, place,
                                 "index " + std::to_string(row) + ", but there are " + std::to_string(count) +
                                     " " + kPlurals[which]);
    return static_cast<std::uint32_t>(row);
  };

  if (binding == SceneBinding::kOverall) {
    kept.form = Form::kOverall;
    return kept;
  }
  const bool of_vertices = binding == SceneBinding::kVertex || binding == SceneBinding::kVertexIndexed;
  if (of_vertices) {
    kept.form = Form::kPoint;
    kept.rows.reserve(polygons.points.size());
    std::size_t corner = 0;
    for (std::size_t f = 0; f < polygons.sizes.size(); ++f)
      for (std::size_t k = 0; k < polygons.sizes[f]; ++k, ++corner) {
        const std::size_t point = polygons.points[corner], ordinal = polygons.ordinals[corner];
        // A list of its own holds the ends of the parts before this one, too.
        VKMESH_TRY(const std::uint32_t row, row_at(index != nullptr ? ordinal + polygons.parts[f]
                                                   : indexed        ? point
                                                                    : ordinal));
        if (row != point) kept.form = Form::kCorner;
        kept.rows.push_back(row);
      }
    if (kept.form == Form::kPoint) kept.rows = {};
  } else {
    kept.form = Form::kFace;
    const bool of_parts = binding == SceneBinding::kPart || binding == SceneBinding::kPartIndexed;
    kept.rows.reserve(polygons.sizes.size());
    for (std::size_t f = 0; f < polygons.sizes.size(); ++f) {
      VKMESH_TRY(const std::uint32_t row, row_at(of_parts ? polygons.parts[f] : polygons.numbers[f]));
      kept.rows.push_back(row);
    }
  }
  if (too_few) {
    ++dropped_[which];
    return Kept{};
  }
  return kept;
}

Result<void> SceneMesh::add(const SceneShape& shape, ScenePolygons polygons) {
  any_shape_ = true;
  // A shape without faces leaves nothing; one with them costs a record, too.
  VKMESH_CHECK(spend(polygons.points.size() + 32));
  if (polygons.sizes.empty()) return {};
  if (shape.clockwise != (glm::determinant(glm::dmat3(shape.matrix)) < 0)) {
    std::size_t corner = 0;
    for (const std::uint32_t size : polygons.sizes) {
      const auto from = static_cast<std::ptrdiff_t>(corner + 1),
                 to = static_cast<std::ptrdiff_t>(corner + size);
      std::reverse(polygons.points.begin() + from, polygons.points.begin() + to);
      std::reverse(polygons.ordinals.begin() + from, polygons.ordinals.begin() + to);
      corner += size;
    }
  }
  Shape added;
  VKMESH_TRY(added.kept[kNormal], settle(shape.normal, kNormal, polygons));
  VKMESH_TRY(added.kept[kUv], settle(shape.uv, kUv, polygons));
  VKMESH_TRY(added.kept[kColor], settle(shape.color, kColor, polygons));
  VKMESH_TRY(added.first_point, add_block(shape));
  added.points = shape.points->values.size() / shape.width;
  added.corners = polygons.points.size();
  added.faces = polygons.sizes.size();
  added.moved = !is_identity(shape.matrix);
  added.normal_matrix = normal_matrix_of(shape.matrix);
  std::size_t corner = 0;
  for (const std::uint32_t size : polygons.sizes) {
    for (std::uint32_t k = 0; k < size; ++k)
      collector_.corner(static_cast<std::uint32_t>(added.first_point + polygons.points[corner++]));
    if (collector_.end_face(size) == FaceCollector::Face::kTooMany)
      return source_.bad_line(shape.type.data(),
                              "the faces have more corners than 32-bit indices can number");
  }
  shapes_.push_back(std::move(added));
  return {};
}

Result<void> SceneMesh::add_indexed_faces(const SceneShape& shape, const SceneIndices* index) {
  ScenePolygons polygons;
  if (index == nullptr) return add(shape, std::move(polygons));
  VKMESH_CHECK(spend(index->values.size()));
  const std::size_t count = shape.points == nullptr ? 0 : shape.points->values.size() / shape.width;
  polygons.points.reserve(index->values.size());
  polygons.ordinals.reserve(index->values.size());
  std::size_t in_face = 0, part = 0, ordinal = 0;
  for (std::size_t i = 0; i <= index->values.size(); ++i) {
    const std::int32_t point = i < index->values.size() ? index->values[i] : -1;
    if (point != -1) {
      if (point < 0 || static_cast<std::size_t>(point) >= count)
        return numbers_.bad_number(*index, i,
                                   "a face names point " + std::to_string(point) + ", but there are " +
                                       std::to_string(count) + ", counted from 0");
      polygons.corner(static_cast<std::uint64_t>(point), ordinal++);
      ++in_face;
      continue;
    }
    if (in_face >= 3) {
      polygons.end_face(in_face, part, part);
    } else {
      small_faces_ += in_face > 0;
      polygons.points.resize(polygons.points.size() - in_face);
      polygons.ordinals.resize(polygons.points.size());
    }
    in_face = 0;
    ++part;
  }
  return add(shape, std::move(polygons));
}

namespace {

/// The triangle that ends with corner k of a strip; every second one is turned so that all face one way.
std::array<std::size_t, 3> strip_triangle(std::size_t k) {
  if (k % 2 == 0) return {k - 2, k - 1, k};
  return {k - 1, k - 2, k};
}

}  // namespace

Result<void> SceneMesh::add_indexed_strips(const SceneShape& shape, const SceneIndices* index) {
  ScenePolygons polygons;
  if (index == nullptr) return add(shape, std::move(polygons));
  VKMESH_CHECK(spend(index->values.size()));
  const std::size_t count = shape.points == nullptr ? 0 : shape.points->values.size() / shape.width;
  std::size_t first = 0, part = 0, number = 0;
  for (std::size_t i = 0; i <= index->values.size(); ++i) {
    const std::int32_t point = i < index->values.size() ? index->values[i] : -1;
    if (point != -1) {
      if (point < 0 || static_cast<std::size_t>(point) >= count)
        return numbers_.bad_number(*index, i,
                                   "a strip names point " + std::to_string(point) + ", but there are " +
                                       std::to_string(count) + ", counted from 0");
      if (i - first >= 2) {
        for (const std::size_t k : strip_triangle(i - first))
          polygons.corner(static_cast<std::uint64_t>(index->values[first + k]), first + k - part);
        polygons.end_face(3, part, number++);
      }
      continue;
    }
    small_faces_ += i > first && i - first < 3;
    first = i + 1;
    ++part;
  }
  return add(shape, std::move(polygons));
}

Result<std::vector<std::pair<std::size_t, std::size_t>>> SceneMesh::runs(const SceneShape& shape,
                                                                         const SceneIndices* counts,
                                                                         std::int64_t start) {
  const std::size_t points = shape.points == nullptr ? 0 : shape.points->values.size() / shape.width;
  if (start < 0 || static_cast<std::uint64_t>(start) > points)
    return source_.bad_line(shape.type.data(), "the shape starts at point " + std::to_string(start) + " of " +
                                                   std::to_string(points));
  auto first = static_cast<std::size_t>(start);
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  if (counts == nullptr) {
    runs.emplace_back(first, points - first);
    VKMESH_CHECK(spend(points - first));
    return runs;
  }
  VKMESH_CHECK(spend(counts->values.size()));
  for (std::size_t i = 0; i < counts->values.size(); ++i) {
    const std::int32_t given = counts->values[i];
    const std::size_t count = given == -1 ? points - first : static_cast<std::size_t>(given);
    if (given < -1 || count > points - first)
      return numbers_.bad_number(*counts, i,
                                 std::to_string(given) + " points are asked for, but " +
                                     std::to_string(points - first) + " are left");
    runs.emplace_back(first, count);
    VKMESH_CHECK(spend(count));
    first += count;
  }
  return runs;
}

Result<void> SceneMesh::add_faces(const SceneShape& shape, const SceneIndices* counts, std::int64_t start) {
  VKMESH_TRY(const auto parts, runs(shape, counts, start));
  ScenePolygons polygons;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const auto [first, count] = parts[part];
    small_faces_ += count > 0 && count < 3;
    if (count < 3) continue;
    for (std::size_t k = 0; k < count; ++k)
      polygons.corner(first + k, first + k - static_cast<std::size_t>(start));
    polygons.end_face(count, part, part);
  }
  return add(shape, std::move(polygons));
}

Result<void> SceneMesh::add_strips(const SceneShape& shape, const SceneIndices* counts, std::int64_t start) {
  VKMESH_TRY(const auto parts, runs(shape, counts, start));
  ScenePolygons polygons;
  std::size_t number = 0;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const auto [first, count] = parts[part];
    small_faces_ += count > 0 && count < 3;
    for (std::size_t last = 2; last < count; ++last) {
      for (const std::size_t k : strip_triangle(last))
        polygons.corner(first + k, first + k - static_cast<std::size_t>(start));
      polygons.end_face(3, part, number++);
    }
  }
  return add(shape, std::move(polygons));
}

Result<void> SceneMesh::add_quads(const SceneShape& shape, std::int64_t per_row, std::int64_t per_column,
                                  std::int64_t start) {
  const std::size_t points = shape.points == nullptr ? 0 : shape.points->values.size() / shape.width;
  if (per_row < 1 || per_column < 1 || start < 0 || static_cast<std::uint64_t>(start) > points ||
      static_cast<std::uint64_t>(per_column) >
          (points - static_cast<std::uint64_t>(start)) / static_cast<std::uint64_t>(per_row))
    return source_.bad_line(shape.type.data(), std::to_string(per_row) + " × " + std::to_string(per_column) +
                                                   " points from " + std::to_string(start) +
                                                   " are asked for, but there are " + std::to_string(points));
  const auto width = static_cast<std::size_t>(per_row), height = static_cast<std::size_t>(per_column);
  VKMESH_CHECK(spend(width * height));
  ScenePolygons polygons;
  for (std::size_t y = 0; y + 1 < height; ++y)
    for (std::size_t x = 0; x + 1 < width; ++x) {
      const std::size_t at = y * width + x;
      for (const std::size_t k : {at, at + width, at + width + 1, at + 1})
        polygons.corner(static_cast<std::size_t>(start) + k, k);
      polygons.end_face(4, y, y * (width - 1) + x);
    }
  return add(shape, std::move(polygons));
}

Result<void> SceneMesh::add_points(const SceneShape& shape, std::int64_t count, std::int64_t start) {
  any_shape_ = true;
  VKMESH_CHECK(spend(32));
  if (shape.points == nullptr) return {};
  const std::size_t points = shape.points->values.size() / shape.width;
  if (start < 0 || static_cast<std::uint64_t>(start) > points || count < -1 ||
      (count >= 0 && static_cast<std::uint64_t>(count) > points - static_cast<std::uint64_t>(start)))
    return source_.bad_line(shape.type.data(), std::to_string(count) + " points from " +
                                                   std::to_string(start) + " are asked for, but there are " +
                                                   std::to_string(points));
  Shape added;
  added.points = count < 0 ? points - static_cast<std::size_t>(start) : static_cast<std::size_t>(count);
  added.moved = !is_identity(shape.matrix);
  added.normal_matrix = normal_matrix_of(shape.matrix);
  const SceneAttribute* given[] = {&shape.normal, &shape.uv, &shape.color};
  for (std::size_t which = 0; which < 3; ++which) {
    const SceneAttribute& attribute = *given[which];
    if (attribute.values == nullptr || attribute.values->values.empty()) continue;
    const bool of_vertices =
        attribute.binding == SceneBinding::kVertex || attribute.binding == SceneBinding::kVertexIndexed;
    if (of_vertices && attribute.values->values.size() / attribute.components < added.points) {
      ++dropped_[which];
      continue;
    }
    added.kept[which] = {of_vertices ? Form::kPoint : Form::kOverall,
                         &attribute.values->values,
                         attribute.components,
                         attribute.bytes,
                         {}};
  }
  VKMESH_CHECK(spend(added.points));
  VKMESH_TRY(added.first_point, add_block(shape));
  added.first_point += static_cast<std::size_t>(start);
  shapes_.push_back(std::move(added));
  return {};
}

Result<void> SceneMesh::add_primitive(SceneShape shape, const SceneNode& node, bool round,
                                      const std::function<ScenePrimitive()>& make) {
  const auto [found, is_new] = made_.try_emplace(&node);
  Made& made = found->second;
  if (is_new) {
    ScenePrimitive primitive = make();
    made.points = {std::move(primitive.points), node.type, SceneForm::kText};
    made.index = {std::move(primitive.index), node.type, SceneForm::kText};
    // The measures of a shape are few bytes: its first use is free.
    budget_ += 4 * (made.points.values.size() + made.index.values.size());
    round_shapes_ += round;
  }
  shape.points = &made.points;
  return add_indexed_faces(shape, &made.index);
}

Result<bool> SceneMesh::add_inline(const SceneNode& node, const std::string& name, const glm::dmat4& matrix,
                                   Notes& notes) {
  const auto [found, is_new] = made_.try_emplace(&node);
  Made& made = found->second;
  if (is_new) {
    VKMESH_TRY(made.any, read_inline(node, name, made, notes));
    budget_ += 4 * (made.points.values.size() + made.index.values.size());
  }
  if (!made.any) return false;
  SceneShape shape;
  shape.type = node.type;
  shape.matrix = matrix;
  shape.points = &made.points;
  shape.normal = made.normal;
  shape.uv = made.uv;
  shape.color = made.color;
  if (made.index.values.empty())
    VKMESH_CHECK(add_points(shape, -1, 0));
  else
    VKMESH_CHECK(add_indexed_faces(shape, &made.index));
  return true;
}

Result<bool> SceneMesh::read_inline(const SceneNode& node, const std::string& name, Made& to, Notes& notes) {
  const auto dropped = [&](const std::string& reason) {
    notes.push_back({"dropped.inline", "the inlined file '" + name.substr(0, 200) + "' ignored: " + reason});
    return false;
  };
  const std::filesystem::path relative = name;
  if (name.empty() || name.find("://") != std::string::npos || relative.is_absolute())
    return dropped("only files beside this one are read");
  if (relative.lexically_normal().string().starts_with(".."))
    return dropped("it lies outside the folder of this one");
  if (source_.folder == nullptr) return dropped("this one was not read from a folder");
  const std::filesystem::path path = *source_.folder / relative;
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) return dropped("there is no such file");
  constexpr int kDeepestInline = 8, kMostInlines = 1000;
  int depth = 0;
  for (const Source* outer = &source_; outer != nullptr; outer = outer->outer, ++depth)
    if (std::filesystem::equivalent(path, outer->name, code) || depth == kDeepestInline)
      return dropped("files that inline each other");
  int own_count = 0;
  int& count = source_.inlines != nullptr ? *source_.inlines : own_count;
  if (++count > kMostInlines)
    return dropped("there are more than " + std::to_string(kMostInlines) + " of them");

  VKMESH_TRY(const Content content, read_content(path, {}));
  const Progress silent;
  Positions positions;
  const std::filesystem::path folder = path.parent_path();
  Source inner{content.bytes.view(), path.string(), silent, 0, &folder};
  inner.positions = &positions;
  inner.outer = &source_;
  inner.inlines = &count;
  VKMESH_TRY(MeshFile file, parse_format(inner));
  positions.add_notes(file.notes);
  for (FileNote& note : file.notes) notes.push_back({note.code, name + ": " + note.sentence});
  VKMESH_TRY(IndexedFaceSet mesh, vkmesh::to_indexed_face_set(std::move(file)));

  to.points.text = node.type;
  for (const Vec3& p : mesh.points)
    for (int axis = 0; axis < 3; ++axis) to.points.values.push_back(static_cast<double>(p[axis]));
  // Row i of an attribute of corners is that of corner i: its list of rows counts, beside the ends of faces.
  SceneIndices& in_turn = made_indices_.emplace_back(SceneIndices{{}, node.type, SceneForm::kText});
  to.index.text = node.type;
  for (std::size_t f = 0, corner = 0; f < mesh.face_count(); ++f) {
    for (const std::uint32_t point : mesh.face(f)) {
      to.index.values.push_back(static_cast<std::int32_t>(point));
      in_turn.values.push_back(static_cast<std::int32_t>(corner++));
    }
    to.index.values.push_back(-1);
    in_turn.values.push_back(-1);
  }
  const auto attribute = [&](const char* channel_name, unsigned components) {
    SceneAttribute made;
    const auto take = [&](const std::vector<Channel>& channels, SceneBinding binding,
                          const SceneIndices* index) {
      const Channel* channel = find_channel(channels, channel_name);
      if (channel == nullptr || made.values != nullptr || channel->components < components) return;
      SceneFloats& values = made_floats_.emplace_back(SceneFloats{{}, node.type, SceneForm::kText});
      const bool color = channel->name == "color";
      for (std::size_t i = 0; i < channel->scalar_count(); ++i)
        values.values.push_back(color ? color_fraction(*channel, i) : channel_float(*channel, i));
      made = {&values, channel->components, binding, index,
              color && std::holds_alternative<std::vector<std::uint8_t>>(channel->values)};
    };
    take(mesh.corner_channels, SceneBinding::kVertexIndexed, &in_turn);
    take(mesh.point_channels, SceneBinding::kVertexIndexed, nullptr);
    take(mesh.face_channels, SceneBinding::kFace, nullptr);
    made.components = std::max(made.components, components);
    return made;
  };
  to.normal = attribute("normal", 3);
  to.uv = attribute("uv", 2);
  to.color = attribute("color", 3);
  if (to.uv.values == nullptr) to.uv.components = 2;
  return true;
}

void SceneMesh::put_row(const Shape& shape, std::size_t which, std::size_t row, unsigned components,
                        float* to) const {
  const Kept& kept = shape.kept[which];
  const float* from = kept.values->data() + row * kept.components;
  std::copy_n(from, std::min(components, kept.components), to);
  if (which != kNormal || !shape.moved) return;
  const glm::dvec3 normal = shape.normal_matrix * glm::dvec3(from[0], from[1], from[2]);
  const double length = glm::length(normal);
  // A normal of no length has no direction to keep; neither has one whose surface collapsed.
  for (int axis = 0; axis < 3; ++axis)
    to[axis] = length > 0 && std::isfinite(length) ? static_cast<float>(normal[axis] / length) : 0.0f;
}

/// True when the points can carry the attribute: all corners of a point have the same row, the point's.
bool SceneMesh::fits_points(std::size_t which) const {
  std::map<std::size_t, const std::vector<float>*> of_block;
  for (const Shape& shape : shapes_) {
    if (shape.faces == 0) continue;
    const Kept& kept = shape.kept[which];
    if (kept.form != Form::kPoint || kept.values->size() < shape.points * kept.components) return false;
    if (of_block.try_emplace(shape.first_point, kept.values).first->second != kept.values) return false;
  }
  return true;
}

/// Makes the channel of an attribute: of points where they can carry it, of faces where it is constant on
/// each, else of corners. Shapes without it get 0 for normals and uv, 1 for colours.
void SceneMesh::keep(std::size_t which, Notes& notes) {
  bool any = false, by_face = true, bytes = true;
  unsigned components = which == kUv ? 2 : 3;
  for (const Shape& shape : shapes_) {
    const Kept& kept = shape.kept[which];
    if (kept.form == Form::kNone) continue;
    any = true;
    bytes = bytes && kept.bytes;
    components = std::max(components, kept.components);
    if (shape.faces > 0) by_face = by_face && (kept.form == Form::kOverall || kept.form == Form::kFace);
  }
  if (!any) return;
  const bool by_point = mesh_.corners.empty() || fits_points(which);
  by_face = by_face && !by_point;
  const std::size_t elements = by_point  ? mesh_.points.size()
                               : by_face ? mesh_.face_count()
                                         : mesh_.corners.size();
  std::vector<float> values(elements * components, which == kColor ? 1.0f : 0.0f);
  std::size_t at = 0, face = 0, left_out = 0;
  for (const Shape& shape : shapes_) {
    const Kept& kept = shape.kept[which];
    const auto put = [&](std::size_t element, std::size_t row) {
      put_row(shape, which, row, components, values.data() + element * components);
    };
    if (by_point) {
      for (std::size_t i = 0; kept.form != Form::kNone && i < shape.points; ++i)
        put(shape.first_point + i, kept.form == Form::kPoint ? i : 0);
      continue;
    }
    left_out += shape.faces == 0 && kept.form != Form::kNone;
    const std::size_t corners_from = at;
    for (std::size_t f = 0; f < shape.faces; ++f) {
      const std::size_t size = mesh_.face(face + f).size();
      if (by_face && kept.form != Form::kNone) {
        put(face + f, kept.form == Form::kFace ? kept.rows[f] : 0);
      } else if (kept.form != Form::kNone) {
        for (std::size_t c = at; c < at + size; ++c)
          put(c, kept.form == Form::kFace     ? kept.rows[f]
                 : kept.form == Form::kCorner ? kept.rows[c - corners_from]
                 : kept.form == Form::kPoint  ? mesh_.corners[c] - shape.first_point
                                              : 0);
      }
      at += size;
    }
    face += shape.faces;
  }
  if (left_out > 0)
    notes.push_back({std::string("dropped.") + kAttributeNames[which],
                     std::string(kPlurals[which]) + " of " + std::to_string(left_out) +
                         " point sets ignored: the faces have them in another way"});
  Channel channel{kAttributeNames[which], components, std::move(values)};
  if (which == kColor && bytes) {
    std::vector<std::uint8_t> rounded(channel.scalar_count());
    for (std::size_t i = 0; i < rounded.size(); ++i) rounded[i] = color_byte(channel, i);
    channel.values = std::move(rounded);
  }
  (by_point  ? mesh_.point_channels
   : by_face ? mesh_.face_channels
             : mesh_.corner_channels)
      .push_back(std::move(channel));
}

Result<IndexedFaceSet> SceneMesh::finish(const IgnoredNodes& ignored, Notes& notes) {
  if (!any_shape_) {
    const std::string what = ignored.text();
    return fail(ErrorCode::kUnreadable,
                "the file holds neither polygons nor points" +
                    (what.empty() ? std::string() : " (nodes ignored: " + what + ")"),
                {source_.name, {}, {}});
  }
  if (levels_ > 0)
    notes.push_back({"dropped.levels", std::to_string(levels_) + " levels of detail but the first ignored"});
  if (unchosen_ > 0)
    notes.push_back(
        {"dropped.switch", std::to_string(unchosen_) + " children that a 'Switch' does not choose ignored"});
  for (std::size_t which = 0; which < 3; ++which) keep(which, notes);
  for (std::size_t which = 0; which < 3; ++which)
    if (dropped_[which] > 0)
      notes.push_back({std::string("skipped.") + kAttributeNames[which],
                       std::string(kPlurals[which]) + " of " + std::to_string(dropped_[which]) +
                           " shapes ignored: there are too few for them"});
  note_small_faces(notes, small_faces_);
  if (round_shapes_ > 0)
    notes.push_back({"rounded.primitives",
                     std::to_string(round_shapes_) + " spheres, cones and cylinders read as polygons"});
  return std::move(mesh_);
}

}  // namespace vkmesh::detail
