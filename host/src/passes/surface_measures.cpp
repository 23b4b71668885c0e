#include <algorithm>
#include <vector>

#include <vkmesh/passes/surface_measures.h>

#include "catching.h"
#include "parallel.h"
#include "passes/pass_input.h"
#include "passes/raw_measures.h"

namespace vkmesh {
namespace {

constexpr std::size_t kBlock = VKMESH_SUM_BLOCK;

struct Bounds {
  Vec3 low{0.0f}, high{0.0f};
};

struct Sums {
  float twice_area = 0.0f;
  Vec3 moment{0.0f};  // Six times the area's.
  float six_volumes = 0.0f;
};

// One result for each block of elements; reduce(begin, end) makes it.
template <class T, class Reduce>
std::vector<T> by_blocks(std::size_t count, Reduce&& reduce) {
  std::vector<T> results((count + kBlock - 1) / kBlock);
  detail::parallel_ranges(results.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      results[b] = reduce(kBlock * b, std::min(kBlock * (b + 1), count));
  });
  return results;
}

Bounds bounds_of(std::span<const Vec3> p) {
  if (p.empty()) return {};
  std::vector<Bounds> level(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) level[i] = {p[i], p[i]};
  do {
    level = by_blocks<Bounds>(level.size(), [&](std::size_t begin, std::size_t end) {
      Bounds all = level[begin];
      for (std::size_t i = begin + 1; i < end; ++i)
        for (int k = 0; k < 3; ++k) {
          if (level[i].low[k] < all.low[k]) all.low[k] = level[i].low[k];
          if (level[i].high[k] > all.high[k]) all.high[k] = level[i].high[k];
        }
      return all;
    });
  } while (level.size() > 1);
  return level[0];
}

Sums measures_of(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 area = area_vector(a, b, c);
  Sums s;
  s.twice_area = vector_length(area);
  s.moment = zero_below(s.twice_area * zero_below((a + b) + c, VKMESH_TINY_DIRECTION), VKMESH_TINY_AREA);
  const Vec3 parts = zero_below(Vec3(a.x * area.x, a.y * area.y, a.z * area.z), VKMESH_TINY_AREA);
  s.six_volumes = (parts.x + parts.y) + parts.z;
  return s;
}

}  // namespace

detail::MeasuresFrame detail::frame_of_bounds(Vec3 low, Vec3 high) {
  // A power of two brings the largest extent into [1, 2).
  const Vec3 extent = high - low;
  const std::uint32_t largest =
      std::max(std::max(bits(extent.x), bits(extent.y)), bits(extent.z)) & 0x7f800000u;
  return {low + zero_below(0.5f * extent, VKMESH_TINY_COORDINATE), from_bits(0x7f000000u - largest),
          from_bits(largest)};
}

SurfaceMeasures to_surface_measures(const RawMeasures& raw) {
  SurfaceMeasures result;
  result.low = Vec3(raw[0], raw[1], raw[2]);
  result.high = Vec3(raw[3], raw[4], raw[5]);
  const detail::MeasuresFrame frame = detail::frame_of_bounds(result.low, result.high);
  const double unit = frame.inverse_scale, twice_area = raw[6];
  result.area = 0.5 * twice_area * unit * unit;
  result.volume = double{raw[10]} / 6.0 * unit * unit * unit;
  result.centroid = DVec3(frame.centre);
  if (twice_area > 0.0) result.centroid += DVec3(raw[7], raw[8], raw[9]) * (unit / (3.0 * twice_area));
  return result;
}

RawMeasures detail::raw_measures(std::span<const std::uint32_t> corners, std::span<const Vec3> p) {
  const Bounds bounds = bounds_of(p);
  const MeasuresFrame frame = frame_of_bounds(bounds.low, bounds.high);
  const auto scaled = [&](std::size_t h) {
    return zero_below((p[corners[h]] - frame.centre) * frame.scale, VKMESH_TINY_DIRECTION);
  };
  const auto sum_of = [](std::size_t begin, std::size_t end, auto&& sums) {
    Sums sum;
    for (std::size_t i = begin; i < end; ++i) {
      const Sums s = sums(i);
      sum.twice_area += s.twice_area;
      sum.moment += s.moment;
      sum.six_volumes += s.six_volumes;
    }
    return sum;
  };
  std::vector<Sums> level = by_blocks<Sums>(corners.size() / 3, [&](std::size_t begin, std::size_t end) {
    return sum_of(begin, end, [&](std::size_t f) {
      return measures_of(scaled(3 * f), scaled(3 * f + 1), scaled(3 * f + 2));
    });
  });
  while (level.size() > 1)
    level = by_blocks<Sums>(level.size(), [&](std::size_t begin, std::size_t end) {
      return sum_of(begin, end, [&](std::size_t i) { return level[i]; });
    });
  const Sums sum = level.empty() ? Sums{} : level[0];
  return {bounds.low.x,   bounds.low.y, bounds.low.z, bounds.high.x, bounds.high.y,  bounds.high.z,
          sum.twice_area, sum.moment.x, sum.moment.y, sum.moment.z,  sum.six_volumes};
}

Result<SurfaceMeasures> surface_measures(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<SurfaceMeasures> {
    VKMESH_CHECK(detail::require_triangles(mesh, "surface_measures"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    std::vector<Vec3> p(positions.size());
    VKMESH_CHECK(prepare_positions(positions, p));
    return to_surface_measures(detail::raw_measures(mesh.origins(), p));
  });
}

}  // namespace vkmesh
