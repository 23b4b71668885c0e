#include <algorithm>
#include <array>
#include <cmath>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/dihedral_angles.h>

#include "base/huge_pages.h"
#include "base/large_array.h"
#include "base/parallel.h"
#include "base/prefetch.h"
#include "math/vector_kernels.h"
#include "mesh/triangle_half_edges.h"
#include "passes/pass_input.h"
#include "passes/raw_normals.h"

namespace vkmesh {
namespace {

constexpr std::size_t kGrain = 1 << 12;

// Some edges by their smaller half-edges, and their angles.
struct Block {
  std::size_t count = 0;
  std::vector<std::uint32_t> edges;
  std::vector<float> angles;
};

// Edges that are computed side by side, few enough to stay in the first cache.
constexpr std::size_t kSideBySide = 128;
struct Sides {
  std::array<Vec3, kSideBySide> left, right, along;
};

}  // namespace

Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<DihedralAngles> {
    VKMESH_CHECK(detail::require_triangles(mesh, "dihedral_angles"));
    const auto corners = mesh.origins(), twins = mesh.twins();
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    detail::LargeArray<Vec3> normals(mesh.face_count());
    detail::raw_triangle_normals(mesh, positions, std::span(normals.data(), normals.size()));
    DihedralAngles result;
    result.half_edge = detail::large_vector<float>(corners.size());
    result.vertex_maximum = detail::large_vector<float>(positions.size());
    const auto measure = [&](std::size_t begin, std::size_t end, Block& block) {
      block.edges.resize(kGrain), block.angles.resize(kGrain);
      std::size_t count = 0;
      for (std::size_t h = begin; h < end; ++h) {
        block.edges[count] = static_cast<std::uint32_t>(h);
        // No branch, which would be guessed wrong every other time.
        count += static_cast<std::size_t>(twins[h] > h) & static_cast<std::size_t>(twins[h] != kInvalid);
      }
      block.count = count;
      Sides sides;
      for (std::size_t first = 0; first < count; first += kSideBySide) {
        const std::size_t last = std::min(first + kSideBySide, count), size = last - first;
        // What is far away is fetched while other angles are computed.
        for (std::size_t i = last; i < std::min(last + kSideBySide, count); ++i) {
          const std::uint32_t twin = twins[block.edges[i]];
          detail::prefetch(&normals[twin / 3]);
          detail::prefetch(&result.half_edge[twin]);
        }
        for (std::size_t i = 0; i < size; ++i) {
          const std::uint32_t h = block.edges[first + i];
          sides.left[i] = normals[h / 3];
          sides.right[i] = normals[twins[h] / 3];
          sides.along[i] = positions[corners[detail::next_in_triangle(h)]] - positions[corners[h]];
        }
        const auto angles = std::span(block.angles).subspan(first, size);
        detail::dihedral_angles(std::span(sides.left).first(size), std::span(sides.right).first(size),
                                std::span(sides.along).first(size), angles);
        for (std::size_t i = 0; i < size; ++i) {
          const std::uint32_t h = block.edges[first + i];
          result.half_edge[h] = result.half_edge[twins[h]] = angles[i];
        }
      }
    };
    const auto spread = [&](std::size_t, std::size_t, const Block& block) {
      for (std::size_t i = 0; i < block.count; ++i) {
        const std::uint32_t h = block.edges[i];
        for (const std::uint32_t end : {corners[h], corners[detail::next_in_triangle(h)]})
          result.vertex_maximum[end] = std::max(result.vertex_maximum[end], std::fabs(block.angles[i]));
      }
    };
    detail::parallel_in_order<Block>(corners.size(), kGrain, measure, spread);
    return result;
  });
}

}  // namespace vkmesh
