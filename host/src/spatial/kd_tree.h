// Points by place: their nearest neighbours, and those in a region.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <vkmesh/math/bounds.h>
#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// A k-d tree (J. L. Bentley, "Multidimensional binary search trees used for associative searching", 1975)
/// over borrowed points. Nodes are numbered as in a heap: 1 is the root, the children of node i are 2i and
/// 2i + 1, and the last level, from first_leaf() on, holds up to kLeaf points in each node. A node is split
/// at its middle point along the longest side of its box.
template <class Point>
class KdTree {
 public:
  using Box = BasicBounds<Point>;
  using Scalar = typename Point::value_type;

  KdTree() = default;
  explicit KdTree(std::span<const Point> points) { build(points); }

  /// Takes other points. O(n log n).
  void build(std::span<const Point> points) {
    points_ = points;
    order_.resize(points.size());
    std::iota(order_.begin(), order_.end(), std::uint32_t{0});
    first_leaf_ = 1;
    while (first_leaf_ * kLeaf < points.size()) first_leaf_ *= 2;
    nodes_.assign(2 * first_leaf_, Node{});
    split(1, 0, points.size());
  }

  [[nodiscard]] std::size_t first_leaf() const { return first_leaf_; }
  /// All nodes are below it.
  [[nodiscard]] std::size_t node_bound() const { return nodes_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> points_in(std::size_t node) const {
    return std::span(order_).subspan(nodes_[node].first, nodes_[node].last - nodes_[node].first);
  }

  /// Whether hits(point) holds for any point, those in nodes for which skips(node, box) holds left out.
  template <class Skips, class Hits>
  [[nodiscard]] bool any(Skips&& skips, Hits&& hits) const {
    std::array<std::size_t, 64> open;
    std::size_t count = 0;
    open[count++] = 1;
    while (count > 0) {
      const std::size_t at = open[--count];
      if (skips(at, nodes_[at].box)) continue;
      if (at < first_leaf_) {
        open[count++] = 2 * at;
        open[count++] = 2 * at + 1;
        continue;
      }
      for (const std::uint32_t point : points_in(at))
        if (hits(point)) return true;
    }
    return false;
  }

  /// The squared distance from a point to its k-th nearest other point, or to the farthest where there are
  /// fewer; k > 0. `heap` is scratch. O(k log n) for points that are spread evenly.
  [[nodiscard]] Scalar kth_squared_distance(std::uint32_t point, std::size_t k,
                                            std::vector<Scalar>& heap) const {
    heap.clear();
    search(1, 0, point, k, heap);
    return heap.empty() ? Scalar{0} : heap.front();
  }

 private:
  static constexpr std::size_t kLeaf = 8;
  struct Node {
    Box box;
    std::uint32_t first = 0, last = 0;  ///< Its points, in order_.
  };

  void split(std::size_t at, std::size_t first, std::size_t last) {
    Node& node = nodes_[at];
    node.first = static_cast<std::uint32_t>(first);
    node.last = static_cast<std::uint32_t>(last);
    for (const std::uint32_t point : points_in(at)) node.box.add(points_[point]);
    if (at >= first_leaf_) return;
    const int axis = node.box.longest_axis();
    const std::size_t middle = first + (last - first) / 2;
    const auto place = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(place(first), place(middle), place(last),
                     [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    split(2 * at, first, middle);
    split(2 * at + 1, middle, last);
  }

  /// Rounded as that to a point is, so that none in the box is nearer.
  [[nodiscard]] Scalar squared_distance(const Point& from, const Box& box) const {
    Point away;
    for (int axis = 0; axis < 3; ++axis)
      away[axis] = std::max({box.low[axis] - from[axis], from[axis] - box.high[axis], Scalar{0}});
    return away.x * away.x + away.y * away.y + away.z * away.z;
  }

  /// `least`: the squared distance to the box of the node.
  void search(std::size_t at, Scalar least, std::uint32_t point, std::size_t k,
              std::vector<Scalar>& heap) const {
    if (heap.size() == k && least > heap.front()) return;
    const Point& from = points_[point];
    if (at < first_leaf_) {
      std::array<std::size_t, 2> child = {2 * at, 2 * at + 1};
      std::array<Scalar, 2> distance = {squared_distance(from, nodes_[child[0]].box),
                                        squared_distance(from, nodes_[child[1]].box)};
      const std::size_t near = distance[1] < distance[0] ? 1 : 0;
      search(child[near], distance[near], point, k, heap);
      search(child[1 - near], distance[1 - near], point, k, heap);
      return;
    }
    for (const std::uint32_t other : points_in(at)) {
      if (other == point) continue;
      const Point away = from - points_[other];
      const Scalar distance = away.x * away.x + away.y * away.y + away.z * away.z;
      if (heap.size() == k && !(distance < heap.front())) continue;
      if (heap.size() == k) {
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
      }
      heap.push_back(distance);
      std::push_heap(heap.begin(), heap.end());
    }
  }

  std::span<const Point> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::size_t first_leaf_ = 1;
};

}  // namespace vkmesh::detail
