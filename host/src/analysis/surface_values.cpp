#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include <vkmesh/analysis/surface_values.h>
#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/arithmetic.h>

#include "base/disjoint_sets.h"
#include "mesh/edge_records.h"
#include "spatial/kd_tree.h"

namespace vkmesh {
namespace {

using glm::cross;
using glm::dot;
using glm::length;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Result<void> require_points(const IndexedFaceSet& mesh) {
  const auto bad = std::find_if(mesh.corners.begin(), mesh.corners.end(),
                                [&](std::uint32_t c) { return c >= mesh.points.size(); });
  if (bad == mesh.corners.end()) return {};
  return fail(ErrorCode::kUsage, "corner " + std::to_string(bad - mesh.corners.begin()) + " names no point");
}

Result<void> require_triangles(const IndexedFaceSet& mesh) {
  if (mesh.is_triangles() && mesh.corners.size() % 3 == 0) return {};
  return fail(ErrorCode::kUnsuitable, "this takes triangles only: triangulate the polygons first");
}

/// Twice the area of a face along its normal.
DVec3 newell(const IndexedFaceSet& mesh, std::size_t f) {
  const auto corners = mesh.face(f);
  DVec3 sum(0.0);
  if (corners.size() < 3) return sum;
  // Relative to one of its points, so that faces far from zero keep their digits.
  const DVec3 origin(mesh.points[corners[0]]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += cross(DVec3(mesh.points[corners[i]]) - origin, DVec3(mesh.points[corners[i + 1]]) - origin);
  return sum;
}

}  // namespace

Result<std::vector<SurfaceEdge>> surface_edges(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<std::vector<SurfaceEdge>> {
    VKMESH_CHECK(require_points(mesh));
    const detail::FaceOfCorner face_of(mesh);
    detail::EdgeRecords records =
        detail::distribute_edges(mesh.points.size(), mesh.corners, mesh.face_offsets, mesh.face_count());
    std::vector<SurfaceEdge> edges;
    edges.reserve(mesh.corners.size() / 2);
    records.for_each_group(
        0, mesh.points.size(), [&](std::uint32_t a, std::uint32_t b, std::span<const std::uint64_t> uses) {
          const auto h = static_cast<std::uint32_t>(uses[0]);
          SurfaceEdge edge{a, b, static_cast<std::uint32_t>(uses.size()), face_of(h), kInvalid, false};
          if (uses.size() > 1) {
            const auto g = static_cast<std::uint32_t>(uses[1]);
            edge.second_face = face_of(g);
            edge.opposed = uses.size() == 2 && mesh.corners[h] != mesh.corners[g];
          }
          edges.push_back(edge);
        });
    return edges;
  });
}

Result<std::vector<float>> signed_dihedral_angles(const IndexedFaceSet& mesh,
                                                  std::span<const SurfaceEdge> edges) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(require_points(mesh));
    std::vector<DVec3> normals(mesh.face_count());
    std::vector<DVec3> centers(mesh.face_count());
    for (std::size_t f = 0; f < normals.size(); ++f) {
      normals[f] = newell(mesh, f);
      DVec3 sum(0.0);
      for (const std::uint32_t c : mesh.face(f)) sum += DVec3(mesh.points[c]);
      centers[f] = sum / static_cast<double>(std::max<std::size_t>(mesh.face(f).size(), 1));
    }
    std::vector<float> angles(edges.size(), 0.0f);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (!edges[e].opposed) continue;
      const DVec3& n = normals[edges[e].first_face];
      const DVec3& m = normals[edges[e].second_face];
      if (!(dot(n, n) > 0.0) || !(dot(m, m) > 0.0)) continue;
      const double angle = std::atan2(length(cross(n, m)), dot(n, m));
      // Convex: the other face lies below this one's plane.
      const bool concave = dot(n, centers[edges[e].second_face] - DVec3(mesh.points[edges[e].a])) > 0.0;
      angles[e] = static_cast<float>(concave ? -angle : angle);
    }
    return angles;
  });
}

Result<std::vector<float>> mean_curvatures(const IndexedFaceSet& mesh, std::span<const SurfaceEdge> edges,
                                           std::span<const float> signed_angles) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(require_points(mesh));
    std::vector<double> area(mesh.points.size(), 0.0), curvature(mesh.points.size(), 0.0);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = mesh.face(f);
      const double share =
          length(newell(mesh, f)) / 2.0 / static_cast<double>(std::max<std::size_t>(corners.size(), 1));
      for (const std::uint32_t c : corners) area[c] += share;
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const double along = length(DVec3(mesh.points[edges[e].a]) - DVec3(mesh.points[edges[e].b]));
      const double share = along * static_cast<double>(signed_angles[e]) / 4.0;
      curvature[edges[e].a] += share;
      curvature[edges[e].b] += share;
    }
    std::vector<float> values(mesh.points.size());
    for (std::size_t v = 0; v < values.size(); ++v)
      values[v] = area[v] > 0.0 ? static_cast<float>(curvature[v] / area[v]) : kNaN;
    return values;
  });
}

Result<std::vector<float>> largest_angles(const IndexedFaceSet& mesh, std::span<const SurfaceEdge> edges,
                                          std::span<const float> signed_angles) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    std::vector<float> values(mesh.points.size(), 0.0f);
    for (std::size_t e = 0; e < edges.size(); ++e)
      for (const std::uint32_t v : {edges[e].a, edges[e].b})
        values[v] = std::max(values[v], std::abs(signed_angles[e]));
    return values;
  });
}

Result<std::vector<float>> valences(const IndexedFaceSet& mesh, std::span<const SurfaceEdge> edges) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    std::vector<float> values(mesh.points.size(), 0.0f);
    for (const SurfaceEdge& e : edges)
      for (const std::uint32_t v : {e.a, e.b}) values[v] += 1.0f;
    return values;
  });
}

Result<ConnectedComponents> connected_components(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<ConnectedComponents> {
    VKMESH_CHECK(require_points(mesh));
    detail::DisjointSets sets(mesh.points.size());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (const std::uint32_t c : mesh.face(f)) sets.unite(mesh.face(f)[0], c);
    const detail::NumberedSets components = detail::number_sets(sets);
    std::vector<std::size_t> faces(components.sizes.size(), 0);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      if (!mesh.face(f).empty()) ++faces[components.of[mesh.face(f)[0]]];
    std::vector<std::uint32_t> by_size;
    for (std::uint32_t i = 0; i < faces.size(); ++i)
      if (faces[i] > 0) by_size.push_back(i);
    std::stable_sort(by_size.begin(), by_size.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return faces[a] > faces[b]; });
    ConnectedComponents result;
    std::vector<float> rank(faces.size(), kNaN);
    for (std::size_t i = 0; i < by_size.size(); ++i) {
      rank[by_size[i]] = static_cast<float>(i);
      result.faces.push_back(faces[by_size[i]]);
    }
    result.of_point.resize(mesh.points.size());
    for (std::size_t v = 0; v < mesh.points.size(); ++v) result.of_point[v] = rank[components.of[v]];
    return result;
  });
}

Result<std::vector<float>> triangle_qualities(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(require_triangles(mesh));
    VKMESH_CHECK(require_points(mesh));
    std::vector<float> values(mesh.face_count());
    for (std::size_t f = 0; f < values.size(); ++f) {
      const auto c = mesh.face(f);
      const DVec3 a(mesh.points[c[0]]), b(mesh.points[c[1]]), d(mesh.points[c[2]]);
      const double sides = dot(b - a, b - a) + dot(d - b, d - b) + dot(a - d, a - d);
      const double twice_area = length(cross(b - a, d - a));
      values[f] = sides > 0.0 ? static_cast<float>(2.0 * std::sqrt(3.0) * twice_area / sides) : 0.0f;
    }
    return values;
  });
}

Result<std::vector<Vec3>> point_normals(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(require_triangles(mesh));
    VKMESH_CHECK(require_points(mesh));
    std::vector<Vec3> p(mesh.points.size());
    VKMESH_CHECK(prepare_positions(mesh.points, p));
    std::vector<Vec3> normals(p.size(), Vec3(0.0f));
    for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
      const std::uint32_t* c = mesh.corners.data() + i;
      const Vec3 area = area_vector(p[c[0]], p[c[1]], p[c[2]]);
      for (std::size_t k = 0; k < 3; ++k) normals[c[k]] += area;
    }
    for (Vec3& n : normals) n = unit_vector(n);
    return normals;
  });
}

Result<std::vector<float>> point_spacing(std::span<const Vec3> points, unsigned neighbours) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    std::vector<float> spacing(points.size(), 0.0f);
    if (points.size() < 2 || neighbours == 0) return spacing;
    const detail::KdTree<Vec3> tree(points);
    std::vector<float> heap, positive;
    for (std::size_t v = 0; v < points.size(); ++v) {
      spacing[v] = std::sqrt(tree.kth_squared_distance(static_cast<std::uint32_t>(v), neighbours, heap));
      if (spacing[v] > 0.0f) positive.push_back(spacing[v]);
    }
    if (positive.empty()) return spacing;
    const auto middle = positive.begin() + static_cast<std::ptrdiff_t>(positive.size() / 2);
    std::nth_element(positive.begin(), middle, positive.end());
    for (float& s : spacing)
      if (!(s > 0.0f)) s = *middle;
    return spacing;
  });
}

}  // namespace vkmesh
