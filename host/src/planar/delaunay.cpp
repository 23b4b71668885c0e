#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/planar/delaunay.h>

#include "base/large_array.h"
#include "base/prefetch.h"
#include "math/filtered_predicates.h"
#include "planar/triangle_mesh.h"
#include "spatial/hilbert_order.h"

namespace vkmesh {
namespace detail {
namespace {

constexpr std::size_t kMostPoints = (std::size_t{1} << 29) - 2;

bool is_finite(DVec2 p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

tl::unexpected<Error> not_finite(std::size_t point) {
  return fail(ErrorCode::kUnsuitable, "point " + std::to_string(point) + " is not finite");
}

tl::unexpected<Error> too_many(std::size_t points) {
  return fail(ErrorCode::kUnsuitable, "there are " + std::to_string(points) +
                                          " points, and a triangulation has room for " +
                                          std::to_string(kMostPoints));
}

/// A Delaunay triangulation that points are added to. Its hull is closed by triangles with the vertex at
/// infinity, kInvalid: one for each edge of the hull, which it has the other way.
class Insertion {
 public:
  explicit Insertion(std::span<const DVec2> points)
      : points_(points.data()), predicates_(all_in_filter_range(points)) {
    const std::size_t corners = 6 * points.size();  // of 2 n - 2 triangles
    triangles_.origins = LargeArray<std::uint32_t>(corners);
    triangles_.twins = LargeArray<std::uint32_t>(corners);
  }

  /// The first triangle, of three points that turn counter-clockwise.
  void begin(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    set_origins(0, {a, b, c});
    set_origins(1, {b, a, kInvalid});
    set_origins(2, {c, b, kInvalid});
    set_origins(3, {a, c, kInvalid});
    triangles_.count = 4;
    for (std::uint32_t i = 0; i < 3; ++i) {
      triangles_.set_twins(i, 4 * (i + 1));
      triangles_.set_twins(4 * (i + 1) + 2, 4 * ((i + 1) % 3 + 1) + 1);
    }
    last_ = 0;
  }

  /// Adds point v, which no vertex lies on.
  void insert(std::uint32_t v) {
    const Place place = locate(points_[v]);
    const std::uint32_t h = place.half_edge, t = h >> 2, n = PlanarTriangles::next(h),
                        m = PlanarTriangles::previous(h);
    if (!place.on_edge) {
      const std::array<Side, 3> sides = {side(h), side(n), side(m)};
      surround(v, sides, {t, triangles_.count, triangles_.count + 1});
      triangles_.count += 2;
      make_delaunay(t, 3);
    } else {
      const std::uint32_t u = triangles_.twin(h);
      const std::array<Side, 4> sides = {side(n), side(m), side(PlanarTriangles::next(u)),
                                         side(PlanarTriangles::previous(u))};
      surround(v, sides, {t, triangles_.count, u >> 2, triangles_.count + 1});
      triangles_.count += 2;
      make_delaunay(t, 4);
    }
  }

  PlanarTriangles take() { return std::move(triangles_); }

 private:
  struct Place {
    std::uint32_t half_edge;  // of the triangle
    bool on_edge;             // on that half-edge
  };
  /// An edge that a new point is joined to, and what lies beyond it.
  struct Side {
    std::uint32_t origin, beyond;
  };

  void set_origins(std::uint32_t t, const std::array<std::uint32_t, 3>& corners) {
    std::copy_n(corners.begin(), 3, &triangles_.origins[3 * std::size_t{t}]);
  }
  [[nodiscard]] Side side(std::uint32_t h) const { return {triangles_.origin(h), triangles_.twin(h)}; }

  /// Walks from the last triangle over edges that p lies strictly beyond. It ends, since what it was begun
  /// in is Delaunay (O. Devillers, S. Pion, M. Teillaud, "Walking in a triangulation", 2002).
  [[nodiscard]] Place locate(DVec2 p) const {
    std::uint32_t h = 4 * last_;
    int side_of_h = orientation(h, p);
    if (side_of_h < 0) {
      h = triangles_.twin(h);
      side_of_h = 1;
    }
    while (true) {
      const std::uint32_t n = PlanarTriangles::next(h), m = PlanarTriangles::previous(h);
      const std::uint32_t apex = triangles_.origin(m);
      if (apex == kInvalid) return {h, false};
      const int side_of_n = orientation(n, p);
      if (side_of_n < 0) {
        h = triangles_.twin(n);
        side_of_h = 1;
        continue;
      }
      const int side_of_m = orientation(m, p);
      if (side_of_m < 0) {
        h = triangles_.twin(m);
        side_of_h = 1;
        continue;
      }
      if (side_of_h == 0) return {h, true};
      if (side_of_n == 0) return {n, true};
      return {m, side_of_m == 0};
    }
  }
  [[nodiscard]] int orientation(std::uint32_t h, DVec2 p) const {
    return predicates_.orientation(points_[triangles_.origin(h)],
                                   points_[triangles_.origin(PlanarTriangles::next(h))], p);
  }

  /// Joins v to sides that go once around it, counter-clockwise, by triangles with v at corner 0.
  template <std::size_t N>
  void surround(std::uint32_t v, const std::array<Side, N>& sides,
                const std::array<std::uint32_t, N>& records) {
    for (std::size_t i = 0; i < N; ++i) {
      const std::size_t j = (i + 1) % N;
      set_origins(records[i], {v, sides[i].origin, sides[j].origin});
      triangles_.set_twins(4 * records[i] + 1, sides[i].beyond);
      triangles_.set_twins(4 * records[i] + 2, 4 * records[j]);
    }
  }

  /// Swaps edges across from a new point, corner 0 of the `edges` triangles around it, of which t is one,
  /// until all are Delaunay.
  void make_delaunay(std::uint32_t t, int edges) {
    while (edges > 0) {
      if (is_to_swap(t)) {
        triangles_.swap(4 * t + 1);
        ++edges;
      } else {
        last_ = t;
        t = triangles_.twin(4 * t + 2) >> 2;
        --edges;
      }
    }
    while (triangles_.origins[3 * std::size_t{last_} + 1] == kInvalid ||
           triangles_.origins[3 * std::size_t{last_} + 2] == kInvalid)
      last_ = triangles_.twin(4 * last_ + 2) >> 2;
  }
  [[nodiscard]] bool is_to_swap(std::uint32_t t) const {
    const std::uint32_t* const corner = &triangles_.origins[3 * std::size_t{t}];
    const std::uint32_t v = corner[0], a = corner[1], b = corner[2];
    const std::uint32_t across = triangles_.origin(PlanarTriangles::previous(triangles_.twin(4 * t + 1)));
    constexpr std::uint32_t kAtInfinity = 0x80000000u;
    if (((a | b | across) & kAtInfinity) == 0)
      return predicates_.in_circle_perturbed(points_[v], points_[a], points_[b], points_[across]) > 0;
    // The circle of an edge of the hull is the open half-plane beyond it.
    if (across == kInvalid) return false;
    return predicates_.orientation(points_[v], points_[a == kInvalid ? across : a],
                                   points_[b == kInvalid ? across : b]) > 0;
  }

  const DVec2* points_;
  FilteredPredicates predicates_;
  PlanarTriangles triangles_;
  std::uint32_t last_ = 0;  // a triangle where to begin, not at infinity
};

/// Calls insert(i) once for each i below count but those of `done`, in rounds: one of each 8^k numbers, then
/// one of each 8^(k-1), and so on, each round in order.
template <class Insert>
[[nodiscard]] bool in_rounds(std::size_t count, std::vector<bool>& done, Insert&& insert) {
  constexpr unsigned kBitsOfRound = 3;
  unsigned bits = 0;
  while ((count >> bits) > 32) bits += kBitsOfRound;
  for (;; bits -= kBitsOfRound) {
    const std::size_t stride = std::size_t{1} << bits;
    std::uint64_t random = 0x9e3779b97f4a7c15u * (bits + 1);
    for (std::size_t begin = 0; begin < count; begin += stride) {
      random = random * 6364136223846793005u + 1442695040888963407u;  // D. E. Knuth's for 64 bits
      const std::size_t i = begin + (bits == 0 ? 0 : random >> (64 - bits));
      if (i >= count || done[i]) continue;
      done[i] = true;
      if (!insert(static_cast<std::uint32_t>(i))) return false;
    }
    if (bits == 0) return true;
  }
}

Result<DelaunayTriangulation> triangulate(std::span<const DVec2> points, const Progress& progress) {
  if (points.size() > kMostPoints) return too_many(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i])) return not_finite(i);
  DelaunayTriangulation result;
  std::vector<DVec2> places;  // of vertices
  places.reserve(points.size());
  result.vertex_of_point.resize(points.size());
  std::vector<std::uint32_t> order = HilbertOrder::of(points);
  constexpr std::size_t kAhead = 24;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k + kAhead < order.size()) {
      const std::uint32_t soon = order[k + kAhead];
      prefetch(&points[soon]);
      prefetch(&result.vertex_of_point[soon]);
    }
    const std::uint32_t i = order[k];
    if (places.empty() || places.back() != points[i]) {
      order[places.size()] = i;
      places.push_back(points[i]);
    }
    result.vertex_of_point[i] = static_cast<std::uint32_t>(places.size() - 1);
  }
  order.resize(places.size());
  result.point_of_vertex = std::move(order);

  const auto count = static_cast<std::uint32_t>(places.size());
  std::uint32_t third = 2;
  int turn = 0;
  while (third < count && (turn = orientation(places[0], places[1], places[third])) == 0) ++third;
  if (turn == 0) {
    result.mesh = HalfEdgeMesh::from_arrays({}, {}, std::vector<std::uint32_t>(count, kInvalid));
    return result;
  }
  Insertion insertion(places);
  insertion.begin(0, turn > 0 ? 1 : third, turn > 0 ? third : 1);
  std::vector<bool> done(count, false);
  done[0] = done[1] = done[third] = true;
  constexpr std::size_t kBetweenReports = 1 << 14;
  std::size_t inserted = 0;
  const bool finished = in_rounds(count, done, [&](std::uint32_t v) {
    if (inserted++ % kBetweenReports == 0 && progress &&
        !progress(static_cast<double>(inserted) / static_cast<double>(count)))
      return false;
    insertion.insert(v);
    return true;
  });
  if (!finished) return fail(ErrorCode::kInterrupted, "cancelled");
  PlanarTriangles triangles = insertion.take();
  std::vector<DVec2>().swap(places);
  result.mesh = canonical_mesh(std::move(triangles), count);
  return result;
}

Result<SwappedToDelaunay> swap_all(const HalfEdgeMesh& mesh, std::span<const DVec2> points,
                                   const Progress& progress) {
  if (!mesh.is_triangles() || points.size() != mesh.vertex_count())
    return fail(ErrorCode::kUnsuitable, "edges are swapped in triangles, with a point for each vertex");
  if (points.size() > kMostPoints || mesh.face_count() > 2 * kMostPoints) return too_many(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i])) return not_finite(i);
  const FilteredPredicates predicates(all_in_filter_range(points));
  const auto faces = static_cast<std::uint32_t>(mesh.face_count());
  const std::span<const std::uint32_t> corners = mesh.origins();
  for (std::size_t f = 0; f < faces; ++f)
    if (predicates.orientation(points[corners[3 * f]], points[corners[3 * f + 1]],
                               points[corners[3 * f + 2]]) <= 0)
      return fail(ErrorCode::kUnsuitable, "face " + std::to_string(f) + " does not turn counter-clockwise");
  // One triangle at infinity stands beyond all boundary edges; nobody asks what lies beyond it.
  PlanarTriangles triangles;
  triangles.count = faces + 1;
  triangles.origins = LargeArray<std::uint32_t>(corners.size() + 3);
  triangles.twins = LargeArray<std::uint32_t>(corners.size() + 3);
  std::copy(corners.begin(), corners.end(), triangles.origins.data());
  std::fill_n(triangles.origins.data() + corners.size(), 3, kInvalid);
  // Half-edges to look at, and which of them these are. The first are taken first.
  std::vector<std::uint32_t> waiting;
  waiting.reserve(corners.size());
  std::vector<bool> waits(4 * std::size_t{faces} + 4, false);
  const auto add = [&](std::uint32_t h) {
    if (waits[h]) return;
    waits[h] = true;
    waiting.push_back(h);
  };
  for (auto h = static_cast<std::uint32_t>(corners.size()); h-- > 0;) {
    const std::uint32_t t = mesh.twins()[h];
    triangles.twins[h] = t == kInvalid ? 4 * faces : t + t / 3;
    if (t != kInvalid && h < t) add(h + h / 3);
  }
  SwappedToDelaunay result;
  constexpr std::size_t kBetweenReports = 1 << 16;
  for (std::size_t steps = 0; !waiting.empty(); ++steps) {
    // How far it is nobody knows: swaps put edges back.
    if (steps % kBetweenReports == 0 && progress && !progress(0.5))
      return fail(ErrorCode::kInterrupted, "cancelled");
    const std::uint32_t h = waiting.back();
    waiting.pop_back();
    waits[h] = false;
    const std::uint32_t n = PlanarTriangles::next(h), m = PlanarTriangles::previous(h), u = triangles.twin(h);
    const std::uint32_t across = triangles.origin(PlanarTriangles::previous(u));
    if (across == kInvalid ||
        predicates.in_circle_perturbed(points[triangles.origin(m)], points[triangles.origin(h)],
                                       points[triangles.origin(n)], points[across]) <= 0)
      continue;
    triangles.swap(h);
    ++result.swaps;
    const std::uint32_t first = u & ~3u;
    for (const std::uint32_t side : {m, h, first + 1, first + 2}) add(side);
  }
  result.mesh = canonical_mesh(std::move(triangles), points.size());
  // Only where sheets lie upon each other can two vertices be joined twice.
  if (!validate(result.mesh)) return fail(ErrorCode::kUnsuitable, "triangles overlap");
  return result;
}

}  // namespace
}  // namespace detail

Result<DelaunayTriangulation> delaunay(std::span<const DVec2> points, const Progress& progress) {
  return detail::catching([&] { return detail::triangulate(points, progress); });
}

Result<SwappedToDelaunay> swap_to_delaunay(const HalfEdgeMesh& mesh, std::span<const DVec2> points,
                                           const Progress& progress) {
  return detail::catching([&] { return detail::swap_all(mesh, points, progress); });
}

}  // namespace vkmesh
