#include <array>
#include <atomic>
#include <cmath>
#include <string>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/bilateral_smoothing.h>
#include <vkmesh/passes/detail/bilateral_grid.h>

#include "base/parallel.h"
#include "math/vector_kernels.h"
#include "passes/bilateral_blocks.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

using detail::kBilateralLanes;
using detail::NearFaces;

std::vector<Vec3> areas_of(std::span<const std::uint32_t> corners, std::span<const Vec3> p) {
  std::vector<Vec3> areas(corners.size() / 3);
  detail::parallel_ranges(areas.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      areas[f] = area_vector(p[corners[3 * f]], p[corners[3 * f + 1]], p[corners[3 * f + 2]]);
  });
  return areas;
}

// Runs one of the two sums for every vertex, all vertices of a cell at once: they look at the same faces.
template <class Sum>
Result<void> for_each_cell(const detail::BilateralGrid& grid, std::uint64_t reach, const NearFaces& ordered,
                           float squared_radius, const Progress& progress, double begin, double end,
                           Sum&& sum) {
  constexpr std::size_t kChunk = 4096;
  const detail::PointGrid& vertices = grid.vertices;
  const std::span<const Vec3> positions = grid.used_positions;
  for (std::size_t first = 0; first < vertices.cell_count(); first += kChunk) {
    const std::size_t count = std::min(kChunk, vertices.cell_count() - first);
    if (progress && !progress(begin + (end - begin) * static_cast<double>(first) /
                                          static_cast<double>(vertices.cell_count())))
      return fail(ErrorCode::kInterrupted, "smoothing was interrupted");
    detail::parallel_ranges(count, 16, [&](std::size_t from, std::size_t to) {
      NearFaces near;
      for (std::size_t cell = first + from; cell < first + to; ++cell) {
        // Faces too far from all of the cell's vertices are left out.
        Bounds bounds;
        for (std::size_t i = vertices.cell_begin(cell); i < vertices.cell_end(cell); ++i)
          bounds.add(positions[vertices.index(i)]);
        near.clear();
        grid.faces.for_each_range_near(vertices.key_of_cell(cell), reach, [&](std::size_t b, std::size_t e) {
          near.append_within(ordered, b, e, bounds, squared_radius);
        });
        for (std::size_t i = vertices.cell_begin(cell); i < vertices.cell_end(cell); i += kBilateralLanes)
          sum(near, i, std::min(i + kBilateralLanes, vertices.cell_end(cell)));
      }
    });
  }
  return {};
}

}  // namespace

double mean_edge_length(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  double sum = 0.0;
  std::size_t count = 0;
  mesh.for_each_edge([&](HalfEdgeId h) {
    const DVec3 along = DVec3(positions[mesh.target(h).index]) - DVec3(positions[mesh.origin(h).index]);
    sum += std::sqrt(along.x * along.x + along.y * along.y + along.z * along.z);
    ++count;
  });
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

Result<std::vector<Vec3>> bilateral_smoothing(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                              const BilateralSmoothingOptions& options,
                                              const Progress& progress) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(detail::require_triangles(mesh, "bilateral_smoothing"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    VKMESH_CHECK(detail::require_bilateral_options(options));
    std::vector<Vec3> result(positions.size());
    VKMESH_CHECK(prepare_positions(positions, result));
    const std::vector<Vec3> p = result;
    if (mesh.face_count() == 0) return result;

    VKMESH_TRY(const detail::BilateralGrid grid, detail::bilateral_grid(mesh, p, options));
    const float per_unit = exact::reciprocal(options.spatial);
    const std::vector<Vec3> areas = areas_of(mesh.origins(), p);
    NearFaces ordered;
    for (std::size_t i = 0; i < mesh.face_count(); ++i) {
      const std::uint32_t f = grid.faces.index(i);
      const float area = bounded_quotient(vector_length(areas[f]), options.spatial * options.spatial,
                                          VKMESH_BILATERAL_AREA_BOUND, VKMESH_BILATERAL_AREA_BOUND_INVERSE);
      ordered.append(grid.centroids[f], Vec3(0.0f), area);
    }

    // First the mollified mesh, for its normals.
    std::vector<Vec3> mollified = p;
    const float radius = options.spatial;
    VKMESH_CHECK(for_each_cell(grid, 1, ordered, 1.01f * (radius * radius), progress, 0.0, 0.25,
                               [&](const NearFaces& near, std::size_t begin, std::size_t end) {
                                 std::array<Vec3, kBilateralLanes> at{};
                                 for (std::size_t i = begin; i < end; ++i)
                                   at[i - begin] = grid.used_positions[grid.vertices.index(i)];
                                 detail::mollify(near, at, options.spatial, per_unit);
                                 for (std::size_t i = begin; i < end; ++i)
                                   mollified[grid.used[grid.vertices.index(i)]] = at[i - begin];
                               }));
    std::vector<Vec3> normals = areas_of(mesh.origins(), mollified);
    detail::to_unit_vectors(normals);
    for (std::size_t i = 0; i < mesh.face_count(); ++i) ordered.set_normal(i, normals[grid.faces.index(i)]);

    const detail::BilateralWidths widths{options.spatial, per_unit,
                                         options.spatial * exact::reciprocal(options.influence)};
    VKMESH_CHECK(for_each_cell(grid, 2, ordered, 4.04f * (radius * radius), progress, 0.25, 1.0,
                               [&](const NearFaces& near, std::size_t begin, std::size_t end) {
                                 std::array<Vec3, kBilateralLanes> at{};
                                 for (std::size_t i = begin; i < end; ++i)
                                   at[i - begin] = grid.used_positions[grid.vertices.index(i)];
                                 detail::move_to_predictions(near, at, widths);
                                 for (std::size_t i = begin; i < end; ++i)
                                   result[grid.used[grid.vertices.index(i)]] = at[i - begin];
                               }));
    return result;
  });
}

}  // namespace vkmesh
