#include <array>
#include <atomic>
#include <cmath>
#include <string>

#include <vkmesh/passes/bilateral_smoothing.h>

#include "catching.h"
#include "parallel.h"
#include "passes/bilateral_blocks.h"
#include "passes/blocks.h"
#include "passes/pass_input.h"
#include "passes/point_grid.h"

namespace vkmesh {
namespace {

using detail::kBilateralLanes;
using detail::NearFaces;

constexpr float kLeast = 0x1p-40f, kMost = 0x1p40f;

Result<void> require_options(const BilateralSmoothingOptions& options) {
  for (const auto& [value, name] :
       {std::pair{options.spatial, "spatial"}, std::pair{options.influence, "influence"}})
    if (!(value >= kLeast && value <= kMost))
      return fail(ErrorCode::kUsage, std::string("the width '") + name + "' must lie in [2^-40, 2^40], not " +
                                         std::to_string(value));
  return {};
}

// The faces as the sums take them, in the order of a grid.
struct Faces {
  std::vector<Vec3> centroids, areas;
};

Faces faces_of(std::span<const std::uint32_t> corners, std::span<const Vec3> p) {
  Faces faces;
  faces.centroids.resize(corners.size() / 3);
  faces.areas.resize(corners.size() / 3);
  const float third = reciprocal(3.0f);
  detail::parallel_ranges(faces.areas.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Vec3 a = p[corners[3 * f]], b = p[corners[3 * f + 1]], c = p[corners[3 * f + 2]];
      faces.centroids[f] = zero_below(((a + b) + c) * third, VKMESH_TINY_COORDINATE);
      faces.areas[f] = area_vector(a, b, c);
    }
  });
  return faces;
}

// Runs one of the two sums for every vertex, all vertices of a cell at once: they look at the same faces.
template <class Sum>
Result<void> for_each_cell(const detail::PointGrid& vertices, const detail::PointGrid& faces,
                           std::uint64_t reach, const NearFaces& ordered, std::span<const Vec3> positions,
                           float squared_radius, const Progress& progress, double begin, double end,
                           Sum&& sum) {
  constexpr std::size_t kChunk = 4096;
  for (std::size_t first = 0; first < vertices.cell_count(); first += kChunk) {
    const std::size_t count = std::min(kChunk, vertices.cell_count() - first);
    if (progress && !progress(begin + (end - begin) * static_cast<double>(first) /
                                          static_cast<double>(vertices.cell_count())))
      return fail(ErrorCode::kInterrupted, "smoothing was interrupted");
    detail::parallel_ranges(count, 16, [&](std::size_t from, std::size_t to) {
      NearFaces near;
      for (std::size_t cell = first + from; cell < first + to; ++cell) {
        // Faces too far from all of the cell's vertices are left out.
        Vec3 low = positions[vertices.index(vertices.cell_begin(cell))], high = low;
        for (std::size_t i = vertices.cell_begin(cell); i < vertices.cell_end(cell); ++i)
          for (int k = 0; k < 3; ++k) {
            const float x = positions[vertices.index(i)][k];
            low[k] = std::min(low[k], x);
            high[k] = std::max(high[k], x);
          }
        near.clear();
        faces.for_each_range_near(vertices.key_of_cell(cell), reach, [&](std::size_t b, std::size_t e) {
          near.append_within(ordered, b, e, low, high, squared_radius);
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
    VKMESH_CHECK(require_options(options));
    std::vector<Vec3> result(positions.size());
    VKMESH_CHECK(prepare_positions(positions, result));
    const std::vector<Vec3> p = result;
    if (mesh.face_count() == 0) return result;

    Vec3 low = p[mesh.origins()[0]], high = low;
    std::vector<std::uint32_t> used;
    std::vector<Vec3> used_positions;
    for (std::uint32_t v = 0; v < p.size(); ++v) {
      if (mesh.is_isolated(VertexId(v))) continue;
      used.push_back(v);
      used_positions.push_back(p[v]);
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[v][k]);
        high[k] = std::max(high[k], p[v][k]);
      }
    }
    for (int k = 0; k < 3; ++k)
      if (!(high[k] - low[k] <= 0x1p20f * options.spatial))
        return fail(ErrorCode::kUnsuitable,
                    "the mesh is more than 2^20 times as wide as the spatial width of the smoothing");

    // Cells a little wider than σ_f, so that what lies within 2 σ_f is at most two cells away, rounding and
    // all.
    const float per_unit = reciprocal(options.spatial);
    const float cells_per_unit = 0.998f * per_unit;
    const Faces faces = faces_of(mesh.origins(), p);
    // A centroid may lie below the smallest vertex by a rounding.
    for (const Vec3& c : faces.centroids)
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], c[k]);
    const detail::PointGrid face_grid(faces.centroids, low, cells_per_unit);
    const detail::PointGrid vertex_grid(used_positions, low, cells_per_unit);
    NearFaces ordered;
    for (std::size_t i = 0; i < mesh.face_count(); ++i) {
      const std::uint32_t f = face_grid.index(i);
      const float area = bounded_quotient(vector_length(faces.areas[f]), options.spatial * options.spatial,
                                          0x1p40f, 0x1p-40f);
      ordered.append(faces.centroids[f], Vec3(0.0f), area);
    }

    // First the mollified mesh, for its normals.
    std::vector<Vec3> mollified = p;
    const float radius = options.spatial;
    VKMESH_CHECK(for_each_cell(vertex_grid, face_grid, 1, ordered, used_positions, 1.01f * (radius * radius),
                               progress, 0.0, 0.25,
                               [&](const NearFaces& near, std::size_t begin, std::size_t end) {
                                 std::array<Vec3, kBilateralLanes> at{};
                                 for (std::size_t i = begin; i < end; ++i)
                                   at[i - begin] = used_positions[vertex_grid.index(i)];
                                 detail::mollify(near, at, options.spatial, per_unit);
                                 for (std::size_t i = begin; i < end; ++i)
                                   mollified[used[vertex_grid.index(i)]] = at[i - begin];
                               }));
    std::vector<Vec3> normals = faces_of(mesh.origins(), mollified).areas;
    detail::to_unit_vectors(normals);
    for (std::size_t i = 0; i < mesh.face_count(); ++i) ordered.set_normal(i, normals[face_grid.index(i)]);

    const detail::BilateralWidths widths{options.spatial, per_unit,
                                         options.spatial * reciprocal(options.influence)};
    VKMESH_CHECK(for_each_cell(vertex_grid, face_grid, 2, ordered, used_positions, 4.04f * (radius * radius),
                               progress, 0.25, 1.0,
                               [&](const NearFaces& near, std::size_t begin, std::size_t end) {
                                 std::array<Vec3, kBilateralLanes> at{};
                                 for (std::size_t i = begin; i < end; ++i)
                                   at[i - begin] = used_positions[vertex_grid.index(i)];
                                 detail::move_to_predictions(near, at, widths);
                                 for (std::size_t i = begin; i < end; ++i)
                                   result[used[vertex_grid.index(i)]] = at[i - begin];
                               }));
    return result;
  });
}

}  // namespace vkmesh
