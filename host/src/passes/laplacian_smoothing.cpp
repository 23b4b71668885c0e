#include <algorithm>
#include <utility>

#include <vkmesh/passes/laplacian_smoothing.h>

#include "catching.h"
#include "parallel.h"
#include "passes/pass_input.h"
#include "passes/smoothing_input.h"

namespace vkmesh {
namespace {

using Ring = std::span<const std::uint32_t>;

// reciprocal(n) for each number of neighbours that occurs.
std::vector<float> reciprocals_of_counts(const NodeNeighbours& neighbours) {
  std::size_t most = 2;
  for (std::uint32_t v = 0; v < neighbours.vertex_count(); ++v)
    most = std::max(most, neighbours.of(VertexId(v)).size());
  std::vector<float> result(most + 1, 0.0f);
  for (std::size_t n = 1; n <= most; ++n) result[n] = reciprocal(static_cast<float>(n));
  return result;
}

Vec3 step_towards(Vec3 here, Vec3 sum, float reciprocal_weight, float factor) {
  const Vec3 mean = zero_below(sum * reciprocal_weight, VKMESH_TINY_COORDINATE);
  const Vec3 move = zero_below(factor * (mean - here), VKMESH_TINY_COORDINATE);
  return zero_below(here + move, VKMESH_TINY_COORDINATE);
}

// The cotangents at q and r of the triangle here, q, r.
struct Cotangents {
  float at_q = 0.0f, at_r = 0.0f;
};
Cotangents cotangents(Vec3 here, Vec3 q, Vec3 r) {
  const float twice_area = vector_length(area_vector(here, q, r));
  return {cotangent(corner_product(q, r, here), twice_area),
          cotangent(corner_product(r, here, q), twice_area)};
}

// One vertex by cotangent weights; `open`: there is no triangle between the last neighbour and the first.
Vec3 cotangent_step(std::span<const Vec3> p, Vec3 here, Ring ring, bool open, float factor) {
  const Vec3 last = p[ring.back()];
  Vec3 q = p[ring.front()];
  // The angle opposite each edge in the triangle before it, and in the one after it.
  float before = open ? 0.0f : cotangents(here, last, q).at_q;
  Vec3 sum(0.0f);
  float total = 0.0f;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec3 r = p[ring[k + 1 == ring.size() ? 0 : k + 1]];
    Cotangents after = cotangents(here, q, r);
    if (open && k + 1 == ring.size()) after = {};
    const float both = before + after.at_r;
    const float weight = both > VKMESH_TINY_WEIGHT ? both : 0.0f;
    sum += zero_below(weight * q, VKMESH_TINY_COORDINATE);
    total += weight;
    before = after.at_q;
    q = r;
  }
  return total == 0.0f ? here : step_towards(here, sum, reciprocal(total), factor);
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
    std::vector<Vec3> source(positions.size());
    VKMESH_CHECK(prepare_positions(positions, source));
    std::vector<Vec3> target(source.size());
    const std::vector<float> reciprocals = reciprocals_of_counts(neighbours);
    const bool uniform = options.weights == SmoothingWeights::kUniform;
    const auto stays = [&](std::uint32_t v, bool boundary) {
      return (boundary && options.fix_boundary) ||
             (!locked.empty() && ((locked[v / 32] >> (v % 32)) & 1u) != 0);
    };
    const auto step = [&](std::uint32_t i, float factor) -> Result<void> {
      if (progress && !progress(static_cast<double>(i) / options.iterations))
        return fail(ErrorCode::kInterrupted, "smoothing was interrupted");
      detail::parallel_ranges(source.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
          const Vec3 here = source[v];
          const Ring around = neighbours.of(VertexId(v));
          const bool boundary = neighbours.is_boundary(VertexId(v));
          if (around.empty() || stays(v, boundary)) {
            target[v] = here;
          } else if (boundary && options.boundary_along_itself) {
            const Vec3 sum = (Vec3(0.0f) + source[around.front()]) + source[around.back()];
            target[v] = step_towards(here, sum, reciprocals[2], factor);
          } else if (uniform) {
            Vec3 sum(0.0f);
            for (const std::uint32_t n : around) sum += source[n];
            target[v] = step_towards(here, sum, reciprocals[around.size()], factor);
          } else {
            target[v] = cotangent_step(source, here, around, boundary, factor);
          }
        }
      });
      std::swap(source, target);
      return {};
    };
    VKMESH_CHECK(detail::for_each_smoothing_step(options, step));
    return source;
  });
}

}  // namespace vkmesh
