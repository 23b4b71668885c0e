// The nearest triangle to a point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/math/bounds.h>
#include <vkmesh/math/vec.h>

#include "math/triangle_distance.h"

namespace vkmesh::detail {

/// A bounding volume hierarchy: boxes around halves of the triangles, halved again at the median centroid
/// along the longest axis. Triangles are numbered in the order of the leaves. O(n log n) to build.
class TriangleTree {
 public:
  /// Three corners for each triangle, each < points.size().
  TriangleTree(std::span<const Vec3> points, std::span<const std::uint32_t> corners);

  [[nodiscard]] const Triangle& at(std::uint32_t i) const { return triangles_[i]; }
  /// For each triangle its number in `corners`.
  [[nodiscard]] std::span<const std::uint32_t> sources() const { return sources_; }

  /// The squared distance of p from its nearest triangle. `hint` is any triangle, best one near p; becomes
  /// the nearest.
  [[nodiscard]] double nearest(const DVec3& p, std::uint32_t& hint) const;

 private:
  struct Node {
    Bounds bounds;
    /// In a leaf the first triangle; else the second child, the first one following its parent.
    std::uint32_t first = 0;
    std::uint32_t count = 0;  ///< Triangles of a leaf, 0 in other nodes.
  };
  struct Builder;

  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> sources_;
};

}  // namespace vkmesh::detail
