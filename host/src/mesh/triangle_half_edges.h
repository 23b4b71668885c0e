// Half-edges of triangles: 3f + i starts at corner i of triangle f.
#pragma once

#include <cstdint>

namespace vkmesh::detail {

[[nodiscard]] constexpr std::uint32_t next_in_triangle(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
[[nodiscard]] constexpr std::uint32_t previous_in_triangle(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

}  // namespace vkmesh::detail
