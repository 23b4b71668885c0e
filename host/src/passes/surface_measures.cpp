#include <algorithm>
#include <vector>

#include <vkmesh/passes/surface_measures.h>

#include "catching.h"
#include "parallel.h"
#include "passes/pass_input.h"

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

struct Frame {
  Vec3 centre{0.0f};
  float scale = 0.0f, inverse_scale = 0.0f;
};

// A power of two brings the largest extent into [1, 2).
Frame frame_of(const Bounds& bounds) {
  const Vec3 extent = bounds.high - bounds.low;
  const std::uint32_t largest =
      std::max(std::max(detail::bits(extent.x), detail::bits(extent.y)), detail::bits(extent.z)) &
      0x7f800000u;
  return {bounds.low + zero_below(0.5f * extent, VKMESH_TINY_COORDINATE),
          detail::from_bits(0x7f000000u - largest), detail::from_bits(largest)};
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

SurfaceMeasures to_surface_measures(const RawMeasures& raw) {
  SurfaceMeasures result;
  result.low = Vec3(raw[0], raw[1], raw[2]);
  result.high = Vec3(raw[3], raw[4], raw[5]);
  const Frame frame = frame_of({result.low, result.high});
  const double unit = frame.inverse_scale, twice_area = raw[6];
  result.area = 0.5 * twice_area * unit * unit;
  result.volume = double{raw[10]} / 6.0 * unit * unit * unit;
  result.centroid = DVec3(frame.centre);
  if (twice_area > 0.0) result.centroid += DVec3(raw[7], raw[8], raw[9]) * (unit / (3.0 * twice_area));
  return result;
}

Result<SurfaceMeasures> surface_measures(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<SurfaceMeasures> {
    VKMESH_CHECK(detail::require_triangles(mesh, "surface_measures"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    std::vector<Vec3> p(positions.size());
    VKMESH_CHECK(prepare_positions(positions, p));
    const Bounds bounds = bounds_of(p);
    const Frame frame = frame_of(bounds);
    const auto corners = mesh.origins();
    const auto scaled = [&](std::size_t h) {
      return zero_below((p[corners[h]] - frame.centre) * frame.scale, VKMESH_TINY_DIRECTION);
    };
    std::vector<Sums> level = by_blocks<Sums>(mesh.face_count(), [&](std::size_t begin, std::size_t end) {
      Sums sum;
      for (std::size_t f = begin; f < end; ++f) {
        const Sums s = measures_of(scaled(3 * f), scaled(3 * f + 1), scaled(3 * f + 2));
        sum.twice_area += s.twice_area;
        sum.moment += s.moment;
        sum.six_volumes += s.six_volumes;
      }
      return sum;
    });
    while (level.size() > 1)
      level = by_blocks<Sums>(level.size(), [&](std::size_t begin, std::size_t end) {
        Sums sum;
        for (std::size_t i = begin; i < end; ++i) {
          sum.twice_area += level[i].twice_area;
          sum.moment += level[i].moment;
          sum.six_volumes += level[i].six_volumes;
        }
        return sum;
      });
    const Sums sum = level.empty() ? Sums{} : level[0];
    return to_surface_measures({bounds.low.x, bounds.low.y, bounds.low.z, bounds.high.x, bounds.high.y,
                                bounds.high.z, sum.twice_area, sum.moment.x, sum.moment.y, sum.moment.z,
                                sum.six_volumes});
  });
}

}  // namespace vkmesh
