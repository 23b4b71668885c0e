#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/passes/bilateral_smoothing.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/passes/detail/bilateral_grid.h>

#include "passes/bilateral_smoothing_params.h"
#include "shaders.h"

namespace vkmesh {
namespace {

template <class T>
Result<void> fill(Context& context, Buffer& buffer, const std::vector<T>& values, const char* name) {
  VKMESH_TRY(buffer, Buffer::create(context, values.size() * sizeof(T), BufferMemory::kDevice, name));
  return buffer.upload_values<T>(values);
}

}  // namespace

Result<NearbyFaces> NearbyFaces::create(Context& context, const HalfEdgeMesh& mesh,
                                        std::span<const Vec3> positions,
                                        const BilateralSmoothingOptions& options) {
  return detail::catching([&]() -> Result<NearbyFaces> {
    VKMESH_CHECK(detail::require_bilateral_options(options));
    NearbyFaces nearby;
    nearby.options_ = options;
    nearby.vertices_of_mesh_ = static_cast<std::uint32_t>(mesh.vertex_count());
    if (!mesh.is_triangles())
      return fail(ErrorCode::kUnsuitable, "a device takes triangles only: triangulate the polygons first");
    if (positions.size() != mesh.vertex_count())
      return fail(ErrorCode::kUsage, "nearby faces need one position for each vertex");
    if (mesh.face_count() == 0) return nearby;
    std::vector<Vec3> prepared(positions.size());
    VKMESH_CHECK(prepare_positions(positions, prepared));
    VKMESH_TRY(const detail::BilateralGrid grid, detail::bilateral_grid(mesh, prepared, options));

    nearby.faces_ = static_cast<std::uint32_t>(mesh.face_count());
    nearby.vertices_ = static_cast<std::uint32_t>(grid.used.size());
    std::vector<std::uint32_t> face_order(nearby.faces_), vertex_order(nearby.vertices_),
        cells(nearby.vertices_);
    for (std::size_t i = 0; i < face_order.size(); ++i) face_order[i] = grid.faces.index(i);
    for (std::size_t i = 0; i < vertex_order.size(); ++i) vertex_order[i] = grid.used[grid.vertices.index(i)];
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
        cells[i] = static_cast<std::uint32_t>(cell);
      add(grid.vertices.key_of_cell(cell), 1, near_offsets, near_ends);
      add(grid.vertices.key_of_cell(cell), 2, far_offsets, far_ends);
      VKMESH_CHECK(require_few(far_offsets, far_ends));
    }
    VKMESH_CHECK(fill(context, nearby.face_order_, face_order, "faces by place"));
    VKMESH_CHECK(fill(context, nearby.vertex_order_, vertex_order, "vertices by place"));
    VKMESH_CHECK(fill(context, nearby.cells_, cells, "cells of vertices"));
    VKMESH_CHECK(fill(context, nearby.near_.offsets, near_offsets, "near offsets"));
    VKMESH_CHECK(fill(context, nearby.near_.ends, near_ends, "near ranges"));
    VKMESH_CHECK(fill(context, nearby.far_.offsets, far_offsets, "far offsets"));
    VKMESH_CHECK(fill(context, nearby.far_.ends, far_ends, "far ranges"));
    const auto make = [&](Buffer& buffer, std::uint64_t bytes, const char* name) -> Result<void> {
      VKMESH_TRY(buffer, Buffer::create(context, bytes, BufferMemory::kDevice, name));
      return {};
    };
    VKMESH_CHECK(make(nearby.centroids_and_areas_, 16 * std::uint64_t{nearby.faces_}, "centroids and areas"));
    VKMESH_CHECK(make(nearby.normals_, 12 * std::uint64_t{nearby.faces_}, "mollified normals"));
    VKMESH_CHECK(
        make(nearby.mollified_, 12 * std::uint64_t{nearby.vertices_of_mesh_}, "mollified positions"));
    return nearby;
  });
}

Result<void> record_bilateral_smoothing(Recorder& recorder, DeviceMesh& mesh, const NearbyFaces& nearby) {
  if (!mesh.passes().bilateral_smoothing)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass bilateral_smoothing");
  if (nearby.vertices_of_mesh_ != mesh.vertex_count() || nearby.faces_ != mesh.face_count())
    return fail(ErrorCode::kUsage, "the nearby faces are those of another mesh");
  if (nearby.faces_ == 0) return {};
  VKMESH_TRY(const Kernel* faces, Kernel::get(recorder.context(), shaders::bilateral_faces));
  VKMESH_TRY(const Kernel* mollify, Kernel::get(recorder.context(), shaders::bilateral_mollify));
  VKMESH_TRY(const Kernel* normals, Kernel::get(recorder.context(), shaders::bilateral_normals));
  VKMESH_TRY(const Kernel* move, Kernel::get(recorder.context(), shaders::bilateral_move));

  kernels::BilateralFacesParams of_faces{};
  of_faces.positions = mesh.positions().address();
  of_faces.corners = mesh.corners().address();
  of_faces.face_order = nearby.face_order_.address();
  of_faces.faces = nearby.centroids_and_areas_.address();
  of_faces.spatial = nearby.options_.spatial;
  VKMESH_CHECK(recorder.dispatch(*faces, of_faces, nearby.faces_,
                                 {&mesh.positions(), &mesh.corners(), &nearby.face_order_},
                                 {&nearby.centroids_and_areas_}));

  kernels::BilateralSumParams sum{};
  sum.positions = mesh.positions().address();
  sum.vertex_order = nearby.vertex_order_.address();
  sum.cells = nearby.cells_.address();
  sum.faces = nearby.centroids_and_areas_.address();
  sum.normals = nearby.normals_.address();
  sum.spatial = nearby.options_.spatial;
  sum.per_spatial = reciprocal(nearby.options_.spatial);
  sum.spatial_over_influence = nearby.options_.spatial * reciprocal(nearby.options_.influence);
  sum.range_offsets = nearby.near_.offsets.address();
  sum.ranges = nearby.near_.ends.address();
  sum.target = nearby.mollified_.address();
  VKMESH_CHECK(recorder.dispatch(*mollify, sum, nearby.vertices_,
                                 {&mesh.positions(), &nearby.vertex_order_, &nearby.cells_,
                                  &nearby.near_.offsets, &nearby.near_.ends, &nearby.centroids_and_areas_},
                                 {&nearby.mollified_}));

  kernels::BilateralNormalsParams of_mollified{};
  of_mollified.mollified = nearby.mollified_.address();
  of_mollified.corners = mesh.corners().address();
  of_mollified.face_order = nearby.face_order_.address();
  of_mollified.normals = nearby.normals_.address();
  VKMESH_CHECK(recorder.dispatch(*normals, of_mollified, nearby.faces_,
                                 {&nearby.mollified_, &mesh.corners(), &nearby.face_order_},
                                 {&nearby.normals_}));

  sum.range_offsets = nearby.far_.offsets.address();
  sum.ranges = nearby.far_.ends.address();
  sum.target = mesh.positions().address();
  return recorder.dispatch(*move, sum, nearby.vertices_,
                           {&mesh.positions(), &nearby.vertex_order_, &nearby.cells_, &nearby.far_.offsets,
                            &nearby.far_.ends, &nearby.centroids_and_areas_, &nearby.normals_},
                           {&mesh.positions()});
}

}  // namespace vkmesh
