#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/draw/draw.h>

namespace vkmesh {
namespace {

Result<void> require_finite(std::span<const Vec3> points) {
  const auto bad = std::find_if(points.begin(), points.end(), [](const Vec3& p) {
    return !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z);
  });
  if (bad == points.end()) return {};
  return fail(ErrorCode::kUnsuitable, "point " + std::to_string(bad - points.begin()) +
                                          " has a coordinate that is not finite: it cannot be drawn");
}

Result<void> require_size(std::size_t size, std::size_t elements, const char* what) {
  if (size == 0 || size == elements) return {};
  return fail(ErrorCode::kUsage,
              std::to_string(size) + " " + what + " for " + std::to_string(elements) + " elements");
}

template <class T>
Result<void> fill(Context& context, Buffer& buffer, const char* name, std::span<const T> values) {
  if (values.empty()) return {};
  VKMESH_TRY(buffer, Buffer::create(context, values.size_bytes(), BufferMemory::kDevice, name));
  return buffer.upload(std::as_bytes(values));
}

/// For each triangle the edges that it shares with another one of the same polygon. Empty where no polygon
/// was cut.
std::vector<std::uint32_t> hidden_edges(std::span<const std::uint32_t> corners,
                                        std::span<const std::uint32_t> source_face) {
  struct Side {
    std::uint32_t low, high, triangle, bit;
  };
  std::vector<std::uint32_t> hidden(source_face.size(), 0);
  std::vector<Side> sides;
  bool any = false;
  for (std::size_t start = 0, end = 0; start < source_face.size(); start = end) {
    while (end < source_face.size() && source_face[end] == source_face[start]) ++end;
    if (end - start < 2) continue;
    sides.clear();
    for (std::size_t t = start; t < end; ++t)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(corners[3 * t + i], corners[3 * t + (i + 1) % 3]);
        sides.push_back({low, high, static_cast<std::uint32_t>(t), 1u << i});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::pair(a.low, a.high) < std::pair(b.low, b.high);
    });
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i].low == sides[i - 1].low && sides[i].high == sides[i - 1].high) {
        hidden[sides[i].triangle] |= sides[i].bit;
        hidden[sides[i - 1].triangle] |= sides[i - 1].bit;
        any = true;
      }
  }
  if (!any) hidden.clear();
  return hidden;
}

}  // namespace

Result<DrawMesh> DrawMesh::create(Context& context, const IndexedFaceSet& triangles,
                                  const DrawMeshData& data) {
  if (!triangles.is_triangles())
    return fail(ErrorCode::kUnsuitable, "triangles can be drawn only: triangulate the polygons first");
  return create(context, triangles.points, triangles.corners, data);
}

Result<DrawMesh> DrawMesh::create(Context& context, const PolygonSoup& soup, const DrawMeshData& data) {
  if (!soup.face_offsets.empty() || soup.corners.size() % 3 != 0)
    return fail(ErrorCode::kUnsuitable,
                "triangles can be drawn only: weld and triangulate the polygons first");
  auto mesh = create(context, soup.corners, {}, data);
  if (mesh) mesh->triangles_ = mesh->points_ / 3;
  return mesh;
}

Result<DrawMesh> DrawMesh::create(Context& context, std::span<const Vec3> points,
                                  std::span<const std::uint32_t> corners, const DrawMeshData& data) {
  return detail::catching([&]() -> Result<DrawMesh> {
    if (points.size() > kInvalid || corners.size() > kInvalid)
      return fail(ErrorCode::kUnsuitable, "points and corners are counted in 32 bits: these are too many");
    VKMESH_CHECK(require_finite(points));
    if (corners.size() % 3 != 0)
      return fail(ErrorCode::kUsage, "the corners of triangles are a multiple of three");
    if (std::any_of(corners.begin(), corners.end(), [&](std::uint32_t c) { return c >= points.size(); }))
      return fail(ErrorCode::kUsage, "a corner names no point");
    const std::size_t triangles = corners.size() / 3;
    const bool soup = corners.empty() && data.element != DrawElement::kPoint;
    const std::size_t elements = data.element == DrawElement::kPoint ? points.size()
                                 : data.element == DrawElement::kFace
                                     ? (soup ? points.size() / 3 : triangles)
                                     : (soup ? points.size() : corners.size());
    VKMESH_CHECK(require_size(data.values.size(), elements, "values"));
    VKMESH_CHECK(require_size(data.colors.size(), elements, "colours"));
    VKMESH_CHECK(require_size(data.normals.size(), points.size(), "normals"));
    VKMESH_CHECK(require_size(data.spacing.size(), points.size(), "radii"));
    VKMESH_CHECK(require_size(data.source_face.size(), triangles, "sources"));

    DrawMesh mesh;
    mesh.points_ = static_cast<std::uint32_t>(points.size());
    mesh.triangles_ = static_cast<std::uint32_t>(triangles);
    mesh.element_ = data.element;
    VKMESH_CHECK(fill(context, mesh.positions_, "positions", points));
    VKMESH_CHECK(fill(context, mesh.corners_, "corners", corners));
    VKMESH_CHECK(fill(context, mesh.normals_, "normals", data.normals));
    VKMESH_CHECK(fill(context, mesh.spacing_, "spacing", data.spacing));
    VKMESH_CHECK(fill(context, mesh.values_, "colours", data.colors));
    if (data.colors.empty()) {
      std::vector<float> values(data.values.begin(), data.values.end());
      for (float& v : values)
        if (!std::isfinite(v)) v = kNoValue;
      VKMESH_CHECK(fill<float>(context, mesh.values_, "values", values));
    }
    const std::vector<std::uint32_t> hidden = hidden_edges(corners, data.source_face);
    VKMESH_CHECK(fill<std::uint32_t>(context, mesh.hidden_edges_, "hidden edges", hidden));
    for (const DrawMeshData::Edges& edges : data.edges) {
      if (edges.ends.size() % 2 != 0 || std::any_of(edges.ends.begin(), edges.ends.end(),
                                                    [&](std::uint32_t v) { return v >= points.size(); }))
        return fail(ErrorCode::kUsage, "an edge to draw names no two points");
      Edges& made = mesh.edges_.emplace_back();
      made.count = static_cast<std::uint32_t>(edges.ends.size() / 2);
      made.color = edges.color;
      made.width = edges.width;
      VKMESH_CHECK(fill(context, made.ends, "edges", edges.ends));
    }
    return mesh;
  });
}

DrawGeometry DrawMesh::geometry() const {
  const auto there = [](const Buffer& buffer) { return buffer.size() == 0 ? nullptr : &buffer; };
  DrawGeometry geometry;
  geometry.positions = there(positions_);
  geometry.corners = there(corners_);
  geometry.normals = there(normals_);
  geometry.values = there(values_);
  geometry.hidden_edges = there(hidden_edges_);
  geometry.spacing = there(spacing_);
  geometry.element = element_;
  geometry.points = points_;
  geometry.triangles = triangles_;
  for (const Edges& edges : edges_)
    if (edges.count > 0) geometry.edges.push_back({&edges.ends, edges.count, edges.color, edges.width});
  return geometry;
}

}  // namespace vkmesh
