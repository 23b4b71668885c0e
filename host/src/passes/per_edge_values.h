// One number for every edge, computed for many edges at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/mesh/half_edge_mesh.h>

#include "base/huge_pages.h"
#include "base/parallel.h"

namespace vkmesh::detail {

/// Edges that are computed side by side, few enough to stay in the first cache.
inline constexpr std::size_t kEdgeBlock = 128;

/// A value for each half-edge, twins alike, on all cores. `Block` holds what kEdgeBlock edges need: take(i,
/// h) fills its place i for the edge of h, the smaller of its half-edges, and compute(count, out) makes the
/// values of the first `count`. Boundary edges get `boundary`, unless `boundary_computed`.
template <class Block, class Take, class Compute>
std::vector<float> edge_values(const HalfEdgeMesh& mesh, bool boundary_computed, float boundary, Take&& take,
                               Compute&& compute) {
  const auto twins = mesh.twins();
  std::vector<float> values = large_vector<float>(mesh.half_edge_count());
  parallel_ranges(values.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    Block block;
    std::array<std::uint32_t, kEdgeBlock> edges;
    std::array<float, kEdgeBlock> out;
    std::size_t count = 0;
    const auto finish = [&] {
      compute(static_cast<const Block&>(block), count, std::span(out));
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t h = edges[i], t = twins[h];
        values[h] = out[i];
        if (t != kInvalid) values[t] = out[i];
      }
      count = 0;
    };
    for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
      const std::uint32_t t = twins[h];
      if (t < h) continue;
      if (t == kInvalid && !boundary_computed) {
        values[h] = boundary;
        continue;
      }
      edges[count] = h;
      take(block, count, h);
      if (++count == kEdgeBlock) finish();
    }
    finish();
  });
  return values;
}

}  // namespace vkmesh::detail
