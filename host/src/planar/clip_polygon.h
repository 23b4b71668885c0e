// The convex polygon that Voronoi cells are clipped to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/math/predicates.h>

namespace vkmesh::detail {

/// Strictly convex, counter-clockwise from its lexicographically least corner; side s is from corner s to the
/// next.
struct ClipPolygon {
  std::vector<DVec2> corners;
  DVec2 low, high;
  bool is_box = false;

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(corners.size()); }
  [[nodiscard]] std::uint32_t next(std::uint32_t s) const { return s + 1 == size() ? 0 : s + 1; }

  /// Errors: kUnsuitable unless the polygon is convex.
  [[nodiscard]] static Result<ClipPolygon> of(std::span<const DVec2> polygon);
};

}  // namespace vkmesh::detail
