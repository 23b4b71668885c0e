#include <algorithm>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/vertex_normals.h>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "math/vector_kernels.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// The weighted normals of some triangles, at each of their corners where these differ.
struct Block {
  std::vector<Vec3> normals, at_corners;
  std::vector<float> angles;
};

}  // namespace

Result<void> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                            std::span<Vec3> normals, const VertexNormalsOptions& options) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(detail::require_triangles(mesh, "vertex_normals"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    VKMESH_CHECK(detail::require_size(normals, mesh.vertex_count(), "vertices"));
    const bool by_angle = options.weights == NormalWeights::kAngle;
    const auto corners_of = [&](std::size_t begin, std::size_t end) {
      return mesh.origins().subspan(3 * begin, 3 * (end - begin));
    };
    const auto weigh = [&](std::size_t begin, std::size_t end, Block& block) {
      const auto corners = corners_of(begin, end);
      block.normals.resize(end - begin);
      detail::area_vectors(positions, corners, block.normals);
      if (options.weights == NormalWeights::kArea) return;
      detail::to_unit_vectors(block.normals);
      if (!by_angle) return;
      block.angles.resize(corners.size()), block.at_corners.resize(corners.size());
      detail::corner_angles(positions, corners, block.angles);
      for (std::size_t h = 0; h < corners.size(); ++h)
        block.at_corners[h] = zero_below(block.angles[h], VKMESH_TINY_DIRECTION) * block.normals[h / 3];
    };
    // Scattering over ascending faces adds in the order in which the shader gathers.
    const auto scatter = [&](std::size_t begin, std::size_t end, const Block& block) {
      const auto corners = corners_of(begin, end);
      if (by_angle)
        for (std::size_t h = 0; h < corners.size(); ++h) normals[corners[h]] += block.at_corners[h];
      else
        for (std::size_t f = 0; f < block.normals.size(); ++f)
          for (std::size_t i = 0; i < 3; ++i) normals[corners[3 * f + i]] += block.normals[f];
    };
    detail::parallel_ranges(normals.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
      std::ranges::fill(normals.subspan(begin, end - begin), Vec3(0.0f));
    });
    detail::parallel_in_order<Block>(mesh.face_count(), 1 << 14, weigh, scatter);
    detail::parallel_ranges(normals.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
      detail::to_unit_vectors(normals.subspan(begin, end - begin));
    });
    return {};
  });
}

Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                         const VertexNormalsOptions& options) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    std::vector<Vec3> normals = detail::large_vector<Vec3>(mesh.vertex_count());
    VKMESH_CHECK(vertex_normals(mesh, positions, normals, options));
    return normals;
  });
}

}  // namespace vkmesh
