#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/decimation/decimate_index_buffer.h>

namespace vkmesh {
namespace {

/// For each point the first one at the same place.
std::vector<std::uint32_t> first_at_place(std::span<const Vec3> points) {
  const auto place = [&](std::uint32_t v) { return std::tie(points[v].x, points[v].y, points[v].z); };
  std::vector<std::uint32_t> order(points.size()), first(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return place(a) != place(b) ? place(a) < place(b) : a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && place(order[i]) == place(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

Result<DecimatedIndexBuffer> run(std::span<const Vec3> points, std::span<const std::uint32_t> indices,
                                 const DecimateOptions& options, const Progress& progress) {
  const auto usage = [](const char* what) { return fail(ErrorCode::kUsage, what); };
  if (options.operation != DecimateOperation::kHalfEdgeCollapse)
    return usage("only half-edge collapses leave the vertices as they are");
  if (!options.corner_groups.empty()) return usage("the vertices are the corner_groups of an index buffer");
  if (indices.size() % 3 != 0) return usage("decimation takes three indices a triangle");
  for (const std::uint32_t v : indices)
    if (v >= points.size()) return usage("an index names no vertex");
  for (const std::uint32_t v : options.locked_vertices)
    if (v >= points.size()) return usage("a locked vertex is not of the mesh");
  for (const std::uint32_t h : options.locked_edges)
    if (h >= indices.size()) return usage("a locked edge is not of the mesh");
  for (const std::uint32_t f : options.locked_faces)
    if (f >= indices.size() / 3) return usage("a locked face is not of the mesh");
  for (const DecimateAttribute& a : options.attributes)
    if (!a.corners.empty()) return usage("an attribute of an index buffer has one value for each vertex");
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
  welded.corner_groups = vertices;
  for (DecimateAttribute& a : welded.attributes) {
    if (a.components == 0 || a.values.size() != points.size() * a.components)
      return usage("an attribute of an index buffer has one value for each vertex");
    a.corners = vertices;
  }
  for (std::uint32_t& v : welded.locked_vertices) v = first[v];
  welded.locked_faces.clear();
  for (const std::uint32_t f : options.locked_faces) {
    if (new_face[f] != kInvalid)
      welded.locked_faces.push_back(new_face[f]);
    else
      for (std::size_t i = 0; i < 3; ++i) welded.locked_vertices.push_back(first[indices[3 * f + i]]);
  }
  welded.locked_edges.clear();
  for (const std::uint32_t h : options.locked_edges)
    for (const std::uint32_t c : {h, h % 3 == 2 ? h - 2 : h + 1})
      welded.locked_vertices.push_back(first[indices[c]]);

  VKMESH_TRY(const Decimated d, decimate(TriangleSurface{points, corners}, welded, progress));
  DecimatedIndexBuffer result;
  result.stop = d.stop;
  result.error = d.error;
  result.relative_error = d.relative_error;
  result.attribute_error = d.attribute_error;
  result.indices.reserve(d.attributes.corners.size());
  for (const std::uint32_t w : d.attributes.corners)
    result.indices.push_back(vertices[d.attributes.source_corner[w]]);
  for (const std::uint32_t f : d.source_face) result.source_face.push_back(faces[f]);
  return result;
}

}  // namespace

Result<DecimatedIndexBuffer> decimate_index_buffer(std::span<const Vec3> points,
                                                   std::span<const std::uint32_t> indices,
                                                   const DecimateOptions& options, const Progress& progress) {
  return detail::catching([&] { return run(points, indices, options, progress); });
}

}  // namespace vkmesh
