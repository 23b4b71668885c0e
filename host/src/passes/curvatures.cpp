#include <algorithm>
#include <array>

#include <vkmesh/passes/curvatures.h>

#include "catching.h"
#include "parallel.h"
#include "passes/blocks.h"
#include "passes/clones.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// Vertices taken together: few enough to stay in the cache, many enough to fill vector registers.
constexpr std::uint32_t kBlock = 128;

float squared_distance(Vec3 a, Vec3 b) {
  return squared_length(zero_below(b - a, VKMESH_TINY_LENGTH));
}

// What the triangles around some vertices give to these.
struct Shares {
  std::vector<Vec3> area_vectors;
  std::vector<float> angles;
  std::vector<float> areas;  // Eight times.
};

VKMESH_CLONES void measure(const detail::Fans& fans, Vec3* __restrict area_vectors, float* __restrict angles,
                           float* __restrict areas) {
  const Vec3 *here = fans.here.data(), *around = fans.around.data();
  const float *at_q = fans.at_q.data(), *at_r = fans.at_r.data();
  for (std::size_t t = 0, size = fans.size(); t < size; ++t) {
    const Vec3 normal = area_vector(here[t], around[t], around[t + 1]);
    const float twice_area = vector_length(normal);
    const float product = corner_product(here[t], around[t], around[t + 1]);
    const float voronoi = zero_below(squared_distance(here[t], around[t]) * at_r[t], VKMESH_TINY_AREA) +
                          zero_below(squared_distance(here[t], around[t + 1]) * at_q[t], VKMESH_TINY_AREA);
    const bool obtuse_elsewhere = std::min(at_q[t], at_r[t]) < 0.0f;
    area_vectors[t] = {normal.x, normal.y, normal.z};  // As a whole it would not fill vector registers.
    angles[t] = corner_angle(product, twice_area);
    areas[t] = product < 0.0f ? 2.0f * twice_area : (obtuse_elsewhere ? twice_area : voronoi);
  }
}

// What the triangles around each vertex of a block add up to.
struct Sums {
  std::array<Vec3, kBlock> laplacian, normal;
  std::array<float, kBlock> angles, area;
  std::array<std::uint32_t, kBlock> open;

  void set(std::size_t i, bool is_open) {
    laplacian[i] = normal[i] = Vec3(0.0f);
    angles[i] = area[i] = 0.0f;
    open[i] = is_open ? 1 : 0;
  }

  // Of one vertex; its triangles are [first, end), the last of which is none where it is open.
  void add_up(std::size_t i, const detail::Fans& fans, const Shares& shares, std::size_t first,
              std::size_t end) {
    const Vec3 here = fans.here[first];
    const std::size_t triangles_end = open[i] != 0 ? end - 1 : end;
    Vec3 to_neighbours(0.0f), area_vectors(0.0f);
    float before = open[i] != 0 ? 0.0f : fans.at_q[end - 1];
    for (std::size_t t = first; t < end; ++t) {
      const float after = t < triangles_end ? fans.at_r[t] : 0.0f;
      const float weight = zero_below(before + after, VKMESH_TINY_DIRECTION);
      to_neighbours += weight * zero_below(here - fans.around[t], VKMESH_TINY_LENGTH);
      before = fans.at_q[t];
    }
    for (std::size_t t = first; t < triangles_end; ++t) {
      area_vectors += shares.area_vectors[t];
      angles[i] += shares.angles[t];
      area[i] += shares.areas[t];
    }
    laplacian[i] = to_neighbours, normal[i] = area_vectors;
  }
};

VKMESH_CLONES void conclude(const Sums& sums, std::size_t count, VertexCurvature* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool open = sums.open[i] != 0;
    const float whole = open ? 1.0f : 2.0f;
    const float defect =
        (whole * (2.0f * VKMESH_HALF_PI_HIGH) - sums.angles[i]) + whole * (2.0f * VKMESH_HALF_PI_LOW);
    const float area = 0.125f * sums.area[i];
    const Vec3 a = unit_vector(sums.laplacian[i]), b = unit_vector(sums.normal[i]);
    const float along = (a.x * b.x + a.y * b.y) + a.z * b.z;
    const float size = bounded_quotient(vector_length(sums.laplacian[i]), 0.5f * sums.area[i],
                                        VKMESH_CURVATURE_BOUND, VKMESH_CURVATURE_BOUND_INVERSE);
    const float gaussian =
        bounded_quotient(defect, area, VKMESH_CURVATURE_BOUND, VKMESH_CURVATURE_BOUND_INVERSE);
    out[i].mean = open ? 0.0f : (along < 0.0f ? -size : size);
    out[i].gaussian = open ? 0.0f : gaussian;
    out[i].angle_defect = defect;
    out[i].area = area;
  }
}

}  // namespace

Result<std::vector<VertexCurvature>> curvatures(const NodeNeighbours& neighbours,
                                                std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<std::vector<VertexCurvature>> {
    VKMESH_CHECK(detail::require_positions(positions, neighbours.vertex_count()));
    std::vector<VertexCurvature> result(positions.size());
    detail::parallel_ranges(result.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
      detail::Fans fans;
      Shares shares;
      Sums sums;
      for (std::size_t first = begin; first < end; first += kBlock) {
        const auto v = static_cast<std::uint32_t>(first);
        const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(kBlock, end - first));
        fans.gather(neighbours, positions, v, v + count);
        shares.area_vectors.resize(fans.size());
        shares.angles.resize(fans.size()), shares.areas.resize(fans.size());
        measure(fans, shares.area_vectors.data(), shares.angles.data(), shares.areas.data());
        std::size_t fan = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
          const std::size_t neighbour_count = neighbours.of(VertexId(v + i)).size();
          sums.set(i, neighbours.is_boundary(VertexId(v + i)));
          if (neighbour_count > 0) sums.add_up(i, fans, shares, fan, fan + neighbour_count);
          fan += neighbour_count + 1;
        }
        conclude(sums, count, result.data() + first);
        for (std::uint32_t i = 0; i < count; ++i)
          if (neighbours.of(VertexId(v + i)).empty()) result[v + i] = {};
      }
    });
    return result;
  });
}

}  // namespace vkmesh
