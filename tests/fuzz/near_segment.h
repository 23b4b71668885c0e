// Whether vertices of a triangulation lie on the segment of a constraint.
#pragma once

#include <algorithm>
#include <cmath>

#include <vkmesh/math/vec.h>

namespace vkmesh::fuzz {

/// Beside the segment, and between its ends, but for rounding; among the least numbers that is all there is.
inline bool is_near_segment(DVec2 point, DVec2 from, DVec2 to) {
  const double size = std::max({std::fabs(from.x), std::fabs(from.y), std::fabs(to.x), std::fabs(to.y)});
  if (point == from || point == to || size < 0x1p-900) return true;
  const DVec2 whole = to / size - from / size, part = point / size - from / size;
  const double length = std::hypot(whole.x, whole.y);
  const double along = (whole.x * part.x + whole.y * part.y) / length;
  return std::fabs(whole.x * part.y - whole.y * part.x) <= 1e-11 * length && along >= -1e-11 &&
         along <= length + 1e-11;
}

}  // namespace vkmesh::fuzz
