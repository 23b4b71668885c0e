#include <algorithm>
#include <cstring>
#include <utility>

#include <vkmesh/passes/laplacian_smoothing.h>

#include "catching.h"
#include "large_pages.h"
#include "passes/clones.h"
#include "passes/pass_input.h"
#include "passes/ring_groups.h"
#include "passes/smoothing_input.h"

namespace vkmesh {
namespace {

float step_towards(float here, float sum, float reciprocal_weight, float factor) {
  const float mean = zero_below(sum * reciprocal_weight, VKMESH_TINY_COORDINATE);
  const float move = zero_below(factor * (mean - here), VKMESH_TINY_COORDINATE);
  return zero_below(here + move, VKMESH_TINY_COORDINATE);
}

// Of all coordinates of some vertices.
VKMESH_CLONES void steps_towards(const float* here, const float* sums, float reciprocal_weight, float factor,
                                 std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = step_towards(here[i], sums[i], reciprocal_weight, factor);
}

using detail::RingGroup, detail::RingPoints;
constexpr std::size_t kMost = RingGroup::kMost;

// A vertex and what follows it in memory, as one vector register holds them.
struct Four {
  float at[4];

  static Four of(const Vec3* position) {
    Four result;
    std::memcpy(result.at, static_cast<const void*>(position), sizeof(result.at));
    return result;
  }
  void operator+=(const Four& other) {
    for (std::size_t k = 0; k < 4; ++k) at[k] += other.at[k];
  }
};

// By uniform weights; from and to arrays with one element more than there are vertices. `ends_only`: only the
// first neighbour and the last count.
void uniform_steps(const NodeNeighbours& neighbours, const RingGroup& group, bool ends_only, float factor,
                   const Vec3* source, Vec3* target) {
  Four here[kMost], sums[kMost], there[kMost];
  const std::uint32_t* const ids = neighbours.ids.data();
  const std::uint32_t stride = ends_only ? std::max(group.valence - 1, 1u) : 1;
  const std::uint32_t end = ends_only ? stride + 1 : group.valence;
  const std::size_t count = group.vertices.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t v = group.vertices[i];
    const std::uint32_t* const ring = ids + neighbours.offsets[v];
    Four sum = Four::of(source + ring[0]);
    for (std::uint32_t k = stride; k < end; k += stride) sum += Four::of(source + ring[k]);
    sums[i] = sum;
    here[i] = Four::of(source + v);
  }
  steps_towards(here[0].at, sums[0].at, reciprocal(ends_only ? 2.0f : static_cast<float>(group.valence)),
                factor, 4 * count, there[0].at);
  for (std::size_t i = 0; i < count; ++i)
    target[group.vertices[i]] = {there[i].at[0], there[i].at[1], there[i].at[2]};
}

// The cotangents at q and r of the triangles here, q, r.
struct Cotangents {
  float at_q[kMost] = {}, at_r[kMost] = {};
};
VKMESH_CLONES void compute(Cotangents& out, const RingPoints& here, const RingPoints& q, const RingPoints& r,
                           std::size_t count) {
  Cotangents result;
  for (std::size_t i = 0; i < count; ++i) {
    const float twice_area = vector_length(area_vector(here[i], q[i], r[i]));
    result.at_q[i] = cotangent(corner_product(q[i], r[i], here[i]), twice_area);
    result.at_r[i] = cotangent(corner_product(r[i], here[i], q[i]), twice_area);
  }
  out = result;
}

// Sums of weighted neighbours, and of the weights.
struct Weighted {
  RingPoints sum = {};
  float total[kMost] = {};
};
VKMESH_CLONES void add(Weighted& out, const RingPoints& q, const Cotangents& before, const Cotangents& after,
                       std::size_t count) {
  Weighted result = out;
  for (std::size_t i = 0; i < count; ++i) {
    const float both = before.at_q[i] + after.at_r[i];
    const float weight = both > VKMESH_TINY_WEIGHT ? both : 0.0f;
    result.sum.set(i, result.sum[i] + zero_below(weight * q[i], VKMESH_TINY_COORDINATE));
    result.total[i] += weight;
  }
  out = result;
}
VKMESH_CLONES void steps_towards(RingPoints& here, const Weighted& mean, float factor, std::size_t count) {
  RingPoints result;
  for (std::size_t i = 0; i < count; ++i) {
    const float each = reciprocal(mean.total[i]);
    const bool stays = mean.total[i] == 0.0f;
    const auto step = [&](float from, float sum) {
      const float there = step_towards(from, sum, each, factor);
      return stays ? from : there;
    };
    const Vec3 from = here[i], sum = mean.sum[i];
    result.set(i, {step(from.x, sum.x), step(from.y, sum.y), step(from.z, sum.z)});
  }
  here = result;
}

// By cotangent weights.
void cotangent_steps(const NodeNeighbours& neighbours, const RingGroup& group, float factor,
                     const Vec3* source, Vec3* target) {
  const std::size_t count = group.vertices.size();
  RingPoints here;
  here.take(group, source);
  Weighted mean;
  detail::go_around<Cotangents>(group, source, neighbours, here, compute,
                                [&](const RingPoints& q, const Cotangents& before, const Cotangents& after,
                                    std::size_t) { add(mean, q, before, after, count); });
  steps_towards(here, mean, factor, count);
  for (std::size_t i = 0; i < count; ++i) target[group.vertices[i]] = here[i];
}

}  // namespace

Result<std::vector<Vec3>> laplacian_smoothing(const NodeNeighbours& neighbours,
                                              std::span<const Vec3> positions,
                                              const LaplacianSmoothingOptions& options,
                                              const Progress& progress) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(detail::require_smoothing_options(options));
    VKMESH_CHECK(detail::require_positions(positions, neighbours.vertex_count()));
    const auto locked = options.locked;
    if (!locked.empty() && locked.size() != neighbours.boundary_bits.size())
      return fail(ErrorCode::kUsage, std::to_string(locked.size()) + " words of locked vertices, not " +
                                         std::to_string(neighbours.boundary_bits.size()));
    // One more, so that the last is read as a vector register is.
    std::vector<Vec3> source = detail::large_vector<Vec3>(positions.size() + 1);
    VKMESH_CHECK(prepare_positions(positions, std::span(source).first(positions.size())));
    std::vector<Vec3> target = detail::large_vector<Vec3>(source.size());
    std::copy(source.begin(), source.end(), target.begin());
    std::vector<std::uint32_t> stay(neighbours.boundary_bits.size());
    for (std::size_t w = 0; w < stay.size(); ++w)
      stay[w] = (options.boundary == SmoothingBoundary::kFixed ? neighbours.boundary_bits[w] : 0u) |
                (locked.empty() ? 0u : locked[w]);
    const detail::RingGroups groups(neighbours, stay);
    const auto step = [&](std::uint32_t i, float factor) -> Result<void> {
      if (progress && !progress(static_cast<double>(i) / options.iterations))
        return fail(ErrorCode::kInterrupted, "smoothing was interrupted");
      groups.for_each([&](const RingGroup& group) {
        const bool ends_only = group.boundary && options.boundary == SmoothingBoundary::kAlongItself;
        if (ends_only || options.weights == SmoothingWeights::kUniform)
          uniform_steps(neighbours, group, ends_only, factor, source.data(), target.data());
        else
          cotangent_steps(neighbours, group, factor, source.data(), target.data());
      });
      std::swap(source, target);
      return {};
    };
    VKMESH_CHECK(detail::for_each_smoothing_step(options, step));
    source.pop_back();
    return source;
  });
}

}  // namespace vkmesh
