// What many swaps would gain about, in lanes: which edges are worth a closer look.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <vkmesh/math/vec.h>
#include <vkmesh/optimize/swap_edges.h>

#include "optimize/swap_mesh.h"

namespace vkmesh::detail {

/// Quadrilaterals of some edges. The machine's part of SwapCosts::gain(), for kMinAngle or kAspectRatio
/// alone.
class SwapBlock {
 public:
  static constexpr std::size_t kSize = 128;

  [[nodiscard]] bool is_full() const { return count_ == kSize; }
  void add(std::span<const DVec3> points, const SwapQuad& quad) {
    edges_[count_] = quad.h;
    const std::array<std::uint32_t, 4> vertices = {quad.p, quad.q, quad.a, quad.b};
    for (std::size_t i = 0; i < 4; ++i) {
      const DVec3& point = points[vertices[i]];
      coordinates_[3 * i][count_] = point.x;
      coordinates_[3 * i + 1][count_] = point.y;
      coordinates_[3 * i + 2][count_] = point.z;
    }
    ++count_;
  }
  /// Calls f(half-edge) for the edges that may gain, in the order in which they were added, and empties the
  /// block.
  template <class F>
  void for_each_promising(SwapCost cost, F&& f) {
    // As far as rounding may be off from the whole numbers of SwapCosts, and much more.
    constexpr double kUnsure = 1e-8;
    compute(cost);
    for (std::size_t i = 0; i < count_; ++i)
      if (gains_[i] > -kUnsure) f(edges_[i]);
    count_ = 0;
  }

 private:
  void compute(SwapCost cost);

  std::size_t count_ = 0;
  std::array<std::uint32_t, kSize> edges_{};
  using Lanes = std::array<double, kSize>;
  std::array<Lanes, 12> coordinates_{};  // of p, q, a and b
  Lanes gains_{};
};

}  // namespace vkmesh::detail
