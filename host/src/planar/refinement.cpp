#include "planar/refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace vkmesh::detail {
namespace {

constexpr VertexPair kNoConstraint = {kInvalid, kInvalid};

double dot(DVec2 a, DVec2 b) {
  return a.x * b.x + a.y * b.y;
}
double cross(DVec2 a, DVec2 b) {
  return a.x * b.y - a.y * b.x;
}
double squared_distance(DVec2 a, DVec2 b) {
  return dot(b - a, b - a);
}

}  // namespace

Refinement::Refinement(ConstrainedTriangles& triangles, const DelaunayRefinement& options)
    : all_(triangles),
      sine_squared_(std::sin(options.min_angle) * std::sin(options.min_angle)),
      max_area_(options.max_area.value_or(std::numeric_limits<double>::infinity())),
      min_edge_squared_(options.min_edge * options.min_edge),
      // A little less than what gives the new triangle the least angle.
      off_center_(0.475 / std::tan(options.min_angle / 2)),
      max_points_(options.max_points.value_or(1'000'000 + 10 * triangles.places().size())),
      first_(static_cast<std::uint32_t>(triangles.places().size())) {}

std::array<std::uint32_t, 3> Refinement::corners(std::uint32_t triangle) const {
  const std::uint32_t* const corner = &all_.triangles().origins[3 * std::size_t{triangle}];
  return {corner[0], corner[1], corner[2]};
}

/// A function of the triangle, whichever corner is its first.
Refinement::Badness Refinement::badness(std::uint32_t triangle) const {
  std::array<std::uint32_t, 3> v = corners(triangle);
  std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
  const DVec2 a = all_.place(v[0]), b = all_.place(v[1]), c = all_.place(v[2]);
  std::array<double, 3> lengths = {squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)};
  std::sort(lengths.begin(), lengths.end());
  const double twice_area = cross(b - a, c - a);
  // The sine of the least angle is twice the area over the product of the two longest sides.
  const double sine_squared = twice_area / lengths[1] * (twice_area / lengths[2]);
  return {sine_squared_ / sine_squared, twice_area / 2 / max_area_};
}

VertexPair Refinement::constraint_of(std::uint32_t h) const {
  for (const std::uint32_t end : {all_.origin(h), all_.target(h)})
    if (end >= first_) return on_[end - first_];
  return {all_.origin(h), all_.target(h)};
}

/// Whether the least angle is one between constraints, or cuts two of them at one distance from where they
/// meet: then no vertex makes it larger.
bool Refinement::is_at_input_angle(std::uint32_t triangle) const {
  std::uint32_t shortest = 4 * triangle;
  const auto length = [&](std::uint32_t h) {
    return squared_distance(all_.place(all_.origin(h)), all_.place(all_.target(h)));
  };
  for (std::uint32_t h = 4 * triangle; h < 4 * triangle + 3; ++h)
    if (length(h) < length(shortest)) shortest = h;
  if (all_.marks().is_fixed(PlanarTriangles::next(shortest)) &&
      all_.marks().is_fixed(PlanarTriangles::previous(shortest)))
    return true;
  return are_across(all_.origin(shortest), all_.target(shortest), 2e-3);
}

/// Whether p and q lie on two constraints with a common end, as far from it, but for a share of that.
bool Refinement::are_across(std::uint32_t p, std::uint32_t q, double share) const {
  if (p < first_ || q < first_) return false;
  const VertexPair one = on_[p - first_], two = on_[q - first_];
  if (one == two || one == kNoConstraint || two == kNoConstraint) return false;
  for (const std::uint32_t apex : one) {
    if (apex != two[0] && apex != two[1]) continue;
    const double ratio =
        squared_distance(all_.place(apex), all_.place(p)) / squared_distance(all_.place(apex), all_.place(q));
    return std::fabs(ratio - 1) <= share;
  }
  return false;
}

/// The centre of its circle, or a point on the way there that gives the shortest edge the least angle.
DVec2 Refinement::center(std::uint32_t triangle) const {
  std::array<std::uint32_t, 3> v = corners(triangle);
  std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
  std::array<DVec2, 3> p = {all_.place(v[0]), all_.place(v[1]), all_.place(v[2])};
  // Corner 0 is to be across from the shortest edge.
  std::size_t apex = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (squared_distance(p[(i + 1) % 3], p[(i + 2) % 3]) <
        squared_distance(p[(apex + 1) % 3], p[(apex + 2) % 3]))
      apex = i;
  std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(apex), p.end());
  const DVec2 a = p[1], edge = p[2] - a, side = p[0] - a;
  const double twice_area = cross(edge, side);
  // From the edge's middle, in lengths of the edge.
  const double to_center = dot(side, side - edge) / twice_area / 2;
  const double height =
      sine_squared_ > 0 && twice_area / 2 <= max_area_ ? std::min(to_center, off_center_) : to_center;
  return a + edge * 0.5 + DVec2(-edge.y, edge.x) * height;
}

bool Refinement::is_encroached_by(std::uint32_t h, DVec2 p) const {
  return dot(all_.place(all_.origin(h)) - p, all_.place(all_.target(h)) - p) < 0;
}

/// By the vertex across, on either side; but for one beside an end of it, which rounding may have put over
/// it.
bool Refinement::is_encroached(std::uint32_t h) const {
  for (const std::uint32_t side : {h, all_.twin(h)}) {
    if (!is_inside(side)) continue;
    const std::uint32_t apex = all_.apex(side);
    if (is_encroached_by(side, all_.place(apex)) && !are_across(apex, all_.origin(side), 1e-12) &&
        !are_across(apex, all_.target(side), 1e-12))
      return true;
  }
  return false;
}

bool Refinement::is_budget_left() const {
  return points_ < max_points_;
}

/// Whether h makes an acute angle with the next fixed edge of its origin, with nothing but the domain
/// between.
bool Refinement::is_acute(std::uint32_t h) const {
  const auto direction = [&](std::uint32_t edge) {
    return all_.place(all_.target(edge)) - all_.place(all_.origin(edge));
  };
  for (std::uint32_t e = h; is_inside(e);) {  // counter-clockwise
    e = all_.twin(PlanarTriangles::previous(e));
    if (e == h) return false;
    if (all_.marks().kind(e) == EdgeMarks::kFree) continue;
    if (dot(direction(h), direction(e)) > 0) return true;
    break;
  }
  for (std::uint32_t e = h; is_inside(all_.twin(e));) {  // clockwise
    e = PlanarTriangles::next(all_.twin(e));
    if (all_.marks().kind(e) != EdgeMarks::kFree) return dot(direction(h), direction(e)) > 0;
  }
  return false;
}

void Refinement::find_acute_ends() {
  for (std::uint32_t t = 0; t < all_.triangles().count; ++t)
    for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h)
      if (all_.marks().kind(h) != EdgeMarks::kFree && is_acute(h)) acute_.insert(ends(h));
}

/// Where a fixed edge is split: in the middle; on a constraint that makes an acute angle at a distance from
/// there that is a multiple of the largest power of two that serves. So constraints with one end are split at
/// equal distances from it, and their parts stay out of each other's way.
DVec2 Refinement::split_place(std::uint32_t h) const {
  const DVec2 u = all_.place(all_.origin(h)), v = all_.place(all_.target(h));
  const DVec2 middle(std::midpoint(u.x, v.x), std::midpoint(u.y, v.y));
  VertexPair whole = constraint_of(h);
  if (squared_distance(all_.place(whole[1]), middle) < squared_distance(all_.place(whole[0]), middle))
    std::swap(whole[0], whole[1]);
  if (!acute_.contains(whole)) std::swap(whole[0], whole[1]);
  if (!acute_.contains(whole)) return middle;
  const DVec2 apex = all_.place(whole[0]), along = all_.place(whole[1]) - apex;
  const double length = std::sqrt(dot(along, along)), from = std::sqrt(squared_distance(apex, u)),
               to = std::sqrt(squared_distance(apex, v));
  const double low = 0.8 * std::min(from, to) + 0.2 * std::max(from, to),
               high = 0.2 * std::min(from, to) + 0.8 * std::max(from, to);
  if (!(low < high && length > 0 && std::isfinite(length))) return middle;
  double step = std::ldexp(1.0, std::ilogb(high)), distance = step;
  while (distance < low || distance > high) {
    step /= 2;
    distance = std::ceil(low / step) * step;
  }
  const DVec2 p = apex + along * (distance / length);
  return {std::clamp(p.x, std::min(u.x, v.x), std::max(u.x, v.x)),
          std::clamp(p.y, std::min(u.y, v.y), std::max(u.y, v.y))};
}

void Refinement::look_at(std::uint32_t triangle) {
  const Badness off = badness(triangle);
  if (off.by_area > 1 || (off.by_angle > 1 && !is_at_input_angle(triangle)))
    bad_.push({std::max(off.by_angle, off.by_area), triangle, corners(triangle)});
}

/// Adds a vertex, and looks at what is new around it.
Result<void> Refinement::add(DVec2 p, PlaceInTriangles place, VertexPair on) {
  VKMESH_TRY(const std::uint32_t v, all_.add_vertex(p, place));
  on_.push_back(on);
  ++points_;
  const std::uint32_t start = all_.marks().leaving(v);
  std::uint32_t h = start;
  do {
    if (is_inside(h)) look_at(h >> 2);
    for (const std::uint32_t edge : {h, PlanarTriangles::next(h)})
      if (all_.marks().kind(edge) != EdgeMarks::kFree && is_encroached(edge))
        encroached_.push_back(ends(edge));
    h = all_.twin(PlanarTriangles::previous(h));
  } while (h != start);
  return {};
}

/// Splits a fixed edge; not where a part would be too short, or rounding turns a triangle over.
Result<bool> Refinement::split(const VertexPair& edge) {
  const std::uint32_t h = all_.half_edge(edge[0], edge[1]);
  if (h == kInvalid) return true;
  const DVec2 p = split_place(h), u = all_.place(all_.origin(h)), v = all_.place(all_.target(h));
  if (p == u || p == v) return false;
  if (squared_distance(p, u) < min_edge_squared_ || squared_distance(p, v) < min_edge_squared_) return false;
  for (const std::uint32_t side : {h, all_.twin(h)}) {
    if (!is_inside(side)) continue;
    const DVec2 a = all_.place(all_.origin(side)), b = all_.place(all_.target(side)),
                c = all_.place(all_.apex(side));
    if (all_.predicates().orientation(p, b, c) <= 0 || all_.predicates().orientation(p, c, a) <= 0)
      return false;
  }
  VKMESH_CHECK(add(p, {h, true}, constraint_of(h)));
  return true;
}

Result<void> Refinement::improve(const Bad& bad) {
  const std::uint32_t t = bad.triangle;
  const DVec2 p = center(t);
  if (!(std::isfinite(p.x) && std::isfinite(p.y))) return {};
  // Where it is: in the triangle, or on the way through the edge that it lies beyond.
  EndOfWalk end{EndOfWalk::kInTriangle, 4 * t};
  int beyond = 0;
  for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h) {
    const int side = all_.predicates().orientation(all_.place(all_.origin(h)), all_.place(all_.target(h)), p);
    if (side > 0) continue;
    if (side == 0 && beyond == 0) end = {EndOfWalk::kOnEdge, h};
    if (side < 0) {
      ++beyond;
      end = {EndOfWalk::kFixedEdge, h};
    }
  }
  if (beyond > 1) return {};
  if (beyond == 1) end = all_.walk_over(all_.apex(end.index), end.index, p, true);
  if (end.what == EndOfWalk::kVertex || end.what == EndOfWalk::kOutside) return {};
  in_the_way_.clear();
  double nearest = std::numeric_limits<double>::infinity();
  if (end.what == EndOfWalk::kFixedEdge ||
      (end.what == EndOfWalk::kOnEdge && all_.marks().is_fixed(end.index))) {
    in_the_way_.push_back(ends(end.index));
  } else {
    // The triangles whose circle holds it, up to fixed edges.
    seen_.resize(std::max<std::size_t>(seen_.size(), all_.triangles().count), 0);
    ++search_;
    cavity_.assign(1, end.index >> 2);
    seen_[cavity_[0]] = search_;
    for (std::size_t i = 0; i < cavity_.size(); ++i)
      for (std::uint32_t h = 4 * cavity_[i]; h < 4 * cavity_[i] + 3; ++h) {
        nearest = std::min(nearest, squared_distance(all_.place(all_.origin(h)), p));
        if (all_.marks().is_fixed(h)) {
          if (is_encroached_by(h, p)) in_the_way_.push_back(ends(h));
          continue;
        }
        const std::uint32_t u = all_.twin(h);
        if (seen_[u >> 2] == search_) continue;
        const bool holds = (end.what == EndOfWalk::kOnEdge && h == end.index) ||
                           all_.predicates().in_circle(all_.place(all_.origin(u)), all_.place(all_.target(u)),
                                                       all_.place(all_.apex(u)), p) > 0;
        if (!holds) continue;
        seen_[u >> 2] = search_;
        cavity_.push_back(u >> 2);
      }
  }
  if (in_the_way_.empty()) {
    if (nearest == 0 || nearest < min_edge_squared_) return {};
    return add(p, end.place(), kNoConstraint);
  }
  bool any = false;
  for (const VertexPair& edge : in_the_way_) {
    if (!is_budget_left()) break;
    VKMESH_TRY(const bool done, split(edge));
    any = any || done;
  }
  if (any && corners(t) == bad.corners) bad_.push(bad);
  return {};
}

Result<void> Refinement::run(const Progress& progress) {
  find_acute_ends();
  const std::uint32_t count = all_.triangles().count;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (all_.marks().is_outside(t)) continue;
    look_at(t);
    for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h)
      if (all_.marks().is_fixed(h) && (h < all_.twin(h) || !is_inside(all_.twin(h))) && is_encroached(h))
        encroached_.push_back(ends(h));
  }
  constexpr std::size_t kBetweenReports = 1 << 12;
  for (std::size_t steps = 0; is_budget_left(); ++steps) {
    if (steps % kBetweenReports == 0 && progress && !progress(0.5))
      return fail(ErrorCode::kInterrupted, "cancelled");
    if (!encroached_.empty()) {
      const VertexPair edge = encroached_.front();
      encroached_.pop_front();
      const std::uint32_t h = all_.half_edge(edge[0], edge[1]);
      if (h != kInvalid && all_.marks().is_fixed(h) && is_encroached(h)) {
        VKMESH_TRY([[maybe_unused]] const bool done, split(edge));
      }
    } else if (!bad_.empty()) {
      const Bad bad = bad_.top();
      bad_.pop();
      if (corners(bad.triangle) == bad.corners) VKMESH_CHECK(improve(bad));
    } else {
      break;
    }
  }
  return {};
}

std::vector<std::pair<std::uint32_t, UnrefinedReason>> Refinement::left() const {
  std::vector<std::pair<std::uint32_t, UnrefinedReason>> left;
  for (std::uint32_t t = 0; t < all_.triangles().count; ++t) {
    if (all_.marks().is_outside(t)) continue;
    const Badness off = badness(t);
    if (off.by_angle > 1 || off.by_area > 1)
      left.emplace_back(t, off.by_area <= 1 && is_at_input_angle(t) ? UnrefinedReason::kInputAngle
                           : is_budget_left()                       ? UnrefinedReason::kMinEdge
                                                                    : UnrefinedReason::kMaxPoints);
  }
  return left;
}

}  // namespace vkmesh::detail
