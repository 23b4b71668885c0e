#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/vertex_normals.h>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "math/vector_kernels.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// The weighted normals of some faces, at each of their corners where these differ.
struct Block {
  std::vector<Vec3> normals, at_corners;
  std::vector<float> angles;
};

// Twice the area of a polygon along its normal: the sum over any triangles that it is cut into.
Vec3 area_vector_of(std::span<const Vec3> positions, std::span<const std::uint32_t> polygon) {
  Vec3 sum(0.0f);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += area_vector(positions[polygon[0]], positions[polygon[i]], positions[polygon[i + 1]]);
  return sum;
}

// The inner angle at corner i of a polygon of that unit normal, in [0, 2π].
float inner_angle(std::span<const Vec3> positions, std::span<const std::uint32_t> polygon, std::size_t i,
                  Vec3 normal) {
  const std::size_t n = polygon.size();
  const Vec3 &here = positions[polygon[i]], &next = positions[polygon[(i + 1) % n]],
             &previous = positions[polygon[(i + n - 1) % n]];
  const Vec3 area = area_vector(here, next, previous);
  const float angle = corner_angle(corner_product(here, next, previous), vector_length(area));
  const bool reflex = (area.x * normal.x + area.y * normal.y) + area.z * normal.z < 0.0f;
  return reflex ? (4.0f * VKMESH_HALF_PI_HIGH - angle) + 4.0f * VKMESH_HALF_PI_LOW : angle;
}

// As the triangles' scatter below, for faces of any size.
void scatter_polygons(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, NormalWeights weights,
                      std::span<Vec3> normals) {
  const auto offsets = mesh.face_offsets();
  const auto polygon = [&](std::size_t f) {
    return mesh.origins().subspan(offsets[f], offsets[f + 1] - offsets[f]);
  };
  const auto weigh = [&](std::size_t begin, std::size_t end, Block& block) {
    block.normals.resize(end - begin);
    for (std::size_t f = begin; f < end; ++f)
      block.normals[f - begin] = area_vector_of(positions, polygon(f));
    if (weights == NormalWeights::kArea) return;
    detail::to_unit_vectors(block.normals);
    if (weights != NormalWeights::kAngle) return;
    block.at_corners.clear();
    for (std::size_t f = begin; f < end; ++f)
      for (std::size_t i = 0; i < polygon(f).size(); ++i) {
        const Vec3 normal = block.normals[f - begin];
        block.at_corners.push_back(
            zero_below(inner_angle(positions, polygon(f), i, normal), VKMESH_TINY_DIRECTION) * normal);
      }
  };
  const auto scatter = [&](std::size_t begin, std::size_t end, const Block& block) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::size_t h = offsets[f]; h < offsets[f + 1]; ++h)
        normals[mesh.origins()[h]] += weights == NormalWeights::kAngle ? block.at_corners[h - offsets[begin]]
                                                                       : block.normals[f - begin];
  };
  detail::parallel_in_order<Block>(mesh.face_count(), 1 << 13, weigh, scatter);
}

}  // namespace

Result<void> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                            std::span<Vec3> normals, const VertexNormalsOptions& options) {
  return detail::catching([&]() -> Result<void> {
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
    if (mesh.is_triangles())
      detail::parallel_in_order<Block>(mesh.face_count(), 1 << 14, weigh, scatter);
    else
      scatter_polygons(mesh, positions, options.weights, normals);
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
