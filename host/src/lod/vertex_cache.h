// The order of faces that suits a renderer's caches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vkmesh::detail {

/// The faces, three indices each, in the order that meshoptimizer gives them for vertex caches; as they are
/// where vkmesh was built without it. No two faces have the same corners in the same order of turning.
/// O(n log n).
[[nodiscard]] std::vector<std::uint32_t> vertex_cache_order(std::span<const std::uint32_t> indices,
                                                            std::size_t vertices);

}  // namespace vkmesh::detail
