// Nearest neighbours among points.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <vkmesh/math/bounds.h>
#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// A k-d tree (J. L. Bentley, "Multidimensional binary search trees used for associative searching", 1975)
/// over borrowed points: a node is a range of `order_`, split at its middle along the longest side of its
/// box. O(n log n) to build.
class KdTree {
 public:
  explicit KdTree(std::span<const Vec3> points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), std::uint32_t{0});
    axes_.resize(points.size());
    build(0, order_.size());
  }

  /// The squared distance from a point to its k-th nearest other point, or to the farthest where there are
  /// fewer. `heap` is scratch. O(k log n) for points that are spread evenly.
  float kth_squared_distance(std::uint32_t point, std::size_t k, std::vector<float>& heap) const {
    heap.clear();
    search(0, order_.size(), point, k, heap);
    return heap.empty() ? 0.0f : heap.front();
  }

 private:
  void build(std::size_t begin, std::size_t end) {
    if (end - begin < 2) return;
    Bounds bounds;
    for (std::size_t i = begin; i < end; ++i) bounds.add(points_[order_[i]]);
    const int axis = bounds.longest_axis();
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    axes_[middle] = static_cast<std::uint8_t>(axis);
    build(begin, middle);
    build(middle + 1, end);
  }

  void search(std::size_t begin, std::size_t end, std::uint32_t point, std::size_t k,
              std::vector<float>& heap) const {
    if (begin == end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Vec3 away = points_[point] - points_[order_[middle]];
    if (order_[middle] != point) {
      const float distance = away.x * away.x + away.y * away.y + away.z * away.z;
      if (heap.size() < k || distance < heap.front()) {
        if (heap.size() == k) {
          std::pop_heap(heap.begin(), heap.end());
          heap.pop_back();
        }
        heap.push_back(distance);
        std::push_heap(heap.begin(), heap.end());
      }
    }
    const float across = away[axes_[middle]];
    const bool lower = across < 0.0f;
    if (lower) {
      search(begin, middle, point, k, heap);
    } else {
      search(middle + 1, end, point, k, heap);
    }
    if (heap.size() == k && across * across > heap.front()) return;
    if (lower) {
      search(middle + 1, end, point, k, heap);
    } else {
      search(begin, middle, point, k, heap);
    }
  }

  std::span<const Vec3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axes_;  ///< The split axis of the node whose middle lies at this place.
};

}  // namespace vkmesh::detail
