#include "lod/vertex_cache.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#ifdef VKMESH_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

#include <vkmesh/lod/lod_chain.h>

namespace vkmesh {

bool has_vertex_cache_order() {
#ifdef VKMESH_HAS_MESHOPTIMIZER
  return true;
#else
  return false;
#endif
}

std::vector<std::uint32_t> detail::vertex_cache_order(std::span<const std::uint32_t> indices,
                                                      [[maybe_unused]] std::size_t vertices) {
  const std::size_t faces = indices.size() / 3;
  std::vector<std::uint32_t> order(faces);
  std::iota(order.begin(), order.end(), 0u);
#ifdef VKMESH_HAS_MESHOPTIMIZER
  std::vector<std::uint32_t> ordered(indices.size());
  meshopt_optimizeVertexCache(ordered.data(), indices.data(), indices.size(), vertices);
  // Which face each is: by its corners, the least first.
  using Key = std::array<std::uint32_t, 3>;
  const auto key_of = [](std::span<const std::uint32_t> from, std::uint32_t f) {
    Key key = {from[3 * std::size_t{f}], from[3 * std::size_t{f} + 1], from[3 * std::size_t{f} + 2]};
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    return key;
  };
  const auto sorted = [&](std::span<const std::uint32_t> from) {
    std::vector<std::pair<Key, std::uint32_t>> all;
    all.reserve(faces);
    for (std::uint32_t f = 0; f < faces; ++f) all.emplace_back(key_of(from, f), f);
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto before = sorted(indices), after = sorted(ordered);
  for (std::size_t i = 0; i < faces; ++i) order[after[i].second] = before[i].second;
#endif
  return order;
}

}  // namespace vkmesh
