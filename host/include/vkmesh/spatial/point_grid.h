// Points in the cells of a regular grid.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_sort.h>

#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// Points ordered by the cells that they lie in, in ascending order in each cell. Keys name cells; cells
/// without points take no room. O(n log n) for n points.
template <class Key>
class PointsByCell {
 public:
  /// key_of(i) is the key of point i's cell.
  template <class KeyOf>
  PointsByCell(std::size_t points, KeyOf&& key_of) : entries_(points) {
    for (std::size_t i = 0; i < points; ++i) entries_[i] = {key_of(i), static_cast<std::uint32_t>(i)};
    tbb::parallel_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return a.key != b.key ? a.key < b.key : a.index < b.index;
    });
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (i == 0 || entries_[i].key != entries_[i - 1].key) starts_.push_back(static_cast<std::uint32_t>(i));
    starts_.push_back(static_cast<std::uint32_t>(entries_.size()));
  }

  [[nodiscard]] std::size_t cell_count() const { return starts_.size() - 1; }
  [[nodiscard]] std::size_t cell_begin(std::size_t cell) const { return starts_[cell]; }
  [[nodiscard]] std::size_t cell_end(std::size_t cell) const { return starts_[cell + 1]; }
  [[nodiscard]] const Key& key_of_cell(std::size_t cell) const { return entries_[starts_[cell]].key; }
  /// The point that stands at a place of the order.
  [[nodiscard]] std::uint32_t index(std::size_t place) const { return entries_[place].index; }

  /// The places [begin, end) of the points in cells with keys from `first` to `last`, both included.
  [[nodiscard]] std::pair<std::size_t, std::size_t> places(const Key& first, const Key& last) const {
    const auto from = std::lower_bound(entries_.begin(), entries_.end(), first,
                                       [](const Entry& e, const Key& k) { return e.key < k; });
    auto to = from;
    while (to != entries_.end() && to->key <= last) ++to;
    return {static_cast<std::size_t>(from - entries_.begin()),
            static_cast<std::size_t>(to - entries_.begin())};
  }

 private:
  struct Entry {
    Key key{};
    std::uint32_t index = 0;
  };
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> starts_;  // The first place of each cell that holds points, and their number.
};

/// Points in a grid of at most 2^21 − 8 cells a side, 21 bits of the key for each coordinate.
class PointGrid : public PointsByCell<std::uint64_t> {
 public:
  PointGrid(std::span<const Vec3> points, Vec3 low, float cells_per_unit)
      : PointsByCell(points.size(), [&](std::size_t i) { return key_of(points[i], low, cells_per_unit); }) {}

  /// Calls f(begin, end) with ranges of places that hold, in order, all points in cells at most `reach` (1 or
  /// 2) from the cell `key` in each direction.
  template <class F>
  void for_each_range_near(std::uint64_t key, std::uint64_t reach, F&& f) const {
    // Cells of one row follow each other; keys begin at 4, so that none is crossed.
    for (std::uint64_t z = 0; z <= 2 * reach; ++z)
      for (std::uint64_t y = 0; y <= 2 * reach; ++y) {
        const std::uint64_t first = key + ((z - reach) << 42) + ((y - reach) << 21) - reach;
        const auto [from, to] = places(first, first + 2 * reach);
        if (from != to) f(from, to);
      }
  }

 private:
  static std::uint64_t key_of(Vec3 p, Vec3 low, float cells_per_unit) {
    std::uint64_t key = 0;
    for (int k = 2; k >= 0; --k)
      key = key << 21 | (static_cast<std::uint64_t>((p[k] - low[k]) * cells_per_unit) + 4);
    return key;
  }
};

}  // namespace vkmesh::detail
