// Greedy edge swaps: score, take the best, judge, swap, score again what changed.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/optimize/swap_edges.h>

#include "base/addressable_heap.h"
#include "base/huge_pages.h"
#include "base/parallel.h"
#include "base/stop.h"
#include "math/angle.h"
#include "mesh/edit/gather.h"
#include "optimize/swap_costs.h"
#include "optimize/swap_legality.h"
#include "optimize/swap_mesh.h"

namespace vkmesh {
namespace {

using namespace detail;

constexpr std::size_t kSwapsBetweenReports = 4096;

Result<void> check_options(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                           const SwapEdgesOptions& options) {
  if (!mesh.is_triangles())
    return fail(ErrorCode::kUnsuitable, "swap_edges takes triangles only: triangulate the polygons first");
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "swap_edges needs one position for each vertex");
  VKMESH_CHECK(check_positions(positions));
  const auto is_angle = [](const std::optional<double>& angle) {
    return !angle || (*angle > 0 && *angle <= std::numbers::pi);
  };
  if (options.costs.empty()) return fail(ErrorCode::kUsage, "swap_edges needs a cost to lower");
  for (const WeightedSwapCost& term : options.costs) {
    if (!(term.weight > 0 && term.weight <= 1e6))
      return fail(ErrorCode::kUsage, "swap_edges: weights are above 0, and 1e6 at most");
    if (term.cost == SwapCost::kNormalDeviation && options.normals.size() != mesh.vertex_count())
      return fail(ErrorCode::kUsage,
                  "swap_edges: the deviation from normals needs one normal for each vertex");
  }
  if (!is_angle(options.crease_angle) || !is_angle(options.max_dihedral_change))
    return fail(ErrorCode::kUsage, "swap_edges: angles are in (0, pi]");
  if (options.max_deviation && !(options.max_deviation->value >= 0))
    return fail(ErrorCode::kUsage, "swap_edges: the largest deviation is at least 0");
  if (options.seconds && !(*options.seconds >= 0))
    return fail(ErrorCode::kUsage, "swap_edges: the time is at least 0 seconds");
  return {};
}

/// The points in the unit of SwapCost, and that unit.
struct ScaledPoints {
  std::vector<DVec3> points;
  double unit = 1;
  double diagonal = 0;  // of the bounding box, in units of the positions
};

ScaledPoints scale(const SwapMesh& mesh, std::span<const Vec3> positions) {
  ScaledPoints result;
  DVec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (const std::uint32_t v : mesh.face(4 * f).origin) {
      low = glm::min(low, DVec3(positions[v]));
      high = glm::max(high, DVec3(positions[v]));
    }
  if (mesh.face_count() > 0) result.diagonal = glm::length(high - low);
  // Swaps do not change it, so that a second run finds the costs that the first left.
  const double unit = result.diagonal / std::sqrt(static_cast<double>(mesh.face_count()));
  if (unit > 0) result.unit = std::scalbn(1.0, std::ilogb(unit));
  result.points = large_vector<DVec3>(positions.size());
  parallel_ranges(positions.size(), std::size_t{1} << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) result.points[v] = DVec3(positions[v]) * (1 / result.unit);
  });
  return result;
}

/// Edges by what their swaps gain, each as the smaller of its half-edges.
class SwapQueue {
 public:
  SwapQueue(const SwapMesh& mesh, const SwapCosts& costs)
      : mesh_(mesh), costs_(costs), heap_(mesh.half_edge_bound()) {}

  void fill(Stop& stop) {
    using Gain = std::pair<std::uint32_t, std::int64_t>;
    struct Gains {
      std::vector<Gain> all;
      Gains& operator+=(const Gains& after) {
        all.insert(all.end(), after.all.begin(), after.all.end());
        return *this;
      }
    };
    const auto gains = parallel_sum<Gains>(
        mesh_.face_count(), std::size_t{1} << 13, [&](std::size_t begin, std::size_t end) {
          Gains some;
          stop.ask();
          if (stop.is_set()) return some;
          costs_.for_each_gain(begin, end,
                               [&](std::uint32_t h, std::int64_t gain) { some.all.emplace_back(h, gain); });
          return some;
        });
    for (const auto& [h, gain] : gains.all) heap_.append(h, priority_of(gain));
    heap_.heapify();
  }
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }
  [[nodiscard]] std::uint32_t top() const { return heap_.top(); }
  void remove(std::uint32_t h) { heap_.remove(edge_of(h)); }
  [[nodiscard]] std::uint32_t edge_of(std::uint32_t h) const { return std::min(h, mesh_.twin(h)); }
  /// Scores an edge again, given by the smaller of its half-edges.
  void update(std::uint32_t e) {
    if (const std::int64_t gain = costs_.gain(e); gain > 0)
      heap_.set(e, priority_of(gain));
    else
      heap_.remove(e);
  }

 private:
  [[nodiscard]] static float priority_of(std::int64_t gain) { return -static_cast<float>(gain); }

  const SwapMesh& mesh_;
  const SwapCosts& costs_;
  AddressableHeap<> heap_;
};

/// Follows the corners of the input through swaps.
class CornerSources {
 public:
  explicit CornerSources(std::size_t faces) : source_(large_vector<std::uint32_t>(4 * faces)) {
    for (std::uint32_t h = 0; h < source_.size(); ++h) source_[h] = h - h / 4;
  }
  /// Before the mesh flips h. Both of its faces have the same values at the ends of the edge.
  void swap(const SwapQuad& quad) {
    const auto& [h, t, p, q, a, b] = quad;
    const std::uint32_t at_p = source_[h], at_q = source_[t], at_a = source_[SwapMesh::previous(h)],
                        at_b = source_[SwapMesh::previous(t)];
    source_[h] = source_[SwapMesh::next(t)] = at_b;
    source_[t] = source_[SwapMesh::next(h)] = at_a;
    source_[SwapMesh::previous(h)] = at_p;
    source_[SwapMesh::previous(t)] = at_q;
  }
  [[nodiscard]] std::uint32_t operator[](std::uint32_t h) const { return source_[h]; }

 private:
  std::vector<std::uint32_t> source_;
};

/// One step of the greedy algorithm after the other.
class GreedySwaps {
 public:
  GreedySwaps(SwapMesh& mesh, std::span<const DVec3> points, SwapCosts& costs, const SwapBounds& bounds)
      : mesh_(mesh),
        points_(points),
        costs_(costs),
        bounds_(bounds),
        queue_(mesh, costs),
        sources_(mesh.face_count()) {}

  void fill(Stop& stop) { queue_.fill(stop); }
  /// Swaps the best edge, or drops it from the queue until something near it changes. False where there is
  /// none.
  bool step() {
    if (queue_.empty()) return false;
    const std::uint32_t h = queue_.top();
    queue_.remove(h);
    if (judge_swap(mesh_, points_, bounds_, h) == SwapReason::kNone)
      swap(h);
    else
      refused_.push_back(h);
    return true;
  }
  [[nodiscard]] std::size_t swaps() const { return swaps_; }
  /// How much is done, if what is in the queue now is all there is to do.
  [[nodiscard]] double fraction() {
    const auto done = static_cast<double>(swaps_);
    return fraction_ = std::max(fraction_, done / (done + static_cast<double>(queue_.size()) + 1));
  }
  [[nodiscard]] const CornerSources& sources() const { return sources_; }
  /// What forbids the swaps that would still lower the cost, each once.
  [[nodiscard]] std::array<std::size_t, kSwapReasons> blocked() {
    std::array<std::size_t, kSwapReasons> counts{};
    for (std::uint32_t& h : refused_) h = queue_.edge_of(h);
    std::ranges::sort(refused_);
    std::uint32_t last = kInvalid;
    for (const std::uint32_t h : refused_) {
      if (h == last) continue;
      last = h;
      if (mesh_.is_ghost(mesh_.twin(h)) || costs_.gain(h) <= 0) continue;
      if (const SwapReason reason = judge_swap(mesh_, points_, bounds_, h); reason != SwapReason::kNone)
        ++counts[static_cast<std::size_t>(reason)];
    }
    return counts;
  }

 private:
  void swap(std::uint32_t h) {
    const SwapQuad quad(mesh_, h);
    // The sides move to other half-edges, by which the queue knows them.
    for (const std::uint32_t side : quad.sides()) queue_.remove(side);
    sources_.swap(quad);
    costs_.swap(h);
    ++swaps_;
    changed_.clear();
    const auto add = [&](std::uint32_t e) { changed_.push_back(queue_.edge_of(e)); };
    costs_.for_each_changed(h, add);
    for_each_freed(quad.p, quad.q, add);
    std::ranges::sort(changed_);
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (const std::uint32_t e : changed_) queue_.update(e);
  }
  /// Calls f for the edges whose swap would make the edge between p and q, which no longer exists.
  template <class F>
  void for_each_freed(std::uint32_t p, std::uint32_t q, F&& f) const {
    const std::uint32_t first = mesh_.vertices[p].leading;
    std::uint32_t h = first;
    do {
      const std::uint32_t across = SwapMesh::next(h), beyond = mesh_.twin(across);
      if (!mesh_.is_ghost(h) && !mesh_.is_ghost(beyond) && mesh_.origin(SwapMesh::previous(beyond)) == q)
        f(across);
      h = mesh_.around_vertex(h);
    } while (h != first);
  }

  SwapMesh& mesh_;
  std::span<const DVec3> points_;
  SwapCosts& costs_;
  SwapBounds bounds_;
  SwapQueue queue_;
  CornerSources sources_;
  std::size_t swaps_ = 0;
  double fraction_ = 0;
  std::vector<std::uint32_t> changed_;
  std::vector<std::uint32_t> refused_;  // half-edges, perhaps of other edges meanwhile
};

Result<SwappedEdges> swap(const HalfEdgeMesh& given, std::span<const Vec3> positions,
                          const SwapEdgesOptions& options, const Progress& progress) {
  const auto begun = Stop::Clock::now();
  VKMESH_CHECK(check_options(given, positions, options));
  Stop stop(progress, begun, options.seconds.value_or(std::numeric_limits<double>::infinity()));
  SwapMesh mesh;
  if (!mesh.build(given))
    return fail(ErrorCode::kUnsuitable, "swap_edges takes at most 2^28 vertices and 2^29 faces");
  const ScaledPoints scaled = scale(mesh, positions);
  VKMESH_CHECK(tag_kept_edges(mesh, scaled.points, options));
  VKMESH_CHECK(stop.check());
  std::vector<DVec3> normals;
  for (const Vec3& normal : options.normals) normals.push_back(unit_or_zero(DVec3(normal)));
  SwapCosts costs(mesh, scaled.points, options.costs, normals);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const SwapBounds bounds{
      options.max_dihedral_change.value_or(kNone),
      options.max_deviation ? options.max_deviation->in_units(scaled.diagonal) / scaled.unit : kNone};
  SwappedEdges result;
  result.cost_before = costs.total();

  GreedySwaps swaps(mesh, scaled.points, costs, bounds);
  swaps.fill(stop);
  const std::size_t most = options.max_swaps.value_or(std::numeric_limits<std::size_t>::max());
  const bool none_left = run_steps(
      stop, kSwapsBetweenReports, [&] { return stop.is_set() || swaps.swaps() >= most; },
      [&] { return swaps.step(); }, [&] { return swaps.fraction(); });
  VKMESH_CHECK(stop.check());

  result.stop = none_left               ? SwapStop::kNoGain
                : swaps.swaps() >= most ? SwapStop::kMaxSwaps
                                        : SwapStop::kTimeLimit;
  result.swaps = swaps.swaps();
  result.cost_after = costs.total();
  result.blocked = swaps.blocked();
  result.source_corner = large_vector<std::uint32_t>(3 * mesh.face_count());
  for (std::uint32_t c = 0; c < result.source_corner.size(); ++c)
    result.source_corner[c] = swaps.sources()[c + c / 3];
  result.mesh = gather(mesh).mesh;
  stop.report(1);
  return result;
}

}  // namespace

std::string name_of(SwapReason reason) {
  constexpr std::array kNames = {"none",
                                 "boundary",
                                 "locked",
                                 "crease",
                                 "seam",
                                 "material border",
                                 "outside the region",
                                 "the edge exists",
                                 "not convex",
                                 "fold-over",
                                 "dihedral change",
                                 "deviation"};
  return kNames[static_cast<std::size_t>(reason)];
}

std::string name_of(SwapStop stop) {
  constexpr std::array kNames = {"no gain", "number of swaps", "time limit"};
  return kNames[static_cast<std::size_t>(stop)];
}

Result<SwappedEdges> swap_edges(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                const SwapEdgesOptions& options, const Progress& progress) {
  return catching([&] { return swap(mesh, positions, options, progress); });
}

}  // namespace vkmesh
