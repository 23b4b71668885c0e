#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <unordered_map>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/planar/constrained_delaunay.h>
#include <vkmesh/planar/delaunay.h>

#include "planar/constrained_triangles.h"
#include "planar/refinement.h"

namespace vkmesh {
namespace detail {
namespace {

/// Constraints, and after them the edges of outlines, by one number each.
class Segments {
 public:
  Segments(std::span<const PointPair> constraints, std::span<const PointPair> outlines)
      : constraints_(constraints), outlines_(outlines) {}

  [[nodiscard]] std::size_t size() const { return constraints_.size() + outlines_.size(); }
  [[nodiscard]] PointPair operator[](std::size_t i) const {
    return i < constraints_.size() ? constraints_[i] : outlines_[i - constraints_.size()];
  }
  [[nodiscard]] std::string name(std::size_t i) const {
    return i < constraints_.size() ? "constraint " + std::to_string(i)
                                   : "outline edge " + std::to_string(i - constraints_.size());
  }

 private:
  std::span<const PointPair> constraints_, outlines_;
};

Result<void> check(const Segments& segments, std::size_t points) {
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (const std::uint32_t point : segments[i])
      if (point >= points)
        return fail(ErrorCode::kUnsuitable, segments.name(i) + " ends at point " + std::to_string(point) +
                                                ", and there are " + std::to_string(points));
  return {};
}

Result<void> check(const DelaunayRefinement& refinement) {
  if (!(refinement.min_angle >= 0 && refinement.min_angle < std::numbers::pi / 3))
    return fail(ErrorCode::kUsage, "the least angle of a triangle is from 0 to below 60 degrees");
  if (refinement.max_area && !(*refinement.max_area > 0))
    return fail(ErrorCode::kUsage, "the largest area of a triangle is above 0");
  if (!(refinement.min_edge >= 0 && std::isfinite(refinement.min_edge)))
    return fail(ErrorCode::kUsage, "the shortest edge that refinement may make has a length from 0 on");
  return {};
}

Result<void> check_closed(std::span<const PointPair> outlines, DelaunayDomain domain,
                          const DelaunayTriangulation& made) {
  std::vector<std::int32_t> balance(made.point_of_vertex.size(), 0);
  for (const auto [from, to] : outlines) {
    ++balance[made.vertex_of_point[from]];
    balance[made.vertex_of_point[to]] += domain == DelaunayDomain::kNonZero ? -1 : 1;
  }
  std::size_t open = made.vertex_of_point.size();
  for (std::uint32_t v = 0; v < balance.size(); ++v)
    if (domain == DelaunayDomain::kNonZero ? balance[v] != 0 : balance[v] % 2 != 0)
      open = std::min<std::size_t>(open, made.point_of_vertex[v]);
  if (open == made.vertex_of_point.size()) return {};
  return fail(ErrorCode::kUnsuitable, "the outlines do not close at point " + std::to_string(open));
}

/// The first but `other` of the segments that pass through both vertices.
std::size_t segment_through(const Segments& segments, const DelaunayTriangulation& made,
                            const std::vector<DVec2>& places, const VertexPair& edge, std::size_t other) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i == other) continue;
    const DVec2 a = places[made.vertex_of_point[segments[i][0]]],
                b = places[made.vertex_of_point[segments[i][1]]];
    const bool passes = std::all_of(edge.begin(), edge.end(), [&](std::uint32_t v) {
      const DVec2 p = places[v];
      return orientation(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
             std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
    });
    if (a != b && passes) return i;
  }
  return other;
}

/// Puts all segments in, in the order of their vertices.
Result<void> insert_segments(ConstrainedTriangles& triangles, const Segments& segments,
                             const DelaunayTriangulation& made, bool split_crossings,
                             const Progress& progress) {
  struct Numbered {
    VertexPair ends;
    std::size_t number;
  };
  std::vector<Numbered> sorted;
  sorted.reserve(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto [from, to] = segments[i];
    const std::uint32_t a = made.vertex_of_point[from], b = made.vertex_of_point[to];
    sorted.push_back({{std::min(a, b), std::max(a, b)}, i});
  }
  std::sort(sorted.begin(), sorted.end(), [](const Numbered& a, const Numbered& b) {
    return a.ends != b.ends ? a.ends < b.ends : a.number < b.number;
  });
  // Each other segment crosses it once. Where they are so near that rounding makes them cross again and again
  // there is no use in going on.
  const std::size_t most_splits = split_crossings ? 1000 + 4 * segments.size() : 0;
  constexpr std::size_t kBetweenReports = 1 << 8;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (k % kBetweenReports == 0 && progress &&
        !progress(static_cast<double>(k) / static_cast<double>(sorted.size())))
      return fail(ErrorCode::kInterrupted, "cancelled");
    const auto& [ends, number] = sorted[k];
    if (k > 0 && ends == sorted[k - 1].ends) continue;
    VKMESH_TRY(const auto crossed, triangles.insert_segment(ends[0], ends[1], most_splits));
    if (!crossed) continue;
    if (split_crossings)
      return fail(ErrorCode::kUnsuitable,
                  segments.name(number) + " crosses others that lie nearer to it than rounding can split");
    const std::size_t other = segment_through(segments, made, triangles.places(), *crossed, number);
    return fail(ErrorCode::kUnsuitable, segments.name(std::min(number, other)) + " crosses " +
                                            segments.name(std::max(number, other)));
  }
  return {};
}

/// Marks triangles outside of the outlines, and those at infinity.
void mark_outside(ConstrainedTriangles& triangles, std::span<const PointPair> outlines, DelaunayDomain domain,
                  const DelaunayTriangulation& made) {
  const std::uint32_t count = triangles.triangles().count;
  const auto is_at_infinity = [&](std::uint32_t t) {
    return triangles.origin(4 * t) == kInvalid || triangles.origin(4 * t + 1) == kInvalid ||
           triangles.origin(4 * t + 2) == kInvalid;
  };
  if (domain == DelaunayDomain::kConvexHull) {
    for (std::uint32_t t = 0; t < count; ++t)
      if (is_at_infinity(t)) triangles.marks().set_outside(t);
    return;
  }
  // By how much more outlines wind around the left side of a half-edge than around its right side.
  std::unordered_map<std::uint32_t, std::int32_t> steps;
  for (const auto [from, to] : outlines) {
    const std::uint32_t a = made.vertex_of_point[from], b = made.vertex_of_point[to];
    if (a == b) continue;
    triangles.for_each_part(a, b, [&](std::uint32_t u, std::uint32_t v) {
      const std::uint32_t h = triangles.half_edge(u, v);
      ++steps[h];
      --steps[triangles.twin(h)];
    });
  }
  std::uint32_t infinite = 0;
  while (!is_at_infinity(infinite)) ++infinite;
  std::vector<std::int32_t> winding(count, 0);
  std::vector<bool> seen(count, false);
  std::vector<std::uint32_t> waiting = {infinite};
  seen[infinite] = true;
  while (!waiting.empty()) {
    const std::uint32_t t = waiting.back();
    waiting.pop_back();
    if (domain == DelaunayDomain::kNonZero ? winding[t] == 0 : winding[t] % 2 == 0)
      triangles.marks().set_outside(t);
    for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h) {
      const std::uint32_t u = triangles.twin(h), next = u >> 2;
      if (seen[next]) continue;
      seen[next] = true;
      winding[next] = winding[t];
      if (triangles.marks().kind(u) != EdgeMarks::kFree)
        if (const auto step = steps.find(u); step != steps.end()) winding[next] += step->second;
      waiting.push_back(next);
    }
  }
}

/// Makes the border of the domain fixed edges.
void fix_border(ConstrainedTriangles& triangles) {
  EdgeMarks& marks = triangles.marks();
  for (std::uint32_t t = 0; t < triangles.triangles().count; ++t) {
    if (marks.is_outside(t)) continue;
    for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h) {
      const std::uint32_t u = triangles.twin(h);
      if (!marks.is_outside(u >> 2) || marks.kind(h) != EdgeMarks::kFree) continue;
      marks.set_kind(h, EdgeMarks::kBorder);
      marks.set_kind(u, EdgeMarks::kBorder);
    }
  }
}

/// Gives each fan of triangles inside but the first of its vertex a vertex of its own.
void split_fans(PlanarTriangles& triangles, const EdgeMarks& marks, ConstrainedTriangulation& result) {
  std::vector<bool> has_fan(result.positions.size(), false);
  for (std::uint32_t t = 0; t < triangles.count; ++t) {
    if (marks.is_outside(t)) continue;
    for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h) {
      // An open fan begins beside the border.
      if (!marks.is_outside(triangles.twin(h) >> 2)) continue;
      const std::uint32_t v = triangles.origin(h);
      if (v >= has_fan.size()) continue;  // one that was made here
      if (!has_fan[v]) {
        has_fan[v] = true;
        continue;
      }
      const auto own = static_cast<std::uint32_t>(result.positions.size());
      result.positions.push_back(result.positions[v]);
      result.point_of_vertex.push_back(result.point_of_vertex[v]);
      result.added.push_back({{v, v, v}, {1, 0, 0}});
      for (std::uint32_t e = h; !marks.is_outside(e >> 2); e = triangles.twin(PlanarTriangles::previous(e)))
        triangles.origins[PlanarTriangles::slot(e)] = own;
    }
  }
}

Result<ConstrainedTriangulation> triangulate(std::span<const DVec2> points,
                                             std::span<const PointPair> constraints,
                                             const ConstrainedDelaunayOptions& options,
                                             const Progress& progress) {
  const Segments segments(constraints, options.outlines);
  VKMESH_CHECK(check(segments, points.size()));
  if (options.refinement) VKMESH_CHECK(check(*options.refinement));
  const auto part = [&](double from, double to) -> Progress {
    if (!progress) return {};
    return [&progress, from, to](double fraction) { return progress(from + (to - from) * fraction); };
  };
  VKMESH_TRY(DelaunayTriangulation made, delaunay(points, part(0, 0.5)));
  const bool has_outlines = options.domain != DelaunayDomain::kConvexHull;
  if (has_outlines) VKMESH_CHECK(check_closed(options.outlines, options.domain, made));
  ConstrainedTriangulation result;
  const auto finish = [&] {
    result.point_of_vertex = std::move(made.point_of_vertex);
    result.vertex_of_point = std::move(made.vertex_of_point);
  };
  std::vector<DVec2> places;
  places.reserve(made.point_of_vertex.size());
  for (const std::uint32_t i : made.point_of_vertex) places.push_back(points[i]);
  if (made.mesh.face_count() == 0) {
    result.mesh = std::move(made.mesh);
    result.positions = std::move(places);
    finish();
    return result;
  }
  ConstrainedTriangles triangles(made.mesh, std::move(places));
  made.mesh = {};
  VKMESH_CHECK(insert_segments(triangles, segments, made, options.split_crossings, part(0.5, 0.7)));
  result.crossings = triangles.crossings();
  mark_outside(triangles, options.outlines, options.domain, made);
  std::vector<std::pair<std::uint32_t, UnrefinedReason>> unrefined;
  if (options.refinement) {
    fix_border(triangles);
    const std::size_t before = triangles.places().size();
    Refinement refinement(triangles, *options.refinement);
    VKMESH_CHECK(refinement.run(part(0.7, 1)));
    result.refined_points = triangles.places().size() - before;
    unrefined = refinement.left();
  }
  const EdgeMarks marks = std::move(triangles.marks());
  PlanarTriangles all = triangles.take_triangles();
  result.positions = triangles.take_places();
  result.added = triangles.take_added();
  finish();
  result.point_of_vertex.resize(result.positions.size(), kInvalid);
  if (has_outlines) split_fans(all, marks, result);
  std::vector<std::uint32_t> constrained;
  for (std::uint32_t t = 0; t < all.count; ++t) {
    if (marks.is_outside(t)) {
      all.origins[3 * std::size_t{t}] = kInvalid;
      continue;
    }
    for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h)
      if (marks.kind(h) == EdgeMarks::kConstraint) constrained.push_back(h);
  }
  RenumberedHalfEdges renumbered;
  result.mesh = canonical_mesh(std::move(all), result.positions.size(), &renumbered);
  for (const std::uint32_t h : constrained) {
    const HalfEdgeId id(renumbered(h));
    if (result.mesh.edge(id) == id) result.constrained_edges.push_back(id);
  }
  std::sort(result.constrained_edges.begin(), result.constrained_edges.end());
  for (const auto& [t, reason] : unrefined)
    result.unrefined.push_back({result.mesh.face(HalfEdgeId(renumbered(4 * t))), reason});
  std::sort(result.unrefined.begin(), result.unrefined.end(),
            [](const UnrefinedTriangle& a, const UnrefinedTriangle& b) { return a.face < b.face; });
  return result;
}

}  // namespace
}  // namespace detail

Result<ConstrainedTriangulation> constrained_delaunay(std::span<const DVec2> points,
                                                      std::span<const PointPair> constraints,
                                                      const ConstrainedDelaunayOptions& options,
                                                      const Progress& progress) {
  return detail::catching([&] { return detail::triangulate(points, constraints, options, progress); });
}

}  // namespace vkmesh
