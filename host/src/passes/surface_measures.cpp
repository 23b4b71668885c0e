#include <algorithm>
#include <array>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/math/unit_frame.h>
#include <vkmesh/passes/detail/raw_measures.h>
#include <vkmesh/passes/surface_measures.h>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "passes/pass_input.h"
#include "simd/target_clones.h"

namespace vkmesh {
namespace {

constexpr std::size_t kBlock = VKMESH_SUM_BLOCK;

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

Bounds bounds_by_blocks(std::span<const Vec3> p) {
  if (p.empty()) return {Vec3(0.0f), Vec3(0.0f)};
  const std::vector<Bounds> blocks = by_blocks<Bounds>(
      p.size(), [&](std::size_t begin, std::size_t end) { return bounds_of(p.subspan(begin, end - begin)); });
  Bounds all;
  for (const Bounds& block : blocks) all += block;
  return all;
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

// The scaled corners of a block of triangles, coordinate by coordinate, and what they measure.
struct Triangles {
  using Lanes = std::array<float, kBlock>;
  std::array<Lanes, 9> corners;
  std::array<Lanes, 5> measures;

  void set(std::size_t i, std::size_t corner, Vec3 p) {
    for (std::size_t k = 0; k < 3; ++k) corners[3 * corner + k][i] = p[static_cast<int>(k)];
  }
  [[nodiscard]] Sums sums(std::size_t i) const {
    return {measures[0][i], Vec3(measures[1][i], measures[2][i], measures[3][i]), measures[4][i]};
  }
};
VKMESH_FLAT_CLONES void measure(Triangles& of) {
  const auto c = of.corners;
  Triangles::Lanes area, x, y, z, volume;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const Sums s =
        measures_of({c[0][i], c[1][i], c[2][i]}, {c[3][i], c[4][i], c[5][i]}, {c[6][i], c[7][i], c[8][i]});
    area[i] = s.twice_area;
    x[i] = s.moment.x, y[i] = s.moment.y, z[i] = s.moment.z;
    volume[i] = s.six_volumes;
  }
  of.measures = {area, x, y, z, volume};
}

}  // namespace

SurfaceMeasures to_surface_measures(const RawMeasures& raw) {
  SurfaceMeasures result;
  result.low = Vec3(raw[0], raw[1], raw[2]);
  result.high = Vec3(raw[3], raw[4], raw[5]);
  const detail::UnitFrame frame = detail::unit_frame_of({result.low, result.high});
  const double unit = frame.inverse_scale, twice_area = raw[6];
  result.area = 0.5 * twice_area * unit * unit;
  result.volume = double{raw[10]} / 6.0 * unit * unit * unit;
  result.centroid = DVec3(frame.centre);
  if (twice_area > 0.0) result.centroid += DVec3(raw[7], raw[8], raw[9]) * (unit / (3.0 * twice_area));
  return result;
}

RawMeasures detail::raw_measures(std::span<const std::uint32_t> corners, std::span<const Vec3> p) {
  const Bounds bounds = bounds_by_blocks(p);
  const UnitFrame frame = unit_frame_of(bounds);
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
    Triangles triangles{};
    for (std::size_t f = begin; f < end; ++f)
      for (std::size_t corner = 0; corner < 3; ++corner)
        triangles.set(f - begin, corner, scaled(3 * f + corner));
    measure(triangles);
    return sum_of(0, end - begin, [&](std::size_t k) { return triangles.sums(k); });
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
    std::vector<Vec3> p = detail::large_vector<Vec3>(positions.size());
    VKMESH_CHECK(prepare_positions(positions, p));
    return to_surface_measures(detail::raw_measures(mesh.origins(), p));
  });
}

}  // namespace vkmesh
