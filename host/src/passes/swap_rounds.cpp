#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/passes/swap_rounds.h>

#include "base/parallel.h"
#include "mesh/triangle_half_edges.h"
#include "passes/pass_input.h"
#include "passes/swap_geometry.h"

namespace vkmesh {
namespace {

using detail::faces_away;
using detail::next_in_triangle;
using detail::previous_in_triangle;
using detail::squared_distance;

constexpr std::size_t kGrain = std::size_t{1} << 13;

float smaller(float a, float b) {
  return b < a ? b : a;
}
float larger(float a, float b) {
  return b < a ? a : b;
}

/// The score of a triangle by the squares of its sides, the same bits in any order: the square of the sine of
/// the least angle, or 4√3 area over their sum. Sides are taken as shares of the longest.
float triangle_score(SwapCriterion criterion, float a, float b, float c) {
  const float low = smaller(a, b), high = larger(a, b);
  const float longest = larger(high, c);
  const float shortest = smaller(low, c), middle = larger(low, smaller(high, c));
  const float inverse = exact::reciprocal(longest);
  const float x = zero_below(shortest * inverse, VKMESH_TINY_LENGTH);
  const float y = zero_below(middle * inverse, VKMESH_TINY_LENGTH);
  const float sum = x + y;
  const float cosine = zero_below(sum - 1.0f, VKMESH_TINY_DIRECTION);
  const float area = zero_below((2.0f * x) * (2.0f * y) - cosine * cosine, VKMESH_TINY_AREA);
  const float positive = area > 0.0f ? area : 0.0f;  // 16 area² / longest⁴
  if (criterion == SwapCriterion::kMinAngle) return positive * exact::reciprocal(4.0f * y);
  return exact::root(3.0f * positive) * exact::reciprocal(sum + 1.0f);
}

class Rounds {
 public:
  Rounds(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, const SwapRoundsOptions& options)
      : positions_(positions),
        criterion_(options.criterion),
        corners_(mesh.origins().begin(), mesh.origins().end()),
        twins_(mesh.twins().begin(), mesh.twins().end()),
        leading_(mesh.leadings().begin(), mesh.leadings().end()),
        locked_(options.locked.begin(), options.locked.end()),
        gains_(corners_.size(), 0.0f),
        best_(positions.size()),
        changed_(corners_.size() / 3, 0),
        selected_(corners_.size(), 0),
        source_(corners_.size()),
        seen_(positions.size(), 0) {
    std::iota(source_.begin(), source_.end(), 0u);
    locked_.resize(corners_.size(), 0);
    for (std::uint32_t h = 0; h < twins_.size(); ++h)
      if (stands_for_edge(h)) active_.push_back(h);
  }

  /// The number of swaps of the next round.
  std::uint32_t run() {
    ++round_;
    parallel(active_.size(), [&](std::size_t i) { find_gain(active_[i]); });
    std::erase_if(active_, [&](std::uint32_t h) { return gains_[h] == 0.0f; });
    parallel(vertices_of_active(), [&](std::size_t i) { find_best(vertices_[i]); });
    parallel(active_.size(), [&](std::size_t i) { select(active_[i]); });
    const auto swaps = [&](std::uint32_t h) { return selected_[h] == round_; };
    parallel(active_.size(), [&](std::size_t i) {
      if (swaps(active_[i])) flip(active_[i]);
    });
    const auto count = static_cast<std::uint32_t>(std::ranges::count_if(active_, swaps));
    find_next_active();
    return count;
  }
  [[nodiscard]] std::vector<std::uint32_t> take_sources() { return std::move(source_); }
  [[nodiscard]] HalfEdgeMesh take_mesh() {
    return HalfEdgeMesh::from_twins(std::move(corners_), std::move(twins_), best_.size());
  }

 private:
  template <class F>
  static void parallel(std::size_t count, F&& f) {
    detail::parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) f(i);
    });
  }

  // The smaller half-edge stands for an edge.
  [[nodiscard]] bool stands_for_edge(std::uint32_t h) const { return twins_[h] != kInvalid && h < twins_[h]; }

  // The vertices of the quadrilaterals of active edges, each once; their number.
  std::size_t vertices_of_active() {
    vertices_.clear();
    for (const std::uint32_t h : active_)
      for (const std::uint32_t corner :
           {h, twins_[h], previous_in_triangle(h), previous_in_triangle(twins_[h])}) {
        const std::uint32_t v = corners_[corner];
        if (seen_[v] == round_) continue;
        seen_[v] = round_;
        vertices_.push_back(v);
      }
    return vertices_.size();
  }
  // Edges that gained and did not swap, and those of triangles that did: others gain nothing, as before. No
  // edge is of two quadrilaterals that were swapped.
  void find_next_active() {
    next_active_.clear();
    for (const std::uint32_t h : active_) {
      if (selected_[h] == round_) {
        const std::uint32_t t = twins_[h];
        for (const std::uint32_t side :
             {h, next_in_triangle(h), previous_in_triangle(h), next_in_triangle(t), previous_in_triangle(t)})
          if (twins_[side] != kInvalid) next_active_.push_back(std::min(side, twins_[side]));
      } else if (changed_[h / 3] != round_ && changed_[twins_[h] / 3] != round_) {
        next_active_.push_back(h);
      }
    }
    active_.swap(next_active_);
  }

  // What does not change stays from round to round, but for whether the new edge exists.
  void find_gain(std::uint32_t h) {
    const std::uint32_t t = twins_[h];
    const std::uint32_t a = corners_[previous_in_triangle(h)], b = corners_[previous_in_triangle(t)];
    if (round_ == 1 || changed_[h / 3] == round_ - 1 || changed_[t / 3] == round_ - 1)
      gains_[h] = locked_[h] != 0 || locked_[t] != 0 ? 0.0f : gain_of(corners_[h], corners_[t], a, b);
    // A gain whose sign is turned waits until that edge has gone.
    if (gains_[h] != 0.0f) gains_[h] = has_edge(a, b) ? -std::fabs(gains_[h]) : std::fabs(gains_[h]);
  }
  [[nodiscard]] float gain_of(std::uint32_t p, std::uint32_t q, std::uint32_t a, std::uint32_t b) const {
    const Vec3 at_p = positions_[p], at_q = positions_[q], at_a = positions_[a], at_b = positions_[b];
    const float qa = squared_distance(at_q, at_a), ap = squared_distance(at_a, at_p),
                pb = squared_distance(at_p, at_b), bq = squared_distance(at_b, at_q),
                pq = squared_distance(at_p, at_q), ab = squared_distance(at_a, at_b);
    const float before =
        smaller(triangle_score(criterion_, pq, qa, ap), triangle_score(criterion_, pq, pb, bq));
    const float after =
        smaller(triangle_score(criterion_, ab, ap, pb), triangle_score(criterion_, ab, bq, qa));
    const float gain = after - before;
    if (!(gain > 0.0f)) return 0.0f;
    const Vec3 mean = unit_vector(area_vector(at_p, at_q, at_a) + area_vector(at_q, at_p, at_b));
    const bool refused =
        faces_away(mean, area_vector(at_a, at_b, at_q)) || faces_away(mean, area_vector(at_b, at_a, at_p));
    return refused ? 0.0f : gain;
  }
  // The edges around a vertex, from its leading half-edge, which on the boundary starts the fan;
  // kMaxSwapValence of them at most. visit(half-edge that leaves v) ends the walk where it returns true.
  // Returns whether it came to an end.
  template <class Visit>
  [[nodiscard]] bool walk(std::uint32_t v, Visit&& visit) const {
    std::uint32_t h = leading_[v];
    if (h == kInvalid) return true;
    for (std::uint32_t steps = 0; steps < kMaxSwapValence; ++steps) {
      if (visit(h)) return true;
      h = twins_[previous_in_triangle(h)];
      if (h == kInvalid || h == leading_[v]) return true;
    }
    return false;
  }
  [[nodiscard]] bool has_edge(std::uint32_t a, std::uint32_t b) const {
    bool found = false;
    const bool ended = walk(a, [&](std::uint32_t h) {
      return found = corners_[next_in_triangle(h)] == b || corners_[previous_in_triangle(h)] == b;
    });
    return found || !ended;
  }
  void find_best(std::uint32_t v) {
    std::uint32_t best = kInvalid;
    float most = 0.0f;
    const bool ended = walk(v, [&](std::uint32_t h) {
      for (const std::uint32_t side : {h, next_in_triangle(h), previous_in_triangle(h)}) {
        const std::uint32_t t = twins_[side];
        if (t == kInvalid) continue;
        const std::uint32_t e = std::min(side, t);
        const float gain = gains_[e];
        if (gain > most || (gain == most && gain > 0.0f && e < best)) {
          most = gain;
          best = e;
        }
      }
      return false;
    });
    best_[v] = ended ? best : kInvalid;
  }
  void select(std::uint32_t h) {
    if (!(gains_[h] > 0.0f)) return;
    const std::uint32_t t = twins_[h];
    for (const std::uint32_t corner : {h, t, previous_in_triangle(h), previous_in_triangle(t)})
      if (best_[corners_[corner]] != h) return;
    selected_[h] = round_;
  }
  // As EditMesh::flip() does.
  void flip(std::uint32_t h) {
    const std::uint32_t t = twins_[h], nh = next_in_triangle(h), ph = previous_in_triangle(h),
                        nt = next_in_triangle(t), pt = previous_in_triangle(t);
    const std::uint32_t p = corners_[h], q = corners_[t], a = corners_[ph], b = corners_[pt];
    const std::uint32_t beyond_qa = twins_[nh], beyond_ap = twins_[ph], beyond_pb = twins_[nt],
                        beyond_bq = twins_[pt];
    const std::uint32_t lock_qa = locked_[nh], lock_ap = locked_[ph], lock_pb = locked_[nt],
                        lock_bq = locked_[pt];
    corners_[h] = corners_[nt] = b;
    corners_[nh] = corners_[t] = a;
    corners_[ph] = p;
    corners_[pt] = q;
    const std::uint32_t from_p = source_[h], from_q = source_[t], from_a = source_[ph], from_b = source_[pt];
    source_[h] = source_[nt] = from_b;
    source_[nh] = source_[t] = from_a;
    source_[ph] = from_p;
    source_[pt] = from_q;
    set_side(nh, beyond_ap, lock_ap);
    set_side(ph, beyond_pb, lock_pb);
    set_side(nt, beyond_bq, lock_bq);
    set_side(pt, beyond_qa, lock_qa);
    // One side leaves each vertex; on the boundary it leads.
    for (const std::uint32_t side : {nh, ph, nt, pt}) {
      std::uint32_t& leading = leading_[corners_[side]];
      if (twins_[side] == kInvalid || leading / 3 == h / 3 || leading / 3 == t / 3) leading = side;
    }
    changed_[h / 3] = changed_[t / 3] = round_;
  }
  void set_side(std::uint32_t side, std::uint32_t beyond, std::uint32_t lock) {
    twins_[side] = beyond;
    if (beyond != kInvalid) twins_[beyond] = side;
    locked_[side] = lock;
  }
  std::span<const Vec3> positions_;
  SwapCriterion criterion_;
  std::vector<std::uint32_t> corners_, twins_, leading_, locked_;
  std::vector<float> gains_;
  std::vector<std::uint32_t> best_, changed_, selected_, source_;
  std::vector<std::uint32_t> active_, next_active_;  // by the smaller half-edges
  std::vector<std::uint32_t> vertices_, seen_;       // seen_: by vertex, the last round
  std::uint32_t round_ = 0;
};

}  // namespace

Result<SwapRounds> swap_rounds(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                               const SwapRoundsOptions& options, const Progress& progress) {
  return detail::catching([&]() -> Result<SwapRounds> {
    VKMESH_CHECK(detail::require_triangles(mesh, "swap_rounds"));
    VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
    if (!options.locked.empty() && options.locked.size() != mesh.half_edge_count())
      return fail(ErrorCode::kUsage, "swap_rounds takes one word for each half-edge, or none");
    Rounds rounds(mesh, positions, options);
    SwapRounds result;
    while (result.swaps.size() < options.max_rounds) {
      result.swaps.push_back(rounds.run());
      if (result.swaps.back() == 0) break;
      // What is left is not known, but each round swaps fewer.
      const double share =
          static_cast<double>(result.swaps.back()) / static_cast<double>(result.swaps.front());
      if (progress && !progress(std::clamp(1 - share, 0.0, 1.0)))
        return fail(ErrorCode::kInterrupted, "cancelled");
    }
    result.source_corner = rounds.take_sources();
    result.mesh = rounds.take_mesh();
    return result;
  });
}

}  // namespace vkmesh
