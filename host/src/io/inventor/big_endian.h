// Words of 4 bytes, the most significant first, as binary OpenInventor files hold them.
#pragma once

#include <cstdint>

namespace vkmesh::detail {

[[nodiscard]] inline std::uint32_t big_endian_word(const char* at) {
  std::uint32_t word = 0;
  for (int byte = 0; byte < 4; ++byte) word = (word << 8) | static_cast<unsigned char>(at[byte]);
  return word;
}

}  // namespace vkmesh::detail
