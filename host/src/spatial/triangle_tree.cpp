#include "spatial/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

namespace vkmesh::detail {
namespace {

constexpr std::uint32_t kLeafSize = 4;

}  // namespace

struct TriangleTree::Builder {
  std::span<const Vec3> points;
  std::span<const std::uint32_t> corners;
  std::vector<Node>& nodes;
  std::vector<Vec3> centroids;
  std::vector<std::uint32_t> order;

  [[nodiscard]] Triangle triangle(std::size_t f) const {
    return {DVec3(points[corners[3 * f]]), DVec3(points[corners[3 * f + 1]]),
            DVec3(points[corners[3 * f + 2]])};
  }

  /// The node of order[first, last) and those below it. Halving bounds the depth by 32.
  void split(std::uint32_t first, std::uint32_t last) {
    const std::size_t index = nodes.size();
    Node node{{}, first, last - first};
    Bounds middles;
    for (std::uint32_t i = first; i < last; ++i) {
      for (std::size_t k = 0; k < 3; ++k) node.bounds.add(points[corners[3 * std::size_t{order[i]} + k]]);
      middles.add(centroids[order[i]]);
    }
    nodes.push_back(node);
    if (last - first <= kLeafSize) return;
    const int axis = middles.longest_axis();
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(centroids[a][axis], a) < std::pair(centroids[b][axis], b);
                     });
    split(first, middle);
    nodes[index].first = static_cast<std::uint32_t>(nodes.size());
    nodes[index].count = 0;
    split(middle, last);
  }
};

TriangleTree::TriangleTree(std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  const std::size_t count = corners.size() / 3;
  Builder builder{points, corners, nodes_, std::vector<Vec3>(count), std::vector<std::uint32_t>(count)};
  for (std::size_t f = 0; f < count; ++f) {
    const Triangle t = builder.triangle(f);
    builder.centroids[f] = Vec3((t[0] + t[1] + t[2]) / 3.0);
  }
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  nodes_.reserve(2 * (count / kLeafSize + 1));
  builder.split(0, static_cast<std::uint32_t>(count));
  triangles_.reserve(count);
  for (const std::uint32_t f : builder.order) triangles_.push_back(builder.triangle(f));
  sources_ = std::move(builder.order);
}

double TriangleTree::nearest(const DVec3& p, std::uint32_t& hint) const {
  double best = squared_distance(p, triangles_[hint]);
  std::array<std::pair<std::uint32_t, double>, 64> stack;
  std::size_t top = 0;
  stack[top++] = {0, nodes_[0].bounds.squared_distance(p)};
  while (top > 0) {
    const auto [n, bound] = stack[--top];
    if (bound >= best) continue;
    const Node& node = nodes_[n];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const double d = squared_distance(p, triangles_[i]);
        if (d < best) {
          best = d;
          hint = i;
        }
      }
      continue;
    }
    std::pair nearer{n + 1, nodes_[n + 1].bounds.squared_distance(p)};
    std::pair farther{node.first, nodes_[node.first].bounds.squared_distance(p)};
    if (farther.second < nearer.second) std::swap(nearer, farther);
    stack[top++] = farther;
    stack[top++] = nearer;
  }
  return best;
}

}  // namespace vkmesh::detail
