#include "planar/clip_polygon.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace vkmesh::detail {
namespace {

bool is_less(DVec2 a, DVec2 b) {
  return a.x != b.x ? a.x < b.x : a.y < b.y;
}

}  // namespace

Result<ClipPolygon> ClipPolygon::of(std::span<const DVec2> polygon) {
  ClipPolygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (!std::isfinite(polygon[i].x) || !std::isfinite(polygon[i].y))
      return fail(ErrorCode::kUnsuitable,
                  "corner " + std::to_string(i) + " of the polygon to clip to is not finite");
    if (result.corners.empty() || result.corners.back() != polygon[i]) result.corners.push_back(polygon[i]);
  }
  std::vector<DVec2>& corners = result.corners;
  while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  // A convex polygon goes forward once and back once, in lexicographic order, and turns one way.
  std::vector<DVec2> kept;
  int turn = 0;
  std::size_t reversals = 0;
  bool convex = true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const DVec2 a = corners[(i + corners.size() - 1) % corners.size()], b = corners[i],
                c = corners[(i + 1) % corners.size()];
    const int side = orientation(a, b, c);
    const bool reverses = is_less(a, b) != is_less(b, c);
    reversals += reverses ? 1 : 0;
    if (side == 0) continue;
    convex = convex && side != -turn;
    turn = side;
    kept.push_back(b);
  }
  if (turn == 0) return fail(ErrorCode::kUnsuitable, "the polygon to clip to has no area");
  if (!convex || reversals != 2) return fail(ErrorCode::kUnsuitable, "the polygon to clip to is not convex");
  corners = std::move(kept);
  if (turn < 0) std::reverse(corners.begin(), corners.end());
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), is_less), corners.end());
  result.low = result.high = corners[0];
  for (const DVec2 p : corners) {
    result.low = {std::min(result.low.x, p.x), std::min(result.low.y, p.y)};
    result.high = {std::max(result.high.x, p.x), std::max(result.high.y, p.y)};
  }
  const DVec2 low = result.low, high = result.high;
  result.is_box = corners == std::vector<DVec2>{low, {high.x, low.y}, high, {low.x, high.y}};
  return result;
}

}  // namespace vkmesh::detail
