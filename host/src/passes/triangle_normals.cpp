#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/triangle_normals.h>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "math/vector_kernels.h"
#include "passes/pass_input.h"
#include "passes/raw_normals.h"

namespace vkmesh {
namespace detail {

void raw_triangle_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                          std::span<Vec3> normals) {
  parallel_ranges(normals.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    const auto block = normals.subspan(begin, end - begin);
    area_vectors(positions, mesh.origins().subspan(3 * begin, 3 * block.size()), block);
    to_unit_vectors(block);
  });
}

}  // namespace detail

Result<void> triangle_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                              std::span<Vec3> normals) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(detail::require_triangles(mesh, "triangle_normals"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    VKMESH_CHECK(detail::require_size(normals, mesh.face_count(), "faces"));
    detail::raw_triangle_normals(mesh, positions, normals);
    return {};
  });
}

Result<std::vector<Vec3>> triangle_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    std::vector<Vec3> normals = detail::large_vector<Vec3>(mesh.face_count());
    VKMESH_CHECK(triangle_normals(mesh, positions, normals));
    return normals;
  });
}

}  // namespace vkmesh
