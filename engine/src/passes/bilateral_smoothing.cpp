#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/bilateral_smoothing.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/passes/detail/bilateral_grid.h>

#include "passes/bilateral_smoothing_params.h"
#include "shaders.h"

namespace vkmesh {

Result<NearbyFaces> NearbyFaces::create(Context& context, const HalfEdgeMesh& mesh,
                                        std::span<const Vec3> positions,
                                        const BilateralSmoothingOptions& options) {
  return detail::catching([&]() -> Result<NearbyFaces> {
    VKMESH_CHECK(detail::require_bilateral_options(options));
    NearbyFaces nearby;
    nearby.options = options;
    nearby.mesh_vertices = static_cast<std::uint32_t>(mesh.vertex_count());
    if (!mesh.is_triangles())
      return fail(ErrorCode::kUnsuitable, "a device takes triangles only: triangulate the polygons first");
    if (positions.size() != mesh.vertex_count())
      return fail(ErrorCode::kUsage, "nearby faces need one position for each vertex");
    if (mesh.face_count() == 0) return nearby;
    std::vector<Vec3> prepared(positions.size());
    VKMESH_CHECK(prepare_positions(positions, prepared));
    VKMESH_TRY(const detail::BilateralGrid grid, detail::bilateral_grid(mesh, prepared, options));

    std::vector<std::uint32_t> face_of_place(mesh.face_count()), vertex_of_place(grid.used.size()),
        cell_of_place(grid.used.size());
    for (std::size_t i = 0; i < face_of_place.size(); ++i) face_of_place[i] = grid.faces.index(i);
    for (std::size_t i = 0; i < vertex_of_place.size(); ++i)
      vertex_of_place[i] = grid.used[grid.vertices.index(i)];
    std::vector<std::uint32_t> near_offsets = {0}, near_ends, far_offsets = {0}, far_ends;
    const auto add = [&](std::uint64_t key, std::uint64_t reach, std::vector<std::uint32_t>& offsets,
                         std::vector<std::uint32_t>& ends) {
      grid.faces.for_each_range_near(key, reach, [&](std::size_t begin, std::size_t end) {
        ends.push_back(static_cast<std::uint32_t>(begin));
        ends.push_back(static_cast<std::uint32_t>(end));
      });
      offsets.push_back(static_cast<std::uint32_t>(ends.size() / 2));
    };
    const auto require_few = [&](const std::vector<std::uint32_t>& offsets,
                                 const std::vector<std::uint32_t>& ends) -> Result<void> {
      const std::size_t ranges = offsets[offsets.size() - 1] - offsets[offsets.size() - 2];
      std::uint64_t rounds = ranges;
      for (std::size_t i = ends.size() - 2 * ranges; i < ends.size(); i += 2) rounds += ends[i + 1] - ends[i];
      if (rounds < context.info().loop_rounds) return {};
      return fail(ErrorCode::kUnsuitable, "some " + std::to_string(rounds) +
                                              " faces lie near one vertex, too many for the loops of " +
                                              context.info().name +
                                              ": take a smaller spatial width, or compute on the CPU");
    };
    for (std::size_t cell = 0; cell < grid.vertices.cell_count(); ++cell) {
      for (std::size_t i = grid.vertices.cell_begin(cell); i < grid.vertices.cell_end(cell); ++i)
        cell_of_place[i] = static_cast<std::uint32_t>(cell);
      add(grid.vertices.key_of_cell(cell), 1, near_offsets, near_ends);
      add(grid.vertices.key_of_cell(cell), 2, far_offsets, far_ends);
      VKMESH_CHECK(require_few(far_offsets, far_ends));
    }
    const auto fill = [&](DeviceArray<std::uint32_t>& array, const std::vector<std::uint32_t>& values,
                          const char* name) { return array.upload(context, values, name); };
    VKMESH_CHECK(fill(nearby.face_order, face_of_place, "faces by place"));
    VKMESH_CHECK(fill(nearby.vertex_order, vertex_of_place, "vertices by place"));
    VKMESH_CHECK(fill(nearby.cells, cell_of_place, "cells of vertices"));
    VKMESH_CHECK(fill(nearby.near.offsets, near_offsets, "near offsets"));
    VKMESH_CHECK(fill(nearby.near.ends, near_ends, "near ranges"));
    VKMESH_CHECK(fill(nearby.far.offsets, far_offsets, "far offsets"));
    VKMESH_CHECK(fill(nearby.far.ends, far_ends, "far ranges"));
    return nearby;
  });
}

Result<void> record_bilateral_smoothing(Recorder& recorder, DeviceMesh& mesh, NearbyFaces& nearby) {
  const std::size_t faces = nearby.face_order.size(), vertices = nearby.vertex_order.size();
  if (nearby.mesh_vertices != mesh.vertex_count() || faces != mesh.face_count())
    return fail(ErrorCode::kUsage, "the nearby faces are those of another mesh");
  if (faces == 0) return {};
  using F = kernels::BilateralFacesParams;
  VKMESH_CHECK(Dispatch<F>(recorder, shaders::bilateral_faces, faces)
                   .read(&F::positions, mesh.positions())
                   .read(&F::corners, mesh.corners())
                   .read(&F::face_order, nearby.face_order)
                   .write(&F::faces, nearby.centroids_and_areas, 4 * faces)
                   .set(&F::spatial, nearby.options.spatial)
                   .record());
  VKMESH_CHECK(nearby.mollified.resize(recorder.context(), mesh.vertex_count(), "mollified positions"));
  VKMESH_CHECK(nearby.normals.resize(recorder.context(), faces, "mollified normals"));
  const auto sum = [&](const KernelSource& kernel, const NearbyFaces::Ranges& ranges,
                       const DeviceArray<Vec3>& target) {
    using P = kernels::BilateralSumParams;
    return Dispatch<P>(recorder, kernel, vertices)
        .read(&P::positions, mesh.positions())
        .read(&P::vertex_order, nearby.vertex_order)
        .read(&P::cells, nearby.cells)
        .read(&P::range_offsets, ranges.offsets)
        .read(&P::ranges, ranges.ends)
        .read(&P::faces, nearby.centroids_and_areas)
        .read(&P::normals, nearby.normals)
        .write(&P::target, target)
        .set(&P::spatial, nearby.options.spatial)
        .set(&P::per_spatial, exact::reciprocal(nearby.options.spatial))
        .set(&P::spatial_over_influence, nearby.options.spatial * exact::reciprocal(nearby.options.influence))
        .record();
  };
  VKMESH_CHECK(sum(shaders::bilateral_mollify, nearby.near, nearby.mollified));
  using N = kernels::BilateralNormalsParams;
  VKMESH_CHECK(Dispatch<N>(recorder, shaders::bilateral_normals, faces)
                   .read(&N::mollified, nearby.mollified)
                   .read(&N::corners, mesh.corners())
                   .read(&N::face_order, nearby.face_order)
                   .write(&N::normals, nearby.normals)
                   .record());
  return sum(shaders::bilateral_move, nearby.far, mesh.positions());
}

}  // namespace vkmesh
