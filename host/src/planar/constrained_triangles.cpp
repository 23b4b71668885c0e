#include "planar/constrained_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace vkmesh::detail {
namespace {

bool is_less(DVec2 p, DVec2 q) {
  return p.x != q.x ? p.x < q.x : p.y < q.y;
}

/// Barycentric coordinates of p in the triangle, as far as rounding tells.
std::array<float, 3> weights_of(DVec2 p, const std::array<DVec2, 3>& corners) {
  std::array<double, 3> areas;
  for (std::size_t i = 0; i < 3; ++i) {
    const DVec2 a = corners[(i + 1) % 3] - p, b = corners[(i + 2) % 3] - p;
    areas[i] = std::max(a.x * b.y - a.y * b.x, 0.0);
  }
  const double sum = areas[0] + areas[1] + areas[2];
  if (!(sum > 0 && std::isfinite(sum))) return {1, 0, 0};
  return {static_cast<float>(areas[0] / sum), static_cast<float>(areas[1] / sum),
          static_cast<float>(areas[2] / sum)};
}

/// The same of p between a and b.
std::array<float, 3> weights_of(DVec2 p, DVec2 a, DVec2 b) {
  const DVec2 whole = b - a, part = p - a;
  const double share = std::fabs(whole.x) > std::fabs(whole.y) ? part.x / whole.x : part.y / whole.y;
  const auto second = static_cast<float>(std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0));
  return {1 - second, second, 0};
}

/// The triangles of the mesh, and for each edge of the hull one with a vertex at infinity, which closes it.
PlanarTriangles closed(const HalfEdgeMesh& mesh) {
  const std::span<const std::uint32_t> corners = mesh.origins(), twins = mesh.twins();
  const auto faces = static_cast<std::uint32_t>(mesh.face_count());
  PlanarTriangles triangles;
  triangles.count = faces + static_cast<std::uint32_t>(mesh.boundary_half_edge_count());
  const std::size_t room = 3 * (std::size_t{triangles.count} + triangles.count / 16 + 64);
  triangles.origins = LargeArray<std::uint32_t>(room);
  triangles.twins = LargeArray<std::uint32_t>(room);
  std::copy(corners.begin(), corners.end(), triangles.origins.data());
  std::unordered_map<std::uint32_t, std::uint32_t> beyond;  // of half-edges of the hull
  for (std::uint32_t h = 0; h < corners.size(); ++h) {
    if (twins[h] != kInvalid) {
      triangles.twins[h] = twins[h] + twins[h] / 3;
      continue;
    }
    const auto t = faces + static_cast<std::uint32_t>(beyond.size());
    beyond.emplace(h, t);
    const std::array<std::uint32_t, 3> ends = {mesh.target(HalfEdgeId(h)).index, corners[h], kInvalid};
    std::copy(ends.begin(), ends.end(), &triangles.origins[3 * std::size_t{t}]);
    triangles.set_twins(h + h / 3, 4 * t);
  }
  for (const auto& [h, t] : beyond)
    triangles.set_twins(4 * t + 2, 4 * beyond.at(mesh.next_on_boundary(HalfEdgeId(h)).index) + 1);
  return triangles;
}

}  // namespace

ConstrainedTriangles::ConstrainedTriangles(const HalfEdgeMesh& mesh, std::vector<DVec2> places)
    : places_(std::move(places)), insertion_(places_, closed(mesh), EdgeMarks()) {
  insertion_.marks() = EdgeMarks(insertion_.triangles(), places_.size());
}

bool ConstrainedTriangles::is_ahead(DVec2 a, DVec2 b, DVec2 c) {
  return is_less(a, b) == is_less(a, c);
}

ConstrainedTriangles::Wedge ConstrainedTriangles::wedge(std::uint32_t a, DVec2 p) const {
  const DVec2 from = places_[a];
  const std::uint32_t start = marks().leaving(a);
  std::uint32_t h = start;
  do {
    const std::uint32_t q = target(h), r = apex(h);
    if (q != kInvalid) {
      const int side = predicates().orientation(from, places_[q], p);
      if (side == 0 && is_ahead(from, places_[q], p)) return {h, true};
      if (side > 0 && r != kInvalid && predicates().orientation(from, places_[r], p) < 0) return {h, false};
    }
    h = twin(PlanarTriangles::previous(h));
  } while (h != start);
  // Outside of the hull: beyond one of its two edges here.
  while (true) {
    const std::uint32_t edge = apex(h) == kInvalid     ? h
                               : target(h) == kInvalid ? PlanarTriangles::previous(h)
                                                       : kInvalid;
    if (edge != kInvalid && predicates().orientation(places_[origin(edge)], places_[target(edge)], p) > 0)
      return {edge, false};
    h = twin(PlanarTriangles::previous(h));
  }
}

std::uint32_t ConstrainedTriangles::fixed_edge_at(std::uint32_t v) const {
  const std::uint32_t start = marks().leaving(v);
  std::uint32_t h = start;
  do {
    if (marks().is_fixed(h)) return h;
    h = twin(PlanarTriangles::previous(h));
  } while (h != start);
  return kInvalid;
}

EndOfWalk ConstrainedTriangles::walk(std::uint32_t a, DVec2 p) const {
  while (true) {
    if (places_[a] == p) return {EndOfWalk::kVertex, a};
    const Wedge entered = wedge(a, p);
    const std::uint32_t h = entered.half_edge;
    if (apex(h) == kInvalid && !entered.along) return {EndOfWalk::kOutside, h};
    if (!entered.along) return walk_over(a, PlanarTriangles::next(h), p, false);
    const std::uint32_t c = target(h);
    if (places_[c] != p && is_less(places_[a], places_[c]) == is_less(p, places_[c]))
      return {EndOfWalk::kOnEdge, h};
    a = c;
  }
}

EndOfWalk ConstrainedTriangles::walk_over(std::uint32_t from, std::uint32_t h, DVec2 p,
                                          bool stops_at_fixed) const {
  const DVec2 start = places_[from];
  while (true) {
    // The line leaves the triangle of h through h, with its origin on the right.
    const int side = predicates().orientation(places_[origin(h)], places_[target(h)], p);
    if (side > 0) return {EndOfWalk::kInTriangle, h};
    if (side == 0) return {EndOfWalk::kOnEdge, h};
    if (stops_at_fixed && marks().is_fixed(h)) return {EndOfWalk::kFixedEdge, h};
    const std::uint32_t u = twin(h), s = apex(u);
    if (s == kInvalid) return {EndOfWalk::kOutside, u};
    const int turn = predicates().orientation(start, p, places_[s]);
    if (turn == 0) {
      if (places_[s] != p && is_less(start, places_[s]) == is_less(p, places_[s]))
        return {EndOfWalk::kInTriangle, u};
      const std::uint32_t fixed = stops_at_fixed && places_[s] != p ? fixed_edge_at(s) : kInvalid;
      if (fixed != kInvalid) return {EndOfWalk::kFixedEdge, fixed};
      if (!stops_at_fixed || places_[s] == p) return walk(s, p);
      const Wedge next = wedge(s, p);
      if (!next.along) return walk_over(s, PlanarTriangles::next(next.half_edge), p, true);
      const std::uint32_t c = target(next.half_edge);
      if (places_[c] == p) return {EndOfWalk::kVertex, c};
      if (is_less(start, places_[c]) == is_less(p, places_[c])) return {EndOfWalk::kOnEdge, next.half_edge};
      // Along an edge to the next vertex: the walk ends there.
      const std::uint32_t stop = fixed_edge_at(c);
      if (stop != kInvalid) return {EndOfWalk::kFixedEdge, stop};
      return {EndOfWalk::kVertex, c};
    }
    h = turn > 0 ? PlanarTriangles::next(u) : PlanarTriangles::previous(u);
  }
}

std::uint32_t ConstrainedTriangles::half_edge(std::uint32_t u, std::uint32_t v) const {
  const std::uint32_t start = marks().leaving(u);
  std::uint32_t h = start;
  do {
    if (target(h) == v) return h;
    h = twin(PlanarTriangles::previous(h));
  } while (h != start);
  return kInvalid;
}

ConstrainedTriangles::Meeting ConstrainedTriangles::meet(std::uint32_t a, std::uint32_t b) {
  const Wedge entered = wedge(a, places_[b]);
  const std::uint32_t first = entered.half_edge;
  crossed_.clear();
  right_.assign(1, first);
  left_.clear();
  if (entered.along) return {true, target(first)};
  left_.push_back(PlanarTriangles::previous(first));
  crossed_.push_back(first >> 2);
  std::uint32_t h = PlanarTriangles::next(first);
  while (true) {
    if (marks().is_fixed(h)) return {false, h};
    const std::uint32_t u = twin(h), s = apex(u);
    const std::uint32_t n = PlanarTriangles::next(u), m = PlanarTriangles::previous(u);
    crossed_.push_back(u >> 2);
    const int side = s == b ? 0 : orientation(a, b, s);
    if (side <= 0) right_.push_back(n);
    if (side >= 0) left_.push_back(m);
    if (side == 0) return {true, s};
    h = side > 0 ? n : m;
  }
}

void ConstrainedTriangles::fix(std::uint32_t h) {
  marks().set_kind(h, EdgeMarks::kConstraint);
  marks().set_kind(twin(h), EdgeMarks::kConstraint);
}

void ConstrainedTriangles::gather(std::span<const std::uint32_t> half_edges, std::vector<Side>& sides) {
  PlanarTriangles& triangles = insertion_.triangles();
  sides.clear();
  for (const std::uint32_t h : half_edges)
    sides.push_back({origin(h), twin(h), kInvalid, marks().kind(h), false});
  for (std::uint32_t i = 0; i < half_edges.size(); ++i)
    triangles.twins[PlanarTriangles::slot(half_edges[i])] = i;
  for (Side& side : sides)
    if (marks().is_in_cavity(side.beyond >> 2)) {
      side.is_inner = true;
      side.beyond = twin(side.beyond);
    }
}

std::uint32_t ConstrainedTriangles::fill(std::vector<Side>& sides, std::uint32_t end, std::size_t& record) {
  // What is left of the polygon: corners, each with the edge that leads there from the one before.
  PlanarTriangles& triangles = insertion_.triangles();
  stack_.assign(1, {sides[0].origin, 0, false});
  const auto attach = [&](std::uint32_t h, const Corner& corner) {
    if (!corner.is_side) return triangles.set_twins(h, corner.edge);
    sides[corner.edge].replaced_by = h;
    marks().set_kind(h, sides[corner.edge].kind);
  };
  for (std::uint32_t i = 0; i < sides.size(); ++i) {
    Corner corner = {i + 1 < sides.size() ? sides[i + 1].origin : end, i, true};
    while (stack_.size() > 1) {
      const std::uint32_t p = stack_[stack_.size() - 2].vertex, q = stack_.back().vertex, r = corner.vertex;
      if (orientation(p, q, r) <= 0) break;
      const std::uint32_t t = crossed_[record++];
      marks().clear(t);
      std::uint32_t h = 4 * t;
      for (const std::uint32_t v : {p, q, r}) {
        triangles.origins[PlanarTriangles::slot(h)] = v;
        marks().set_leaving(v, h++);
      }
      attach(4 * t, stack_.back());
      attach(4 * t + 1, corner);
      stack_.pop_back();
      corner.edge = 4 * t + 2;
      corner.is_side = false;
      suspects_.push_back(4 * t + 2);
    }
    stack_.push_back(corner);
  }
  for (const Side& side : sides)
    if (side.is_inner)
      triangles.twins[PlanarTriangles::slot(side.replaced_by)] = sides[side.beyond].replaced_by;
    else
      triangles.set_twins(side.replaced_by, side.beyond);
  return stack_.back().edge;
}

void ConstrainedTriangles::make_edge(std::uint32_t a, std::uint32_t b) {
  if (crossed_.empty()) return fix(right_[0]);
  std::reverse(left_.begin(), left_.end());
  for (const std::uint32_t t : crossed_) marks().set_in_cavity(t);
  gather(left_, left_sides_);
  gather(right_, right_sides_);
  std::size_t record = 0;
  const std::uint32_t left = fill(left_sides_, a, record), right = fill(right_sides_, b, record);
  insertion_.triangles().set_twins(left, right);
  fix(left);
  swap_to_delaunay();
}

void ConstrainedTriangles::swap_to_delaunay() {
  while (!suspects_.empty()) {
    const std::uint32_t h = suspects_.back();
    suspects_.pop_back();
    if (marks().is_fixed(h)) continue;
    const std::uint32_t u = twin(h), p = apex(h), q = origin(h), r = target(h), across = apex(u);
    if (std::max({p, q, r, across}) == kInvalid ||
        predicates().in_circle_perturbed(places_[p], places_[q], places_[r], places_[across]) <= 0)
      continue;
    insertion_.swap(h);
    const std::uint32_t first = u & ~3u;
    suspects_.insert(suspects_.end(), {PlanarTriangles::previous(h), h, first + 1, first + 2});
  }
}

void ConstrainedTriangles::add_room() {
  PlanarTriangles& triangles = insertion_.triangles();
  const std::size_t count = triangles.count, room = triangles.origins.size() / 3;
  if (count + 2 <= room) return;
  const std::size_t more = room + room / 2 + 64;
  triangles.origins.grow(3 * more, 3 * count);
  triangles.twins.grow(3 * more, 3 * count);
  marks().grow(more, count);
}

Result<std::uint32_t> ConstrainedTriangles::add_vertex(DVec2 p, PlaceInTriangles place) {
  if (places_.size() >= kMostVertices)
    return fail(ErrorCode::kUnsuitable,
                "there is no room for more than " + std::to_string(kMostVertices) + " vertices");
  add_room();
  const std::uint32_t h = place.half_edge, a = origin(h), b = target(h), c = apex(h);
  const bool between = place.on_edge || c == kInvalid;
  added_.push_back({{a, b, between ? a : c},
                    between ? weights_of(p, places_[a], places_[b])
                            : weights_of(p, {places_[a], places_[b], places_[c]})});
  const auto v = static_cast<std::uint32_t>(places_.size());
  const bool splits_fixed = place.on_edge && marks().is_fixed(h);
  if (splits_fixed) splits_[key(a, b)] = v;
  places_.push_back(p);
  marks().add_vertex();
  insertion_.points_moved(places_.data(), p);
  insertion_.insert_at(v, place);
  if (splits_fixed) {
    // Rounding may have put it off the edge, where the edges that join it need not be Delaunay.
    const std::uint32_t start = marks().leaving(v);
    std::uint32_t spoke = start;
    do {
      suspects_.push_back(spoke);
      spoke = twin(PlanarTriangles::previous(spoke));
    } while (spoke != start);
    swap_to_delaunay();
  }
  return v;
}

bool ConstrainedTriangles::may_split(const VertexPair& edge, std::uint32_t x, double distance) const {
  if (edge[0] == x || edge[1] == x || distance == 0) return true;
  const auto length = [](DVec2 p, DVec2 q) { return std::fabs(p.x - q.x) + std::fabs(p.y - q.y); };
  const DVec2 p = places_[edge[0]], q = places_[edge[1]];
  const double size = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(q.x), std::fabs(q.y)});
  return distance <= 0x1p-48 * size + 2 * std::numeric_limits<double>::denorm_min() &&
         length(p, places_[x]) < length(p, q) && length(places_[x], q) < length(p, q);
}

/// Where a crossing lies nearer to a vertex than some units in the last place, that one serves: a vertex
/// beside it would bring edges so near to each other that rounding makes them cross again, and again.
Result<void> ConstrainedTriangles::split_crossing(std::uint32_t a, std::uint32_t b, std::uint32_t h) {
  const VertexPair one = {a, b}, two = {origin(h), target(h)};
  const DVec2 p = crossing_of(places_[a], places_[b], places_[two[0]], places_[two[1]]);
  ++crossings_;
  std::uint32_t x = kInvalid;
  double nearest = std::numeric_limits<double>::infinity();
  const auto consider = [&](std::uint32_t v) {
    if (v == kInvalid) return;
    const double distance = std::max(std::fabs(places_[v].x - p.x), std::fabs(places_[v].y - p.y));
    if (distance >= nearest || !may_split(one, v, distance) || !may_split(two, v, distance)) return;
    x = v;
    nearest = distance;
  };
  for (const std::uint32_t v : {a, b, two[0], two[1]}) consider(v);
  if (x != two[0] && x != two[1]) {
    for (const std::uint32_t side : {h, twin(h)}) marks().set_kind(side, EdgeMarks::kFree);
    suspects_.push_back(h);
    swap_to_delaunay();
  }
  if (x == kInvalid) {
    const EndOfWalk end = walk(a, p);
    if (end.what == EndOfWalk::kVertex) {
      x = end.index;
    } else {
      for (const std::uint32_t v : {origin(end.index), target(end.index), apex(end.index)}) consider(v);
      if (x == kInvalid) {
        VKMESH_TRY(x, add_vertex(p, end.place()));
      }
    }
  }
  for (const VertexPair& edge : {one, two}) {
    if (x != edge[0] && x != edge[1]) splits_[key(edge[0], edge[1])] = x;
    if (edge == one || (x != edge[0] && x != edge[1])) waiting_.push_back(edge);
  }
  return {};
}

Result<std::optional<VertexPair>> ConstrainedTriangles::insert_segment(std::uint32_t a, std::uint32_t b,
                                                                       std::size_t most_splits) {
  const std::size_t before = crossings_;
  waiting_.assign(1, {a, b});
  while (!waiting_.empty()) {
    const auto [u, v] = waiting_.back();
    waiting_.pop_back();
    if (u == v) continue;
    if (const auto split = splits_.find(key(u, v)); split != splits_.end()) {
      waiting_.push_back({split->second, v});
      waiting_.push_back({u, split->second});
      continue;
    }
    const Meeting met = meet(u, v);
    if (met.at_vertex && met.index == v) {
      make_edge(u, v);
    } else if (met.at_vertex) {
      splits_[key(u, v)] = met.index;
      waiting_.push_back({u, v});
    } else if (crossings_ - before >= most_splits) {
      return VertexPair{origin(met.index), target(met.index)};
    } else {
      VKMESH_CHECK(split_crossing(u, v, met.index));
    }
  }
  return std::optional<VertexPair>();
}

}  // namespace vkmesh::detail
