#include <algorithm>
#include <utility>

#include <vkmesh/passes/laplacian_smoothing.h>

#include "catching.h"
#include "parallel.h"
#include "passes/pass_input.h"

namespace vkmesh {
namespace {

// reciprocal(n) for each number of neighbours that occurs.
std::vector<float> reciprocals_of_counts(const NodeNeighbours& neighbours) {
  std::size_t most = 0;
  for (std::uint32_t v = 0; v < neighbours.vertex_count(); ++v)
    most = std::max(most, neighbours.of(VertexId(v)).size());
  std::vector<float> result(most + 1, 0.0f);
  for (std::size_t n = 1; n <= most; ++n) result[n] = reciprocal(static_cast<float>(n));
  return result;
}

}  // namespace

Result<std::vector<Vec3>> laplacian_smoothing(const NodeNeighbours& neighbours,
                                              std::span<const Vec3> positions,
                                              const LaplacianSmoothingOptions& options,
                                              const Progress& progress) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    if (!(options.lambda >= 0.0f && options.lambda <= 1.0f))
      return fail(ErrorCode::kUsage, "lambda must lie in [0, 1], not " + std::to_string(options.lambda));
    VKMESH_CHECK(detail::require_positions(positions, neighbours.vertex_count()));
    std::vector<Vec3> source(positions.size());
    VKMESH_CHECK(prepare_positions(positions, source));
    std::vector<Vec3> target(source.size());
    const std::vector<float> reciprocals = reciprocals_of_counts(neighbours);
    for (std::uint32_t step = 0; step < options.iterations; ++step) {
      if (progress && !progress(static_cast<double>(step) / options.iterations))
        return fail(ErrorCode::kInterrupted, "smoothing was interrupted");
      detail::parallel_ranges(source.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
          const Vec3 here = source[v];
          const auto around = neighbours.of(VertexId(v));
          if (around.empty() || (options.fix_boundary && neighbours.is_boundary(VertexId(v)))) {
            target[v] = here;
            continue;
          }
          Vec3 sum(0.0f);
          for (const std::uint32_t n : around) sum += source[n];
          const Vec3 mean = zero_below(sum * reciprocals[around.size()], VKMESH_TINY_COORDINATE);
          const Vec3 move = zero_below(options.lambda * (mean - here), VKMESH_TINY_COORDINATE);
          target[v] = zero_below(here + move, VKMESH_TINY_COORDINATE);
        }
      });
      std::swap(source, target);
    }
    return source;
  });
}

}  // namespace vkmesh
