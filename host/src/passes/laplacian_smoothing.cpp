#include <algorithm>
#include <array>
#include <utility>

#include <vkmesh/passes/laplacian_smoothing.h>

#include "catching.h"
#include "parallel.h"
#include "passes/blocks.h"
#include "passes/clones.h"
#include "passes/pass_input.h"
#include "passes/smoothing_input.h"

namespace vkmesh {
namespace {

// Vertices moved together: few enough to stay in the cache, many enough to fill vector registers.
constexpr std::uint32_t kBlock = 128;

// What the neighbours of each vertex of a block add up to, and their weights; a vertex of no weight stays.
struct Sums {
  std::array<Vec3, kBlock> sum;
  std::array<float, kBlock> total;
};

VKMESH_CLONES void step_towards(const Sums& sums, float factor, std::span<const Vec3> here,
                                Vec3* __restrict there) {
  for (std::size_t i = 0; i < here.size(); ++i) {
    const Vec3 mean = zero_below(sums.sum[i] * reciprocal(sums.total[i]), VKMESH_TINY_COORDINATE);
    const Vec3 move = zero_below(factor * (mean - here[i]), VKMESH_TINY_COORDINATE);
    const Vec3 moved = zero_below(here[i] + move, VKMESH_TINY_COORDINATE);
    const bool stays = sums.total[i] == 0.0f;
    there[i] = {stays ? here[i].x : moved.x, stays ? here[i].y : moved.y, stays ? here[i].z : moved.z};
  }
}

class Step {
 public:
  Step(const NodeNeighbours& neighbours, const LaplacianSmoothingOptions& options)
      : neighbours_(neighbours), options_(options), stays_(options.locked.begin(), options.locked.end()) {
    stays_.resize(neighbours.boundary_bits.size(), 0);
    if (options.boundary == SmoothingBoundary::kFixed)
      for (std::size_t i = 0; i < stays_.size(); ++i) stays_[i] |= neighbours.boundary_bits[i];
  }

  void operator()(std::span<const Vec3> source, float factor, std::span<Vec3> target) const {
    detail::parallel_ranges(source.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
      Sums sums;
      detail::Fans fans;
      for (std::size_t first = begin; first < end; first += kBlock) {
        const std::size_t count = std::min<std::size_t>(kBlock, end - first);
        add_up(source, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(first + count), fans,
               sums);
        step_towards(sums, factor, source.subspan(first, count), target.data() + first);
      }
    });
  }

 private:
  void add_up(std::span<const Vec3> p, std::uint32_t begin, std::uint32_t end, detail::Fans& fans,
              Sums& sums) const {
    const bool uniform = options_.weights == SmoothingWeights::kUniform;
    if (!uniform) fans.gather(neighbours_, p, begin, end);
    std::size_t fan = 0;
    for (std::uint32_t v = begin; v < end; ++v) {
      const auto ring = neighbours_.of(VertexId(v));
      const bool boundary = neighbours_.is_boundary(VertexId(v));
      Vec3 sum(0.0f);
      float total = 0.0f;
      if (ring.empty() || ((stays_[v / 32] >> (v % 32)) & 1u) != 0) {
        // No weight.
      } else if (boundary && options_.boundary == SmoothingBoundary::kAlongItself) {
        sum = (sum + p[ring.front()]) + p[ring.back()];
        total = 2.0f;
      } else if (uniform) {
        for (const std::uint32_t n : ring) sum += p[n];
        total = static_cast<float>(ring.size());
      } else {
        add_up_fan(fans, fan, fan + ring.size(), boundary, sum, total);
      }
      sums.sum[v - begin] = sum, sums.total[v - begin] = total;
      fan += ring.size() + 1;
    }
  }

  // One vertex by cotangent weights; `open`: there is no triangle between the last neighbour and the first.
  static void add_up_fan(const detail::Fans& fans, std::size_t first, std::size_t end, bool open, Vec3& sum,
                         float& total) {
    // The angle opposite each edge in the triangle before it, and in the one after it.
    float before = open ? 0.0f : fans.at_q[end - 1];
    for (std::size_t t = first; t < end; ++t) {
      const float both = before + (open && t + 1 == end ? 0.0f : fans.at_r[t]);
      const float weight = both > VKMESH_TINY_WEIGHT ? both : 0.0f;
      sum += zero_below(weight * fans.around[t], VKMESH_TINY_COORDINATE);
      total += weight;
      before = fans.at_q[t];
    }
  }

  const NodeNeighbours& neighbours_;
  const LaplacianSmoothingOptions& options_;
  std::vector<std::uint32_t> stays_;  // Bit by bit, as in options.locked.
};

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
    std::vector<Vec3> source(positions.size());
    VKMESH_CHECK(prepare_positions(positions, source));
    std::vector<Vec3> target(source.size());
    const Step move_all(neighbours, options);
    const auto step = [&](std::uint32_t i, float factor) -> Result<void> {
      if (progress && !progress(static_cast<double>(i) / options.iterations))
        return fail(ErrorCode::kInterrupted, "smoothing was interrupted");
      move_all(source, factor, target);
      std::swap(source, target);
      return {};
    };
    VKMESH_CHECK(detail::for_each_smoothing_step(options, step));
    return source;
  });
}

}  // namespace vkmesh
