// The length that edges are to have, everywhere the same or by curvature.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "remesh/original_surface.h"

namespace vkmesh::detail {

class TargetLengths {
 public:
  /// The same everywhere.
  explicit TargetLengths(double length) : uniform_(length) {}
  /// For each vertex of the input: sqrt(6 E / k - 3 E²) for the largest curvature k there, the length of a
  /// chord that an arc of radius 1 / k leaves by E (M. Dunyach, D. Vanderhaeghe, L. Barthe, M. Botsch,
  /// "Adaptive remeshing for real-time mesh deformation", 2013), within bounds, and such that it grows by at
  /// most a half of the distance from one vertex to another. Edges that are of curves do not count as
  /// curvature. O(n log n).
  static TargetLengths by_curvature(const OriginalSurface& surface, const std::vector<bool>& is_curve,
                                    double tolerance, double least, double most);

  /// Makes lengths at these vertices of the input as short as that, but no less than a tenth of what is asked
  /// for elsewhere, and those around them as they grow. O(n log n).
  void shorten(const OriginalSurface& surface, std::span<const std::pair<std::uint32_t, double>> at);

  [[nodiscard]] bool is_uniform() const { return of_vertex_.empty(); }
  [[nodiscard]] float at(const OriginalSurface& surface, const Foot& foot) const;
  [[nodiscard]] float at_vertex(std::uint32_t v) const {
    return is_uniform() ? static_cast<float>(uniform_) : of_vertex_[v];
  }
  /// Makes all lengths longer.
  void scale(double factor);

 private:
  /// Makes lengths shorter that grow too fast.
  void grade(const OriginalSurface& surface);

  double uniform_;  // or the longest
  std::vector<float> of_vertex_;
};

}  // namespace vkmesh::detail
