#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/mesh/handles.h>
#include <vkmesh/repair/weld.h>
#include <vkmesh/spatial/point_grid.h>

#include "base/disjoint_sets.h"
#include "base/distinct_rows.h"

namespace vkmesh {
namespace {

bool before(const Vec3& a, const Vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// Unites the points that are at most `tolerance` apart.
class NearPoints {
 public:
  NearPoints(std::span<const Vec3> points, double tolerance, detail::DisjointSets& sets)
      : points_(points), tolerance_(tolerance), sets_(sets), cells_(cells_of(points, tolerance)) {}

  void unite() {
    for (std::size_t c = 0; c < cells_.points.cell_count(); ++c) {
      if (cells_.within_tolerance)
        for (std::size_t i = first(c) + 1; i < last(c); ++i) sets_.unite(point(first(c)), point(i));
      else
        compare(c, c);
    }
    // Half of the neighbours: the other half sees this cell.
    for (std::uint32_t dx = 0; dx <= kReach; ++dx)
      for (std::uint32_t dy = 0; dy <= 2 * kReach; ++dy)
        if (dx > 0 || dy >= kReach) sweep(dx, dy);
  }

 private:
  /// Cells further apart than this along an axis are further apart than the tolerance.
  static constexpr std::uint32_t kReach = 2;
  using Cell = std::array<std::uint32_t, 3>;
  struct Cells {
    detail::PointsByCell<Cell> points;
    /// Points of one cell are within the tolerance of each other, unless the tolerance is so small that such
    /// cells could not be numbered.
    bool within_tolerance;
  };

  static Cells cells_of(std::span<const Vec3> points, double tolerance) {
    const Bounds bounds = bounds_of(points);
    const DVec3 low(bounds.low), size = DVec3(bounds.high) - low;
    const double wanted = tolerance * std::numbers::inv_sqrt3 * (1 - 1e-12);
    const double side = std::max(wanted, std::ldexp(std::max({size.x, size.y, size.z}), -31));
    return {{points.size(),
             [&](std::size_t p) {
               Cell cell;
               for (int i = 0; i < 3; ++i)
                 cell[static_cast<std::size_t>(i)] =
                     static_cast<std::uint32_t>((static_cast<double>(points[p][i]) - low[i]) / side) + kReach;
               return cell;
             }},
            side == wanted};
  }

  [[nodiscard]] std::size_t first(std::size_t cell) const { return cells_.points.cell_begin(cell); }
  [[nodiscard]] std::size_t last(std::size_t cell) const { return cells_.points.cell_end(cell); }
  [[nodiscard]] std::uint32_t point(std::size_t place) const { return cells_.points.index(place); }

  /// Compares each cell with those of one column of neighbours: (x + dx, y + dy - kReach, z ± kReach). The
  /// columns ascend as the cells do, so that the place in the list only moves forward.
  void sweep(std::uint32_t dx, std::uint32_t dy) {
    const std::size_t cells = cells_.points.cell_count();
    std::size_t from = 0;
    for (std::size_t c = 0; c < cells; ++c) {
      const Cell& here = cells_.points.key_of_cell(c);
      const Cell least = {here[0] + dx, here[1] + dy - kReach, here[2] - kReach};
      const Cell greatest = {least[0], least[1], here[2] + kReach};
      while (from < cells && cells_.points.key_of_cell(from) < least) ++from;
      for (std::size_t n = from; n < cells && cells_.points.key_of_cell(n) <= greatest; ++n)
        if (n > c) compare(c, n);
    }
  }

  void compare(std::size_t c, std::size_t n) {
    // Where whole cells are one, one pair that is close unites them.
    const bool whole = cells_.within_tolerance;
    if (whole && sets_.find(point(first(c))) == sets_.find(point(first(n)))) return;
    for (std::size_t i = first(c); i < last(c); ++i)
      for (std::size_t j = n == c ? i + 1 : first(n); j < last(n); ++j) {
        const DVec3 d = DVec3(points_[point(i)]) - DVec3(points_[point(j)]);
        if (d.x * d.x + d.y * d.y + d.z * d.z > tolerance_ * tolerance_) continue;
        sets_.unite(point(i), point(j));
        if (whole) return;
      }
  }

  std::span<const Vec3> points_;
  double tolerance_;
  detail::DisjointSets& sets_;
  Cells cells_;
};

/// The numbers of distinct points, each the place of its set's lowest point.
std::vector<Vec3> move_together(const std::vector<Vec3>& distinct, double tolerance, double& largest_move) {
  std::vector<Vec3> moved = distinct;
  detail::DisjointSets sets(distinct.size());
  NearPoints(distinct, tolerance, sets).unite();
  for (std::uint32_t p = 0; p < distinct.size(); ++p) {
    Vec3& lowest = moved[sets.find(p)];
    if (before(distinct[p], lowest)) lowest = distinct[p];
  }
  for (std::uint32_t p = 0; p < distinct.size(); ++p) {
    moved[p] = moved[sets.find(p)];
    const DVec3 d = DVec3(moved[p]) - DVec3(distinct[p]);
    largest_move = std::max(largest_move, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
  }
  return moved;
}

/// Whether every point has the value of the point that stands for it.
bool agrees(const Channel& channel, std::span<const std::uint32_t> point_of,
            std::span<const std::uint32_t> first) {
  return std::visit(
      [&](const auto& values) {
        const std::size_t n = channel.components;
        for (std::size_t p = 0; p < point_of.size(); ++p) {
          const std::size_t q = first[point_of[p]];
          // As bytes: a value that is no number agrees with itself.
          if (p != q && std::memcmp(&values[p * n], &values[q * n], n * sizeof values[0]) != 0) return false;
        }
        return true;
      },
      channel.values);
}

Result<Welded> weld_points(const IndexedFaceSet& mesh, const WeldOptions& options) {
  if (!(options.tolerance.value >= 0) || !std::isfinite(options.tolerance.value))
    return fail(ErrorCode::kUsage, "the tolerance of welding must be a finite number that is not negative");
  if (mesh.points.size() >= kInvalid)
    return fail(ErrorCode::kUnsuitable, "the mesh has more than 2^32 - 2 points");
  for (const std::uint32_t c : mesh.corners)
    if (c >= mesh.points.size())
      return fail(ErrorCode::kUsage, "a face names point " + std::to_string(c) + ", but there are " +
                                         std::to_string(mesh.points.size()) + " points");
  for (const Vec3& p : mesh.points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return fail(ErrorCode::kUsage, "a point has a coordinate that is not finite");
  const double tolerance = options.tolerance.in_units(bounds_of(mesh.points).diagonal());

  Welded result;
  result.point_of.resize(mesh.points.size());
  std::vector<Vec3> distinct;
  {
    detail::DistinctRows<3> rows;
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
      result.point_of[p] = rows.number(&mesh.points[p][0], distinct);
  }
  if (tolerance > 0 && !distinct.empty()) {
    const std::vector<Vec3> moved = move_together(distinct, tolerance, result.largest_move);
    detail::DistinctRows<3> rows;
    std::vector<std::uint32_t> number(distinct.size());
    distinct.clear();
    for (std::size_t p = 0; p < moved.size(); ++p) number[p] = rows.number(&moved[p][0], distinct);
    for (std::uint32_t& p : result.point_of) p = number[p];
  }
  result.merged_points = mesh.points.size() - distinct.size();
  if (result.merged_points == 0) {
    result.mesh = mesh;
    return result;
  }

  std::vector<std::uint32_t> first(distinct.size(), kInvalid);
  for (std::uint32_t p = 0; p < result.point_of.size(); ++p)
    first[result.point_of[p]] = std::min(first[result.point_of[p]], p);
  IndexedFaceSet& out = result.mesh;
  out.points = std::move(distinct);
  out.corners.reserve(mesh.corners.size());
  for (const std::uint32_t c : mesh.corners) out.corners.push_back(result.point_of[c]);
  out.face_offsets = mesh.face_offsets;
  out.corner_channels = mesh.corner_channels;
  out.face_channels = mesh.face_channels;
  for (const Channel& channel : mesh.point_channels) {
    const bool seam = !mesh.corners.empty() && find_channel(mesh.corner_channels, channel.name) == nullptr &&
                      !agrees(channel, result.point_of, first);
    if (seam) {
      out.corner_channels.push_back(gather(channel, mesh.corners));
      result.seams.push_back(channel.name);
    } else {
      out.point_channels.push_back(gather(channel, first));
    }
  }
  return result;
}

}  // namespace

Result<Welded> weld(const IndexedFaceSet& mesh, const WeldOptions& options) {
  return detail::catching([&] { return weld_points(mesh, options); });
}

Result<IndexedFaceSet> weld(const PolygonSoup& soup) {
  return detail::catching([&]() -> Result<IndexedFaceSet> {
    if (soup.corners.size() >= kInvalid)
      return fail(ErrorCode::kUnsuitable,
                  std::to_string(soup.corners.size()) + " corners are more than 32-bit indices can number");
    IndexedFaceSet mesh;
    mesh.corners.resize(soup.corners.size());
    detail::DistinctRows<3> distinct;
    for (std::size_t c = 0; c < soup.corners.size(); ++c)
      mesh.corners[c] = distinct.number(&soup.corners[c][0], mesh.points);
    mesh.points.shrink_to_fit();
    mesh.face_offsets = soup.face_offsets;
    mesh.face_channels = soup.face_channels;
    mesh.normalize_offsets();
    return mesh;
  });
}

Result<PolygonSoup> to_polygon_soup(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<PolygonSoup> {
    PolygonSoup soup;
    soup.corners.reserve(mesh.corners.size());
    for (const std::uint32_t c : mesh.corners) {
      if (c >= mesh.points.size())
        return fail(ErrorCode::kUsage, "a face names point " + std::to_string(c) + ", but there are " +
                                           std::to_string(mesh.points.size()) + " points");
      soup.corners.push_back(mesh.points[c]);
    }
    soup.face_offsets = mesh.face_offsets;
    soup.face_channels = mesh.face_channels;
    return soup;
  });
}

}  // namespace vkmesh
