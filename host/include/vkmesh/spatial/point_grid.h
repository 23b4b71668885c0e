// Points in the cells of a regular grid.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <tbb/parallel_sort.h>

#include <vkmesh/math/arithmetic.h>
#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// Points ordered by the cells of a regular grid that they lie in, in ascending order in each cell.
class PointGrid {
 public:
  /// At most 2^21 − 8 cells a side.
  PointGrid(std::span<const Vec3> points, Vec3 low, float cells_per_unit)
      : low_(low), cells_per_unit_(cells_per_unit), entries_(points.size()) {
    for (std::size_t i = 0; i < points.size(); ++i)
      entries_[i] = {key_of(points[i]), static_cast<std::uint32_t>(i)};
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
  [[nodiscard]] std::uint64_t key_of_cell(std::size_t cell) const { return entries_[starts_[cell]].key; }
  /// The point that stands at a place of the order.
  [[nodiscard]] std::uint32_t index(std::size_t place) const { return entries_[place].index; }

  /// Calls f(begin, end) with ranges of places that hold, in order, all points in cells at most `reach` (1 or
  /// 2) from the cell `key` in each direction.
  template <class F>
  void for_each_range_near(std::uint64_t key, std::uint64_t reach, F&& f) const {
    // Cells of one row follow each other; keys begin at 4, so that none is crossed.
    for (std::uint64_t z = 0; z <= 2 * reach; ++z)
      for (std::uint64_t y = 0; y <= 2 * reach; ++y) {
        const std::uint64_t first = key + ((z - reach) << 42) + ((y - reach) << 21) - reach;
        const auto from = std::lower_bound(entries_.begin(), entries_.end(), first,
                                           [](const Entry& e, std::uint64_t k) { return e.key < k; });
        auto to = from;
        while (to != entries_.end() && to->key <= first + 2 * reach) ++to;
        if (from != to)
          f(static_cast<std::size_t>(from - entries_.begin()),
            static_cast<std::size_t>(to - entries_.begin()));
      }
  }

  [[nodiscard]] std::uint64_t key_of(Vec3 p) const {
    std::uint64_t key = 0;
    for (int k = 2; k >= 0; --k)
      key = key << 21 | (static_cast<std::uint64_t>((p[k] - low_[k]) * cells_per_unit_) + 4);
    return key;
  }

 private:
  struct Entry {
    std::uint64_t key = 0;
    std::uint32_t index = 0;
  };
  Vec3 low_;
  float cells_per_unit_;
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> starts_;  // The first place of each cell that holds points.
};

}  // namespace vkmesh::detail
