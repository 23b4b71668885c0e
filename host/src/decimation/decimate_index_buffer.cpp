#include <cmath>
#include <cstddef>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/decimation/decimate_index_buffer.h>

#include "base/distinct_rows.h"
#include "decimation/setup/check_options.h"
#include "decimation/setup/part_surface.h"
#include "mesh/triangle_half_edges.h"

namespace vkmesh {
namespace {

/// For each point the first one at the same place.
std::vector<std::uint32_t> first_at_place(std::span<const Vec3> points) {
  std::vector<std::uint32_t> first(points.size()), first_of_row;
  std::vector<Vec3> rows;
  detail::DistinctRows<3> distinct;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    const std::uint32_t row = distinct.number(&points[v].x, rows);
    if (row == first_of_row.size()) first_of_row.push_back(v);
    first[v] = first_of_row[row];
  }
  return first;
}

Result<DecimatedIndexBuffer> run(std::span<const Vec3> points, std::span<const std::uint32_t> indices,
                                 const DecimateOptions& options, const Progress& progress) {
  const auto usage = [](const char* what) { return fail(ErrorCode::kUsage, what); };
  if (!options.corner_groups.empty()) return usage("the vertices are the corner_groups of an index buffer");
  if (indices.size() % 3 != 0) return usage("decimation takes three indices a triangle");
  for (const std::uint32_t v : indices)
    if (v >= points.size()) return usage("an index names no vertex");
  for (const DecimateAttribute& a : options.attributes)
    if (!a.corners.empty()) return usage("an attribute of an index buffer has one value for each vertex");
  VKMESH_CHECK(detail::check_options(options, points.size(), indices.size()));
  for (const Vec3& p : points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return fail(ErrorCode::kUnsuitable, "decimation needs finite positions");

  const std::vector<std::uint32_t> first = first_at_place(points);
  std::vector<std::uint32_t> vertices, corners, faces, new_face(indices.size() / 3, kInvalid);
  for (std::uint32_t f = 0; f < new_face.size(); ++f) {
    const auto face = indices.subspan(3 * std::size_t{f}, 3);
    const std::uint32_t a = first[face[0]], b = first[face[1]], c = first[face[2]];
    if (a == b || b == c || c == a) continue;
    new_face[f] = static_cast<std::uint32_t>(faces.size());
    faces.push_back(f);
    vertices.insert(vertices.end(), face.begin(), face.end());
    corners.insert(corners.end(), {a, b, c});
  }

  DecimateOptions welded = options;
  if (welded.operation == DecimateOperation::kEdgeCollapse)
    welded.operation = DecimateOperation::kHalfEdgeCollapse;
  welded.corner_groups = vertices;
  for (DecimateAttribute& a : welded.attributes) a.corners = vertices;
  for (std::uint32_t& v : welded.locked.vertices) v = first[v];
  welded.locked.faces.clear();
  for (const std::uint32_t f : options.locked.faces) {
    if (new_face[f] != kInvalid)
      welded.locked.faces.push_back(new_face[f]);
    else
      for (std::size_t i = 0; i < 3; ++i) welded.locked.vertices.push_back(first[indices[3 * f + i]]);
  }
  welded.locked.edges.clear();
  for (const std::uint32_t h : options.locked.edges)
    for (const std::uint32_t c : {h, detail::next_in_triangle(h)})
      welded.locked.vertices.push_back(first[indices[c]]);

  auto decimated = decimate(TriangleSurface{points, corners}, welded, progress);
  if (!decimated && decimated.error().code == ErrorCode::kUnsuitable) {
    // Most surfaces are oriented manifolds. What could have been unsuitable else was looked at above.
    const detail::PartedSurface parts = detail::part_surface(points.size(), corners, vertices);
    std::vector<std::uint8_t> locked = parts.parted;
    for (const std::uint32_t v : welded.locked.vertices) locked[v] = 1;
    for (const std::uint32_t f : welded.locked.faces)
      for (std::size_t i = 0; i < 3; ++i) locked[corners[3 * f + i]] = 1;
    welded.locked = {};
    std::vector<Vec3> places;
    for (std::uint32_t v = 0; v < parts.point_of.size(); ++v) {
      places.push_back(points[parts.point_of[v]]);
      if (locked[parts.point_of[v]]) welded.locked.vertices.push_back(v);
    }
    decimated = decimate(TriangleSurface{places, parts.corners}, welded, progress);
  }
  if (!decimated) return tl::unexpected<Error>(std::move(decimated).error());
  const Decimated& d = *decimated;
  DecimatedIndexBuffer result{d, {}, {}};
  result.indices.reserve(d.attributes.corners.size());
  for (const std::uint32_t w : d.attributes.corners)
    result.indices.push_back(vertices[d.attributes.source_corner[w]]);
  for (const std::uint32_t f : d.source_face) result.source_face.push_back(faces[f]);
  return result;
}

}  // namespace

Result<DecimatedIndexBuffer> decimate_index_buffer(const StridedSpan<Vec3>& points,
                                                   std::span<const std::uint32_t> indices,
                                                   const DecimateOptions& options, const Progress& progress) {
  return detail::catching([&] {
    if (points.is_packed()) return run(points.packed(), indices, options, progress);
    std::vector<Vec3> packed;
    packed.reserve(points.size());
    for (std::size_t v = 0; v < points.size(); ++v) packed.push_back(points[v]);
    return run(packed, indices, options, progress);
  });
}

}  // namespace vkmesh
