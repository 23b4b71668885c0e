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
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/mesh/handles.h>
#include <vkmesh/repair/weld.h>
#include <vkmesh/spatial/point_grid.h>

#include "base/disjoint_sets.h"
#include "base/distinct_rows.h"
#include "repair/weld_boundary.h"

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

  /// Errors: kInterrupted.
  Result<void> unite(detail::Stop* stop) {
    for (std::size_t c = 0; c < cells_.points.cell_count(); ++c) {
      if (stop != nullptr && c % kBetween == 0) VKMESH_CHECK(stop->go_on());
      if (cells_.within_tolerance)
        for (std::size_t i = first(c) + 1; i < last(c); ++i) sets_.unite(point(first(c)), point(i));
      else
        compare(c, c);
    }
    // Half of the neighbours: the other half sees this cell.
    for (std::uint32_t dx = 0; dx <= kReach; ++dx)
      for (std::uint32_t dy = 0; dy <= 2 * kReach; ++dy)
        if (dx > 0 || dy >= kReach) VKMESH_CHECK(sweep(dx, dy, stop));
    return {};
  }

 private:
  /// Cells further apart than this along an axis are further apart than the tolerance.
  static constexpr std::uint32_t kReach = 2;
  static constexpr std::size_t kBetween = std::size_t{1} << 14;  // cells from one question to the next
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
  Result<void> sweep(std::uint32_t dx, std::uint32_t dy, detail::Stop* stop) {
    const std::size_t cells = cells_.points.cell_count();
    std::size_t from = 0;
    for (std::size_t c = 0; c < cells; ++c) {
      if (stop != nullptr && c % kBetween == 0) VKMESH_CHECK(stop->go_on());
      const Cell& here = cells_.points.key_of_cell(c);
      const Cell least = {here[0] + dx, here[1] + dy - kReach, here[2] - kReach};
      const Cell greatest = {least[0], least[1], here[2] + kReach};
      while (from < cells && cells_.points.key_of_cell(from) < least) ++from;
      for (std::size_t n = from; n < cells && cells_.points.key_of_cell(n) <= greatest; ++n)
        if (n > c) compare(c, n);
    }
    return {};
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
Result<std::vector<Vec3>> move_together(const std::vector<Vec3>& distinct, double tolerance,
                                        double& largest_move, detail::Stop* stop) {
  std::vector<Vec3> moved = distinct;
  detail::DisjointSets sets(distinct.size());
  VKMESH_CHECK(NearPoints(distinct, tolerance, sets).unite(stop));
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

/// Which points an edge without a partner uses.
std::vector<bool> on_boundary(const IndexedFaceSet& mesh, std::span<const std::uint32_t> twin) {
  std::vector<bool> found(mesh.points.size());
  for (std::size_t f = 0, h = 0; f < mesh.face_count(); ++f) {
    const std::span<const std::uint32_t> face = mesh.face(f);
    for (std::size_t k = 0; k < face.size(); ++k, ++h)
      if (twin[h] == kInvalid) found[face[k]] = found[face[k + 1 == face.size() ? 0 : k + 1]] = true;
  }
  return found;
}

/// Gives points at equal places one number; `apart(p)` says that a point keeps one of its own. Errors:
/// kInterrupted.
template <class Apart>
Result<std::vector<std::uint32_t>> number_places(std::span<const Vec3> points, std::vector<Vec3>& distinct,
                                                 Apart&& apart, detail::Stop* stop) {
  constexpr std::size_t kBetween = std::size_t{1} << 14;  // points from one question to the next
  std::vector<std::uint32_t> point_of(points.size()), number_of_row;
  std::vector<Vec3> rows;
  detail::DistinctRows<3> places;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (stop != nullptr && p % kBetween == 0) VKMESH_CHECK(stop->go_on());
    const auto next = static_cast<std::uint32_t>(distinct.size());
    point_of[p] = next;
    if (!apart(p)) {
      const std::uint32_t row = places.number(&points[p][0], rows);
      if (row == number_of_row.size()) number_of_row.push_back(next);
      point_of[p] = number_of_row[row];
    }
    if (point_of[p] == next) distinct.push_back(points[p]);
  }
  return point_of;
}

Result<void> check_points(const IndexedFaceSet& mesh) {
  if (mesh.points.size() >= kInvalid)
    return fail(ErrorCode::kUnsuitable, "the mesh has more than 2^32 - 2 points");
  for (const std::uint32_t c : mesh.corners)
    if (c >= mesh.points.size())
      return fail(ErrorCode::kUsage, "a face names point " + std::to_string(c) + ", but there are " +
                                         std::to_string(mesh.points.size()) + " points");
  for (const Vec3& p : mesh.points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return fail(ErrorCode::kUsage, "a point has a coordinate that is not finite");
  return {};
}

/// Makes the points of `distinct` those of the mesh, and channels in which points differ those of corners.
Welded merge(const IndexedFaceSet& mesh, std::vector<std::uint32_t> point_of, std::vector<Vec3> distinct) {
  Welded result;
  result.point_of = std::move(point_of);
  result.merged_points = mesh.points.size() - distinct.size();
  if (result.merged_points == 0) return result;

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

Result<Welded> weld_points(const IndexedFaceSet& mesh, const WeldOptions& options, detail::Stop* stop) {
  if (!(options.tolerance.value >= 0) || !std::isfinite(options.tolerance.value))
    return fail(ErrorCode::kUsage, "the tolerance of welding must be a finite number that is not negative");
  VKMESH_CHECK(check_points(mesh));
  const double tolerance = options.tolerance.in_units(bounds_of(mesh.points).diagonal());
  const auto none = [](std::size_t) { return false; };
  std::vector<Vec3> distinct;
  VKMESH_TRY(std::vector<std::uint32_t> point_of, number_places(mesh.points, distinct, none, stop));
  double largest_move = 0;
  if (tolerance > 0 && !distinct.empty()) {
    VKMESH_TRY(const std::vector<Vec3> moved, move_together(distinct, tolerance, largest_move, stop));
    distinct.clear();
    VKMESH_TRY(const std::vector<std::uint32_t> number, number_places(moved, distinct, none, stop));
    for (std::uint32_t& p : point_of) p = number[p];
  }
  Welded result = merge(mesh, std::move(point_of), std::move(distinct));
  result.largest_move = largest_move;
  if (result.merged_points == 0) result.mesh = mesh;
  return result;
}

/// Corners by their point and the bytes of their values: those that are one copy of the point are equal.
class CornerCopies {
 public:
  CornerCopies(std::span<const std::uint32_t> corners, std::span<const Channel> channels)
      : corners_(corners) {
    for (const Channel& channel : channels)
      std::visit(
          [&](const auto& values) {
            columns_.push_back({reinterpret_cast<const unsigned char*>(values.data()),
                                channel.components * sizeof(values[0])});
          },
          channel.values);
  }

  [[nodiscard]] std::size_t operator()(std::uint32_t corner) const {
    std::uint64_t hash = corners_[corner];
    for (const Column& column : columns_)
      for (std::size_t i = 0; i < column.bytes; ++i)
        hash = (hash ^ column.values[corner * column.bytes + i]) * 0x100000001b3u;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
  [[nodiscard]] bool operator()(std::uint32_t a, std::uint32_t b) const {
    return corners_[a] == corners_[b] && std::ranges::all_of(columns_, [&](const Column& column) {
             return std::memcmp(column.values + a * column.bytes, column.values + b * column.bytes,
                                column.bytes) == 0;
           });
  }

 private:
  struct Column {
    const unsigned char* values;
    std::size_t bytes;  // of one corner
  };
  std::span<const std::uint32_t> corners_;
  std::vector<Column> columns_;
};

/// The values of the first corner of each copy; 0 where it has none.
Channel of_copies(const Channel& channel, std::span<const std::uint32_t> corner_of_copy) {
  return std::visit(
      [&](const auto& values) -> Channel {
        std::remove_cvref_t<decltype(values)> made(corner_of_copy.size() * channel.components);
        for (std::size_t copy = 0; copy < corner_of_copy.size(); ++copy)
          if (corner_of_copy[copy] != kInvalid)
            std::copy_n(&values[std::size_t{corner_of_copy[copy]} * channel.components], channel.components,
                        &made[copy * channel.components]);
        return {channel.name, channel.components, std::move(made), channel.labels};
      },
      channel.values);
}

Result<IndexedFaceSet> split(IndexedFaceSet mesh, std::span<const std::string> names) {
  const std::size_t corners = mesh.corners.size(), points = mesh.points.size();
  if (corners >= kInvalid) return fail(ErrorCode::kUnsuitable, "the mesh has more than 2^32 - 2 corners");
  for (const std::uint32_t c : mesh.corners)
    if (c >= points)
      return fail(ErrorCode::kUsage, "a face names point " + std::to_string(c) + ", but there are " +
                                         std::to_string(points) + " points");
  std::vector<Channel> moved;
  for (const std::string& name : names)
    if (const auto it = std::ranges::find(mesh.corner_channels, name, &Channel::name);
        it != mesh.corner_channels.end()) {
      moved.push_back(std::move(*it));
      mesh.corner_channels.erase(it);
    }
  if (moved.empty()) return mesh;

  // The first corner of each copy stands for it; copies count up within their point.
  const CornerCopies equal(mesh.corners, moved);
  std::unordered_set<std::uint32_t, CornerCopies, CornerCopies> firsts(points, equal, equal);
  std::vector<std::uint32_t> first_of(corners), copy_of(corners), begin(points + 1);
  for (std::uint32_t c = 0; c < corners; ++c) {
    const auto [it, is_new] = firsts.insert(c);
    first_of[c] = *it;
    copy_of[c] = is_new ? begin[mesh.corners[c] + 1]++ : copy_of[*it];
  }
  std::uint64_t copies = 0;
  for (std::size_t p = 0; p < points; ++p) {
    const std::uint32_t here = std::max(begin[p + 1], 1u);  // a point of no face stays
    copies += here;
    if (copies >= kInvalid) return fail(ErrorCode::kUnsuitable, "the mesh has more than 2^32 - 2 points");
    begin[p + 1] = static_cast<std::uint32_t>(copies);
  }
  std::vector<std::uint32_t> point_of_copy(begin.back()), corner_of_copy(begin.back(), kInvalid);
  for (std::uint32_t p = 0; p < points; ++p)
    std::fill(point_of_copy.begin() + begin[p], point_of_copy.begin() + begin[p + 1], p);
  for (std::uint32_t c = 0; c < corners; ++c) {
    const std::uint32_t copy = begin[mesh.corners[c]] + copy_of[c];
    corner_of_copy[copy] = first_of[c];
    copy_of[c] = copy;
  }
  std::vector<Vec3> positions;
  positions.reserve(point_of_copy.size());
  for (const std::uint32_t p : point_of_copy) positions.push_back(mesh.points[p]);
  mesh.points = std::move(positions);
  mesh.point_channels = gather(mesh.point_channels, point_of_copy);
  for (const Channel& channel : moved) set_channel(mesh.point_channels, of_copies(channel, corner_of_copy));
  mesh.corners = std::move(copy_of);
  return mesh;
}

}  // namespace

Result<Welded> detail::weld_boundary(const IndexedFaceSet& mesh, std::span<const std::uint32_t> twin,
                                     Stop* stop) {
  return catching([&]() -> Result<Welded> {
    VKMESH_CHECK(check_points(mesh));
    std::vector<bool> joins;
    if (twin.size() == mesh.corners.size()) joins = on_boundary(mesh, twin);
    std::vector<Vec3> distinct;
    const auto apart = [&](std::size_t p) { return !joins.empty() && !joins[p]; };
    VKMESH_TRY(std::vector<std::uint32_t> point_of, number_places(mesh.points, distinct, apart, stop));
    return merge(mesh, std::move(point_of), std::move(distinct));
  });
}

Result<Welded> detail::weld(const IndexedFaceSet& mesh, const WeldOptions& options, Stop* stop) {
  return catching([&] { return weld_points(mesh, options, stop); });
}

Result<Welded> weld(const IndexedFaceSet& mesh, const WeldOptions& options) {
  return detail::weld(mesh, options, nullptr);
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

Result<IndexedFaceSet> split_at_seams(IndexedFaceSet mesh, std::span<const std::string> names) {
  return detail::catching([&] { return split(std::move(mesh), names); });
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
