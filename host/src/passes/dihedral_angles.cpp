#include <algorithm>

#include <vkmesh/passes/dihedral_angles.h>

#include "catching.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {

Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<DihedralAngles> {
    VKMESH_CHECK(detail::require_triangles(mesh, "dihedral_angles"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    const std::span<const Vec3> p = positions;
    const auto corners = mesh.origins(), twins = mesh.twins();
    std::vector<Vec3> normals(mesh.face_count());
    for (std::size_t f = 0; f < normals.size(); ++f)
      normals[f] = area_vector(p[corners[3 * f]], p[corners[3 * f + 1]], p[corners[3 * f + 2]]);
    detail::to_unit_vectors(normals);

    DihedralAngles result;
    result.half_edge.assign(corners.size(), 0.0f);
    result.vertex_maximum.assign(p.size(), 0.0f);
    // Edges are gathered in blocks small enough to stay in the cache, so that the angles fill vector
    // registers.
    constexpr std::size_t kBlock = 512;
    std::vector<std::uint32_t> edges;
    std::vector<Vec3> left, right;
    std::vector<float> angles(kBlock);
    const auto finish_block = [&] {
      detail::angles_between(left, right, std::span(angles).first(edges.size()));
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const std::uint32_t h = edges[i], t = twins[h];
        result.half_edge[h] = result.half_edge[t] = angles[i];
        for (const std::uint32_t end : {corners[h], corners[t]})
          result.vertex_maximum[end] = std::max(result.vertex_maximum[end], angles[i]);
      }
      edges.clear(), left.clear(), right.clear();
    };
    for (std::uint32_t h = 0; h < corners.size(); ++h) {
      const std::uint32_t t = twins[h];
      if (t == kInvalid || t < h) continue;
      edges.push_back(h);
      left.push_back(normals[h / 3]);
      right.push_back(normals[t / 3]);
      if (edges.size() == kBlock) finish_block();
    }
    finish_block();
    return result;
  });
}

}  // namespace vkmesh
