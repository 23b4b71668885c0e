#include <algorithm>
#include <cmath>

#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/triangle_normals.h>

#include "catching.h"
#include "large_pages.h"
#include "parallel.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// Some edges by their smaller half-edges: the normals on their sides, and the signed angles between these.
struct Block {
  std::vector<std::uint32_t> edges;
  std::vector<Vec3> left, right, along;
  std::vector<float> angles;

  void resize(std::size_t n) {
    edges.resize(n), left.resize(n), right.resize(n), along.resize(n), angles.resize(n);
  }
};

}  // namespace

Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<DihedralAngles> {
    VKMESH_CHECK(detail::require_triangles(mesh, "dihedral_angles"));
    const auto corners = mesh.origins(), twins = mesh.twins();
    VKMESH_TRY(const std::vector<Vec3> normals, triangle_normals(mesh, positions));
    DihedralAngles result;
    result.half_edge = detail::large_vector<float>(corners.size());
    result.vertex_maximum = detail::large_vector<float>(positions.size());
    // Edges are gathered in blocks small enough to stay in the cache, so that the angles fill vector
    // registers.
    const auto measure = [&](std::size_t begin, std::size_t end, Block& block) {
      block.resize(end - begin);
      std::size_t count = 0;
      for (std::size_t h = begin; h < end; ++h) {
        block.edges[count] = static_cast<std::uint32_t>(h);
        // No branch, which would be guessed wrong every other time.
        count += static_cast<std::size_t>(twins[h] > h) & static_cast<std::size_t>(twins[h] != kInvalid);
      }
      block.resize(count);
      for (std::size_t i = 0; i < count; ++i) {
        block.left[i] = normals[block.edges[i] / 3];
        block.right[i] = normals[twins[block.edges[i]] / 3];
        block.along[i] = positions[corners[twins[block.edges[i]]]] - positions[corners[block.edges[i]]];
      }
      detail::dihedral_angles(block.left, block.right, block.along, block.angles);
      for (std::size_t i = 0; i < count; ++i)
        result.half_edge[block.edges[i]] = result.half_edge[twins[block.edges[i]]] = block.angles[i];
    };
    const auto spread = [&](std::size_t, std::size_t, const Block& block) {
      for (std::size_t i = 0; i < block.edges.size(); ++i)
        for (const std::uint32_t end : {corners[block.edges[i]], corners[twins[block.edges[i]]]})
          result.vertex_maximum[end] = std::max(result.vertex_maximum[end], std::fabs(block.angles[i]));
    };
    detail::parallel_in_order<Block>(corners.size(), 1 << 12, measure, spread);
    return result;
  });
}

}  // namespace vkmesh
