// Drawing meshes and point clouds with the graphics pipeline.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/draw/render_target.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/mesh/polygon_soup.h>
#include <vkmesh/view/camera.h>
#include <vkmesh/view/color_map.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

enum class DrawMode {
  kShaded,      ///< Triangles, light by the points' normals where there are some.
  kFlat,        ///< Triangles, light by their planes.
  kWireframe,   ///< The polygons' edges alone; one sees through.
  kShadedWire,  ///< Shaded, with the polygons' edges on the surface.
  kPoints,      ///< A round dot for each point.
  kSplats,      ///< A disc for each point, as large as the spacing of the points, across its normal.
};

enum class DrawColors {
  kPlain,   ///< DrawStyle::plain.
  kNormal,  ///< Components of the unit normal, -1..1, as red, green and blue.
  kValue,   ///< Values through a colour table.
  kDirect,  ///< Values are colours.
};

/// Elements that values belong to.
enum class DrawElement { kPoint, kCorner, kFace };

struct DrawStyle {
  DrawMode mode = DrawMode::kShaded;
  DrawColors colors = DrawColors::kPlain;
  ColorMap map = ColorMap::kSequential;
  ValueRange range{};          ///< Values at its ends get the first and last colour of the map.
  Color plain{204, 205, 210};  ///< The surface without other colours.
  Color background{255, 255, 255};
  Color none{150, 150, 150};  ///< Elements whose value is kNoValue.
  bool show_flipped = false;  ///< Paints back faces in `flipped`.
  Color flipped{230, 0, 160};
  Color edge{40, 44, 52};    ///< Colour of the polygons' edges.
  float edge_width = 1.0f;   ///< Pixels.
  float point_size = 3.0f;   ///< Pixels across a dot.
  float splat_scale = 0.8f;  ///< Radius of a splat as a multiple of the spacing around its point.
};

/// The value of an element that has none.
inline constexpr float kNoValue = -3.4e38f;

/// Edges drawn over a mesh, as pairs of points.
struct DrawEdges {
  const Buffer* ends = nullptr;  ///< 2 points an edge.
  std::uint32_t count = 0;
  Color color{};
  float width = 3.0f;  ///< Pixels.
};

/// Geometry in device memory, to be drawn. Buffers are borrowed; null where there is none.
struct DrawGeometry {
  const Buffer* positions = nullptr;     ///< 3 floats a point.
  const Buffer* corners = nullptr;       ///< 3 points a triangle. Null: each three positions are a triangle.
  const Buffer* normals = nullptr;       ///< 3 floats a point, unit or zero vectors.
  const Buffer* values = nullptr;        ///< For each element a float (kValue) or four bytes RGBA (kDirect).
  const Buffer* hidden_edges = nullptr;  ///< For each triangle: bit i is set where the edge from its corner i
                                         ///< to the next is none of the polygon.
  const Buffer* spacing = nullptr;       ///< A float a point: the radius of its splat, before splat_scale.
  DrawElement element = DrawElement::kPoint;  ///< Elements that `values` belong to.
  std::uint32_t points = 0;
  std::uint32_t triangles = 0;
  std::vector<DrawEdges> edges;  ///< Drawn over it, in this order.
};

/// Triangles of a mesh that is on the device already. Normals and values of passes are added by the
/// caller: `geometry.normals = &result.normals.buffer()`. Errors: kOutOfMemory, kNoDevice.
[[nodiscard]] VKMESH_API Result<DrawGeometry> geometry_of(DeviceMesh& mesh);

/// Records a picture of the geometry: clears the target to the background, draws, and copies the picture to
/// where RenderTarget::download() finds it. All of it must live until the work has run. Face sets are drawn
/// through vertex and index buffers, each point once, where light and colours are the points' own; else, as
/// soups are, triangle by triangle. Errors: kUsage for a camera without direction or depth range, values that
/// are not there, or splats without spacing; kUnsuitable for more elements than a draw call counts; kNoDevice
/// where the queue does not draw; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<void> record_draw(Recorder& recorder, const DrawGeometry& geometry,
                                                  const Camera& camera, const DrawStyle& style,
                                                  RenderTarget& target);

/// Data that a DrawMesh holds beside the triangles. Spans may be empty.
struct DrawMeshData {
  std::span<const Vec3> normals{};  ///< A point each.
  std::span<const float> values{};  ///< An element each. Values that are not finite become kNoValue.
  std::span<const Color> colors{};  ///< An element each, instead of values.
  DrawElement element = DrawElement::kPoint;
  std::span<const std::uint32_t> source_face{};  ///< Triangulated::source_face; for edges of polygons.
  std::span<const float> spacing{};              ///< A point each.
  struct Edges {
    std::span<const std::uint32_t> ends{};  ///< 2 points an edge.
    Color color{};
    float width = 3.0f;
  };
  std::vector<Edges> edges{};
};

/// Mesh of any kind, uploaded for drawing: it need not be manifold, nor have faces. Movable, not copyable.
class VKMESH_API DrawMesh {
 public:
  /// Uploads triangles. Errors: kUnsuitable for a position that is not finite (the first is named) or
  /// polygons that are no triangles; kUsage for corners that name no point, or data of another size;
  /// kOutOfMemory; kNoDevice. O(n).
  [[nodiscard]] static Result<DrawMesh> create(Context& context, const IndexedFaceSet& triangles,
                                               const DrawMeshData& data = {});
  /// Uploads the triangles of a soup, one point for each corner.
  [[nodiscard]] static Result<DrawMesh> create(Context& context, const PolygonSoup& soup,
                                               const DrawMeshData& data = {});

  /// Geometry that is valid while this object is neither moved nor destroyed.
  [[nodiscard]] DrawGeometry geometry() const;

 private:
  [[nodiscard]] static Result<DrawMesh> create(Context& context, std::span<const Vec3> points,
                                               std::span<const std::uint32_t> corners,
                                               const DrawMeshData& data);

  struct Edges {
    Buffer ends;
    std::uint32_t count = 0;
    Color color;
    float width = 1.0f;
  };
  std::uint32_t points_ = 0, triangles_ = 0;
  DrawElement element_ = DrawElement::kPoint;
  Buffer positions_, corners_, normals_, values_, hidden_edges_, spacing_;
  std::vector<Edges> edges_;
};

}  // namespace vkmesh
