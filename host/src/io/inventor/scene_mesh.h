// Shapes of a scene, gathered into one indexed face set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <vkmesh/base/result.h>
#include <vkmesh/mesh/indexed_face_set.h>

#include "io/formats.h"
#include "io/inventor/scene_graph.h"
#include "io/inventor/scene_primitives.h"

namespace vkmesh::detail {

/// What the i-th value of an attribute belongs to. The indexed ones go through a list of their own or, where
/// there is none, through that of the points (vertices) or none (faces, parts).
enum class SceneBinding { kOverall, kPart, kPartIndexed, kFace, kFaceIndexed, kVertex, kVertexIndexed };

/// The normals, texture coordinates or colours of one shape.
struct SceneAttribute {
  const SceneFloats* values = nullptr;  ///< nullptr: none.
  unsigned components = 3;
  SceneBinding binding = SceneBinding::kVertexIndexed;
  const SceneIndices* index = nullptr;
  bool bytes = false;  ///< The file gave them in 8 bits.
};

/// The polygons of one shape. A part is what a -1 (or a count) ends: a face, a strip, a row of a mesh.
struct ScenePolygons {
  std::vector<std::uint32_t> points;    ///< The point of each corner.
  std::vector<std::uint32_t> ordinals;  ///< Each corner's number in the shape's list, ends not counted.
  std::vector<std::uint32_t> sizes;     ///< The corners of each face.
  std::vector<std::uint32_t> parts;     ///< The part that each face is of.
  std::vector<std::uint32_t> numbers;   ///< Each face's number, those left out counted.

  void corner(std::uint64_t point, std::uint64_t ordinal) {
    points.push_back(static_cast<std::uint32_t>(point));
    ordinals.push_back(static_cast<std::uint32_t>(ordinal));
  }
  void end_face(std::size_t size, std::size_t part, std::size_t number) {
    sizes.push_back(static_cast<std::uint32_t>(size));
    parts.push_back(static_cast<std::uint32_t>(part));
    numbers.push_back(static_cast<std::uint32_t>(number));
  }
};

/// What shapes have in common whichever node they come from.
struct SceneShape {
  std::string_view type;  ///< The node's type, which stands where errors point.
  const SceneDoubles* points = nullptr;
  unsigned width = 3;  ///< 4: homogeneous.
  glm::dmat4 matrix{1.0};
  bool clockwise = false;
  SceneAttribute normal, uv, color;
};

class SceneMesh {
 public:
  SceneMesh(const Source& source, SceneNumbers& numbers) : source_(source), numbers_(numbers) {
    budget_ = 64 * static_cast<std::uint64_t>(source.bytes.size()) + (std::uint64_t{1} << 22);
  }

  /// Every step that a USE can repeat pays from a budget that the size of the file sets. Errors: kUnreadable
  /// when it is used up.
  [[nodiscard]] Result<void> spend(std::uint64_t steps);

  /// What stands before every node that is visited: pays for it, reports progress, and refuses what stands in
  /// too many others. False: the node is of no known kind.
  [[nodiscard]] Result<bool> enter(const SceneNode& node, std::size_t depth);
  /// Counts levels of detail, and children of a 'Switch', that are not shown; finish() tells of them.
  void pass_levels(std::size_t count) { levels_ += count; }
  void pass_choices(std::size_t count) { unchosen_ += count; }

  /// Faces that a list of point indices gives, each ended by -1.
  [[nodiscard]] Result<void> add_indexed_faces(const SceneShape& shape, const SceneIndices* index);
  [[nodiscard]] Result<void> add_indexed_strips(const SceneShape& shape, const SceneIndices* index);
  /// Faces or strips of consecutive points, `counts` of them in each; -1, or no list, takes all that are
  /// left.
  [[nodiscard]] Result<void> add_faces(const SceneShape& shape, const SceneIndices* counts,
                                       std::int64_t start);
  [[nodiscard]] Result<void> add_strips(const SceneShape& shape, const SceneIndices* counts,
                                        std::int64_t start);
  /// Quads between rows of points.
  [[nodiscard]] Result<void> add_quads(const SceneShape& shape, std::int64_t per_row, std::int64_t per_column,
                                       std::int64_t start);
  /// Points alone; count -1 takes all that are left.
  [[nodiscard]] Result<void> add_points(const SceneShape& shape, std::int64_t count, std::int64_t start);

  /// A shape that is given by its measures; made once for each node. `round`: polygons only come near it.
  [[nodiscard]] Result<void> add_primitive(SceneShape shape, const SceneNode& node, bool round,
                                           const std::function<ScenePrimitive()>& make);
  /// What the file `name` beside this one holds, which a node names, read once for each node. Whether there
  /// is one: the reason why not goes to the notes.
  [[nodiscard]] Result<bool> add_inline(const SceneNode& node, const std::string& name,
                                        const glm::dmat4& matrix, Notes& notes);

  /// The mesh, with its notes. Errors: kUnreadable where there is none; the message says what was ignored.
  [[nodiscard]] Result<IndexedFaceSet> finish(const IgnoredNodes& ignored, Notes& notes);

 private:
  enum class Form { kNone, kOverall, kFace, kCorner, kPoint };
  /// An attribute of a shape, settled: which row each of its faces or corners has. The corners of kPoint have
  /// the row of their point.
  struct Kept {
    Form form = Form::kNone;
    const std::vector<float>* values = nullptr;
    unsigned components = 3;
    bool bytes = false;
    std::vector<std::uint32_t> rows;
  };
  struct Shape {
    std::size_t first_point = 0, points = 0;  ///< Its block of points; of a point set, those it shows.
    std::size_t corners = 0, faces = 0;
    glm::dmat3 normal_matrix{1.0};
    bool moved = false;
    std::array<Kept, 3> kept;
  };
  enum { kNormal, kUv, kColor };

  [[nodiscard]] Result<std::size_t> add_block(const SceneShape& shape);
  [[nodiscard]] Result<void> add(const SceneShape& shape, ScenePolygons polygons);
  [[nodiscard]] Result<Kept> settle(const SceneAttribute& attribute, std::size_t which,
                                    const ScenePolygons& polygons);
  /// The points that each count takes, as (first, count).
  [[nodiscard]] Result<std::vector<std::pair<std::size_t, std::size_t>>> runs(const SceneShape& shape,
                                                                              const SceneIndices* counts,
                                                                              std::int64_t start);
  [[nodiscard]] bool fits_points(std::size_t which) const;
  void keep(std::size_t which, Notes& notes);
  /// Writes the row of a shape's attribute to `to`, of `components` floats.
  void put_row(const Shape& shape, std::size_t which, std::size_t row, unsigned components, float* to) const;

  const Source& source_;
  SceneNumbers& numbers_;
  std::uint64_t budget_ = 0;
  IndexedFaceSet mesh_;
  FaceCollector collector_{mesh_};
  std::vector<Shape> shapes_;
  /// Where the points of an array under a transform begin.
  std::map<std::pair<const SceneDoubles*, std::array<double, 16>>, std::size_t> blocks_;
  std::array<std::size_t, 3> dropped_{};  ///< Shapes whose attribute has too few values.
  std::size_t small_faces_ = 0;
  std::size_t visits_ = 0, levels_ = 0, unchosen_ = 0;
  bool any_shape_ = false;

  /// Arrays of shapes whose numbers are not in this file.
  struct Made {
    SceneDoubles points;
    SceneIndices index;
    SceneAttribute normal, uv, color;
    bool any = false;
  };
  std::map<const SceneNode*, Made> made_;
  std::deque<SceneFloats> made_floats_;
  std::deque<SceneIndices> made_indices_;
  std::size_t round_shapes_ = 0;

  [[nodiscard]] Result<bool> read_inline(const SceneNode& node, const std::string& name, Made& to,
                                         Notes& notes);
};

}  // namespace vkmesh::detail
