#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/planar/delaunay.h>

#include "base/large_array.h"
#include "base/parallel.h"
#include "base/prefetch.h"
#include "base/stop.h"
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

/// All vertices, as the limits of Insertion.
struct Everywhere {
  [[nodiscard]] static constexpr bool has(std::uint32_t) { return true; }
};
/// Vertices from `first` to `end`, which do not include the one at infinity.
struct Part {
  std::uint32_t first, end;
  [[nodiscard]] bool has(std::uint32_t v) const { return v - first < end - first; }
};

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

  /// Where one thread is: the triangle where it begins to walk, which is finite, and the first of those that
  /// it makes next.
  struct Place {
    std::uint32_t triangle, free;
  };

  /// The first triangle, of three points that turn counter-clockwise.
  Place begin(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    set_origins(0, {a, b, c});
    set_origins(1, {b, a, kInvalid});
    set_origins(2, {c, b, kInvalid});
    set_origins(3, {a, c, kInvalid});
    triangles_.count = 4;
    for (std::uint32_t i = 0; i < 3; ++i) {
      triangles_.set_twins(i, 4 * (i + 1));
      triangles_.set_twins(4 * (i + 1) + 2, 4 * ((i + 1) % 3 + 1) + 1);
    }
    return {0, 4};
  }

  /// Adds point v, which no vertex lies on. Changes triangles alone of which `limits` has all vertices; where
  /// that does not do, false, and nothing is changed.
  template <class Limits>
  bool insert(std::uint32_t v, Place& place, const Limits& limits) {
    const Found found = locate(points_[v], place.triangle, limits);
    if (found.half_edge == kInvalid) return false;
    const std::uint32_t h = found.half_edge, t = h >> 2, n = PlanarTriangles::next(h),
                        m = PlanarTriangles::previous(h);
    if (!found.on_edge) {
      const std::array<Side, 3> sides = {side(h), side(n), side(m)};
      surround(v, sides, {t, place.free, place.free + 1});
      place.free += 2;
      place.triangle = make_delaunay(t, 3, limits);
    } else {
      const std::uint32_t u = triangles_.twin(h);
      if (!has_triangle(u >> 2, limits)) return false;
      const std::array<Side, 4> sides = {side(n), side(m), side(PlanarTriangles::next(u)),
                                         side(PlanarTriangles::previous(u))};
      surround(v, sides, {t, place.free, u >> 2, place.free + 1});
      place.free += 2;
      place.triangle = make_delaunay(t, 4, limits);
    }
    return true;
  }

  /// A triangle for each part that has all its vertices there; kInvalid where there is none.
  [[nodiscard]] std::vector<std::uint32_t> triangles_of(std::span<const Part> parts) const {
    std::vector<std::uint32_t> found(parts.size(), kInvalid);
    std::size_t left = parts.size();
    for (std::uint32_t t = 0; t < triangles_.count && left > 0; ++t) {
      const std::uint32_t v = triangles_.origins[3 * std::size_t{t}];
      for (std::size_t k = 0; k < parts.size(); ++k)
        if (found[k] == kInvalid && parts[k].has(v) && has_triangle(t, parts[k])) {
          found[k] = t;
          --left;
        }
    }
    return found;
  }

  /// The number of triangles, those that are not made yet included.
  void set_count(std::uint32_t count) { triangles_.count = count; }
  /// Makes the triangles of so many points, from `first` on, be none until they are made.
  void leave_unmade(std::uint32_t first, std::uint32_t points) {
    std::fill_n(&triangles_.origins[3 * std::size_t{first}], 6 * std::size_t{points}, kInvalid);
    std::fill_n(&triangles_.twins[3 * std::size_t{first}], 6 * std::size_t{points}, 0u);
  }

  /// Swaps edges until all are Delaunay, where those of the hull are.
  void make_all_delaunay() {
    struct Block {
      std::vector<std::uint32_t> edges;
    };
    std::vector<std::uint32_t> waiting;
    parallel_in_order<Block>(
        triangles_.count, kTrianglesAtOnce,
        [&](std::size_t begin, std::size_t end, Block& block) {
          block.edges.clear();
          for (auto h = static_cast<std::uint32_t>(4 * begin); h < 4 * end; ++h)
            if ((h & 3u) != 3 && h < triangles_.twin(h) && is_edge_to_swap(h)) block.edges.push_back(h);
        },
        [&](std::size_t, std::size_t, Block& block) {
          waiting.insert(waiting.end(), block.edges.begin(), block.edges.end());
        });
    while (!waiting.empty()) {
      const std::uint32_t h = waiting.back();
      waiting.pop_back();
      if (!is_edge_to_swap(h)) continue;
      const std::uint32_t m = PlanarTriangles::previous(h), first = triangles_.twin(h) & ~3u;
      triangles_.swap(h);
      waiting.insert(waiting.end(), {m, h, first + 1, first + 2});
    }
  }

  PlanarTriangles take() { return std::move(triangles_); }

 private:
  static constexpr std::size_t kTrianglesAtOnce = 1 << 14;
  /// Steps of a walk within limits, which may go in circles where edges are not Delaunay.
  static constexpr std::size_t kMostSteps = 1 << 12;

  struct Found {
    std::uint32_t half_edge;  // of the triangle, or kInvalid
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
  template <class Limits>
  [[nodiscard]] bool has_triangle(std::uint32_t t, const Limits& limits) const {
    const std::uint32_t* const corner = &triangles_.origins[3 * std::size_t{t}];
    return limits.has(corner[0]) && limits.has(corner[1]) && limits.has(corner[2]);
  }

  /// Walks from a triangle over edges that p lies strictly beyond. It ends, where all is Delaunay (O.
  /// Devillers, S. Pion, M. Teillaud, "Walking in a triangulation", 2002).
  template <class Limits>
  [[nodiscard]] Found locate(DVec2 p, std::uint32_t from, const Limits& limits) const {
    constexpr bool kLimited = !std::is_same_v<Limits, Everywhere>;
    std::uint32_t h = 4 * from;
    int side_of_h = orientation(h, p);
    if (side_of_h < 0) {
      h = triangles_.twin(h);
      side_of_h = 1;
    }
    for (std::size_t steps = 0; !kLimited || steps < kMostSteps; ++steps) {
      const std::uint32_t n = PlanarTriangles::next(h), m = PlanarTriangles::previous(h);
      const std::uint32_t apex = triangles_.origin(m);
      if (!limits.has(apex)) break;
      if (!kLimited && apex == kInvalid) return {h, false};
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
    return {kInvalid, false};
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
  /// until all are Delaunay, or beyond the limits. Returns one of the triangles.
  template <class Limits>
  std::uint32_t make_delaunay(std::uint32_t t, int edges, const Limits& limits) {
    std::uint32_t last = t;
    while (edges > 0) {
      if (is_to_swap(t, limits)) {
        triangles_.swap(4 * t + 1);
        ++edges;
      } else {
        last = t;
        t = triangles_.twin(4 * t + 2) >> 2;
        --edges;
      }
    }
    while (triangles_.origins[3 * std::size_t{last} + 1] == kInvalid ||
           triangles_.origins[3 * std::size_t{last} + 2] == kInvalid)
      last = triangles_.twin(4 * last + 2) >> 2;
    return last;
  }
  template <class Limits>
  [[nodiscard]] bool is_to_swap(std::uint32_t t, const Limits& limits) const {
    const std::uint32_t* const corner = &triangles_.origins[3 * std::size_t{t}];
    const std::uint32_t v = corner[0], a = corner[1], b = corner[2];
    const std::uint32_t across = triangles_.origin(PlanarTriangles::previous(triangles_.twin(4 * t + 1)));
    if (!limits.has(across)) return false;
    if (((a | b | across) & kAtInfinity) == 0)
      return predicates_.in_circle_perturbed(points_[v], points_[a], points_[b], points_[across]) > 0;
    // The circle of an edge of the hull is the open half-plane beyond it.
    if (across == kInvalid) return false;
    return predicates_.orientation(points_[v], points_[a == kInvalid ? across : a],
                                   points_[b == kInvalid ? across : b]) > 0;
  }
  /// Whether an edge is not Delaunay; not of those that have a vertex at infinity.
  [[nodiscard]] bool is_edge_to_swap(std::uint32_t h) const {
    const std::uint32_t p = triangles_.origin(PlanarTriangles::previous(h)), q = triangles_.origin(h),
                        r = triangles_.origin(PlanarTriangles::next(h)),
                        s = triangles_.origin(PlanarTriangles::previous(triangles_.twin(h)));
    return ((p | q | r | s) & kAtInfinity) == 0 &&
           predicates_.in_circle_perturbed(points_[p], points_[q], points_[r], points_[s]) > 0;
  }

  static constexpr std::uint32_t kAtInfinity = 0x80000000u;

  const DVec2* points_;
  FilteredPredicates predicates_;
  PlanarTriangles triangles_;
};

/// Inserts all points but three in rounds: one of each 8^k numbers, then one of each 8^(k-1), and so on, each
/// round in order. Large rounds are cut into one part for each thread, whose points lie together, since the
/// numbers run along Hilbert's curve. A part leaves out what would change triangles that are not all its own:
/// some edges near the parts' borders are not Delaunay then, and are swapped after all parts, before the
/// points that were left out follow. The end is a function of the set of points, and so the same.
class Rounds {
 public:
  Rounds(std::span<const DVec2> places, Insertion& insertion, Insertion::Place place, Stop& stop)
      : count_(static_cast<std::uint32_t>(places.size())),
        insertion_(insertion),
        place_(place),
        stop_(stop),
        done_(places.size(), false) {}

  void mark_done(std::uint32_t v) { done_[v] = true; }

  Result<void> run() {
    unsigned bits = 0;
    while ((count_ >> bits) > 32) bits += kBitsOfRound;
    for (;; bits -= kBitsOfRound) {
      const std::size_t parts =
          bits > kMostBitsInParts
              ? 1
              : std::min<std::size_t>(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
                                      (count_ >> bits) / kLeastPart);
      VKMESH_CHECK(parts > 1 ? insert_in_parts(bits, parts) : insert_all(bits));
      if (bits == 0) break;
    }
    insertion_.set_count(place_.free);
    return {};
  }

 private:
  static constexpr unsigned kBitsOfRound = 3, kMostBitsInParts = 6;
  static constexpr std::size_t kLeastPart = 1 << 13, kBetweenReports = 1 << 14;
  static_assert(kBitsOfRound * 2 <= kMostBitsInParts);

  /// Calls use(v) for each point of the round from `first` to `end` that is not done, and marks it.
  template <class Use>
  void for_each_of_round(unsigned bits, std::size_t first, std::size_t end, Use&& use) {
    for (std::size_t begin = first; begin < end; begin += std::size_t{1} << bits) {
      std::uint64_t random = (begin + bits + 1) * 0x9e3779b97f4a7c15u;
      random = (random ^ random >> 32) * 0xd6e8feb86659fd93u;
      const std::size_t v = begin + (bits == 0 ? 0 : random >> (64 - bits));
      if (v >= end || done_[v]) continue;
      done_[v] = true;
      if (!use(static_cast<std::uint32_t>(v))) return;
    }
  }
  /// Tells of the progress now and then; false where that ends the work.
  [[nodiscard]] bool goes_on() {
    if (inserted_++ % kBetweenReports != 0) return true;
    stop_.report(static_cast<double>(inserted_) / count_);
    return !stop_.is_set();
  }

  Result<void> insert_all(unsigned bits) {
    for_each_of_round(bits, 0, count_, [&](std::uint32_t v) {
      insertion_.insert(v, place_, Everywhere());
      return goes_on();
    });
    return stop_.check();
  }

  Result<void> insert_in_parts(unsigned bits, std::size_t parts) {
    struct Work {
      std::vector<std::uint32_t> points, left_out;
      Insertion::Place place;
    };
    std::vector<Part> limits;
    // Whole words of the bits in done_, and whole strides.
    const auto border = [&](std::size_t k) {
      return k == parts ? count_ : static_cast<std::uint32_t>(std::uint64_t{count_} * k / parts / 64 * 64);
    };
    for (std::size_t k = 0; k < parts; ++k) limits.push_back({border(k), border(k + 1)});
    std::vector<Work> work(parts);
    parallel_ranges(parts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        for_each_of_round(bits, limits[k].first, limits[k].end, [&](std::uint32_t v) {
          work[k].points.push_back(v);
          return true;
        });
    });
    insertion_.set_count(place_.free);
    const std::vector<std::uint32_t> first = insertion_.triangles_of(limits);
    for (std::size_t k = 0; k < parts; ++k) {
      work[k].place = {first[k], place_.free};
      place_.free += 2 * static_cast<std::uint32_t>(work[k].points.size());
    }
    parallel_ranges(parts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Work& w = work[k];
        for (std::size_t i = 0; i < w.points.size(); ++i) {
          if (i % kBetweenReports == 0 && !detail::goes_on(&stop_)) return;
          if (first[k] == kInvalid || !insertion_.insert(w.points[i], w.place, limits[k]))
            w.left_out.push_back(w.points[i]);
        }
      }
    });
    VKMESH_CHECK(stop_.check());
    insertion_.set_count(place_.free);
    for (const Work& w : work) {
      insertion_.leave_unmade(w.place.free, static_cast<std::uint32_t>(w.left_out.size()));
      inserted_ += w.points.size();
    }
    insertion_.make_all_delaunay();
    for (const Work& w : work) {
      Insertion::Place at = {place_.triangle, w.place.free};
      for (const std::uint32_t v : w.left_out) insertion_.insert(v, at, Everywhere());
      place_.triangle = at.triangle;
    }
    stop_.report(static_cast<double>(inserted_) / count_);
    return stop_.check();
  }

  std::uint32_t count_;
  Insertion& insertion_;
  Insertion::Place place_;
  Stop& stop_;
  std::vector<bool> done_;
  std::size_t inserted_ = 0;
};

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
  const Insertion::Place place = insertion.begin(0, turn > 0 ? 1 : third, turn > 0 ? third : 1);
  Stop stop(progress, Stop::Clock::now(), std::numeric_limits<double>::infinity());
  Rounds rounds(places, insertion, place, stop);
  for (const std::uint32_t v : {0u, 1u, third}) rounds.mark_done(v);
  VKMESH_CHECK(rounds.run());
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
