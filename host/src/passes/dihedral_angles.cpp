#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>

#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/triangle_normals.h>

#include "catching.h"
#include "parallel.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// Of non-negative floats. The largest does not depend on the order in which threads come.
void raise_to(float& largest, float value) {
  std::atomic_ref<float> shared(largest);
  float seen = shared.load(std::memory_order_relaxed);
  while (seen < value && !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) continue;
}

}  // namespace

Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<DihedralAngles> {
    VKMESH_CHECK(detail::require_triangles(mesh, "dihedral_angles"));
    VKMESH_TRY(const std::vector<Vec3> normals, triangle_normals(mesh, positions));
    const auto corners = mesh.origins(), twins = mesh.twins();
    DihedralAngles result;
    result.half_edge.assign(corners.size(), 0.0f);
    result.vertex_maximum.assign(positions.size(), 0.0f);
    // Edges are gathered in blocks small enough to stay in the cache, so that the angles fill vector
    // registers.
    constexpr std::size_t kBlock = 512;
    detail::parallel_ranges(corners.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
      std::array<std::uint32_t, kBlock> edges;
      std::array<Vec3, kBlock> left, right, along;
      std::array<float, kBlock> angles;
      std::size_t count = 0;
      const auto finish_block = [&] {
        detail::dihedral_angles(left, right, along, std::span(angles).first(count));
        for (std::size_t i = 0; i < count; ++i) {
          const std::uint32_t h = edges[i], t = twins[h];
          result.half_edge[h] = result.half_edge[t] = angles[i];
          for (const std::uint32_t v : {corners[h], corners[t]})
            raise_to(result.vertex_maximum[v], std::fabs(angles[i]));
        }
        count = 0;
      };
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t t = twins[h];
        if (t == kInvalid || t < h) continue;
        edges[count] = h;
        left[count] = normals[h / 3];
        right[count] = normals[t / 3];
        along[count] = positions[corners[t]] - positions[corners[h]];
        if (++count == kBlock) finish_block();
      }
      finish_block();
    });
    return result;
  });
}

}  // namespace vkmesh
