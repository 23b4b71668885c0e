#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/detail/smoothing_input.h>
#include <vkmesh/passes/laplacian_smoothing.h>

#include "base/huge_pages.h"
#include "base/large_array.h"
#include "base/prefetch.h"
#include "passes/pass_input.h"
#include "passes/valence_groups.h"
#include "simd/copy_past_caches.h"
#include "simd/target_clones.h"

namespace vkmesh {
namespace {

float step_towards(float here, float sum, float reciprocal_weight, float factor) {
  const float mean = zero_below(sum * reciprocal_weight, VKMESH_TINY_COORDINATE);
  const float move = zero_below(factor * (mean - here), VKMESH_TINY_COORDINATE);
  return zero_below(here + move, VKMESH_TINY_COORDINATE);
}

// Moves all coordinates of some vertices.
VKMESH_CLONES void steps_towards(const float* here, const float* sums, float reciprocal_weight, float factor,
                                 std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = step_towards(here[i], sums[i], reciprocal_weight, factor);
}

using detail::RingChunk, detail::RingGroup, detail::RingPoints;
constexpr std::size_t kMost = RingGroup::kMost;
// Fewer may stay in the last cache from step to step.
constexpr std::size_t kFewVertices = std::size_t{1} << 20;

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

// By uniform weights, to the places of the group's vertices after `first`; `source` an array with one element
// more than there are vertices. `ends_only`: only the first neighbour and the last count. `Far`: positions
// come from memory.
template <bool Far>
void uniform_steps(const RingGroup& group, bool ends_only, float factor, const Vec3* source,
                   std::uint32_t first, Vec3* target) {
  Four here[kMost], sums[kMost], there[kMost];
  const std::uint32_t stride = ends_only ? std::max(group.valence - 1, 1u) : 1;
  const std::uint32_t end = ends_only ? stride + 1 : group.valence;
  const std::size_t count = group.vertices.size();
  const std::uint32_t* ring = group.rings.data();
  for (std::size_t i = 0; i < count; ++i, ring += group.valence) {
    // What lies near each other in a ring mostly does so in memory.
    if constexpr (Far)
      for (std::uint32_t k = 0; k < group.valence; k += 3)
        detail::prefetch(source + ring[k + detail::RingGroups::kRingsPast]);
    Four sum = Four::of(source + ring[0]);
    for (std::uint32_t k = stride; k < end; k += stride) sum += Four::of(source + ring[k]);
    sums[i] = sum;
    here[i] = Four::of(source + group.vertices[i]);
  }
  steps_towards(here[0].at, sums[0].at,
                exact::reciprocal(ends_only ? 2.0f : static_cast<float>(group.valence)), factor, 4 * count,
                there[0].at);
  for (std::size_t i = 0; i < count; ++i)
    target[group.vertices[i] - first] = {there[i].at[0], there[i].at[1], there[i].at[2]};
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
    const float each = exact::reciprocal(mean.total[i]);
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

// The same by cotangent weights.
void cotangent_steps(const NodeNeighbours& neighbours, const RingGroup& group, float factor,
                     const Vec3* source, std::uint32_t first, Vec3* target) {
  const std::size_t count = group.vertices.size();
  RingPoints here;
  here.take(group, source);
  Weighted mean;
  detail::go_around<Cotangents>(group, source, neighbours, here, compute,
                                [&](const RingPoints& q, const Cotangents& before, const Cotangents& after,
                                    std::size_t) { add(mean, q, before, after, count); });
  steps_towards(here, mean, factor, count);
  for (std::size_t i = 0; i < count; ++i) target[group.vertices[i] - first] = here[i];
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
    const std::size_t count = positions.size();
    // Each step goes from one array to another, and the last one to the result. One element more, so that the
    // last vertex is read as a vector register is.
    std::vector<Vec3> result = detail::large_vector<Vec3>(count + 1);
    detail::LargeArray<Vec3> other(count + 1);
    other[count] = Vec3(0.0f);
    Vec3 *source = result.data(), *target = other.data();
    if (options.iterations % 2 != 0 && options.mu == 0.0f) std::swap(source, target);
    VKMESH_CHECK(prepare_positions(positions, std::span(source, count)));
    std::vector<std::uint32_t> stay(neighbours.boundary_bits.size());
    for (std::size_t w = 0; w < stay.size(); ++w)
      stay[w] = (options.boundary == SmoothingBoundary::kFixed ? neighbours.boundary_bits[w] : 0u) |
                (locked.empty() ? 0u : locked[w]);
    const bool uniform = options.weights == SmoothingWeights::kUniform;
    const bool along_itself = options.boundary == SmoothingBoundary::kAlongItself;
    const detail::RingGroups groups(neighbours, stay, uniform || along_itself);
    const auto steps = [&](const RingChunk& chunk, float factor) {
      // Gathered near, so that what is far is written once and in order.
      std::array<Vec3, RingChunk::kMost> near;
      const std::uint32_t size = chunk.last - chunk.first;
      std::copy_n(source + chunk.first, size, near.begin());
      std::size_t ahead = chunk.first + groups.reach();
      for (const RingGroup& group : chunk.groups) {
        const bool ends_only = group.boundary && along_itself;
        if (!ends_only && !uniform) {
          cotangent_steps(neighbours, group, factor, source, chunk.first, near.data());
          continue;
        }
        const std::size_t last = std::min(ahead + group.vertices.size(), count);
        if (groups.reach() != 0 && ahead < last)
          detail::prefetch_for_later(source + ahead, (last - ahead) * sizeof(Vec3));
        ahead = last;
        groups.prefetch_rings_after(group);
        if (count < kFewVertices)
          uniform_steps<false>(group, ends_only, factor, source, chunk.first, near.data());
        else
          uniform_steps<true>(group, ends_only, factor, source, chunk.first, near.data());
      }
      if (count < kFewVertices)
        std::copy_n(near.begin(), size, target + chunk.first);
      else
        detail::copy_past_caches(&near[0].x, 3 * size, &target[chunk.first].x);
    };
    const auto step = [&](std::uint32_t i, float factor) -> Result<void> {
      if (progress && !progress(static_cast<double>(i) / options.iterations))
        return fail(ErrorCode::kInterrupted, "smoothing was interrupted");
      groups.for_each_chunk([&](const RingChunk& chunk) { steps(chunk, factor); });
      std::swap(source, target);
      return {};
    };
    VKMESH_CHECK(detail::for_each_smoothing_step(options, step));
    result.pop_back();
    return result;
  });
}

}  // namespace vkmesh
