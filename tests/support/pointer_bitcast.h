// SPIR-V as glslang makes it of one buffer reference constructed from another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "core/spirv.h"

namespace vkmesh::test {

/// The module with its first conversion of pointer, uvec2, pointer without the step between: it computes the
/// same. Fails the test where there is no such conversion.
inline std::vector<std::uint32_t> with_pointer_bitcast(std::span<const std::uint32_t> module) {
  constexpr std::uint16_t kOpBitcast = 124;
  std::vector<std::uint32_t> changed(module.begin(), module.end());
  const auto instructions = detail::spirv_instructions(module);
  REQUIRE(instructions);
  for (std::size_t k = 0; k + 1 < instructions->size(); ++k) {
    const auto &first = (*instructions)[k], &second = (*instructions)[k + 1];
    if (first.opcode != kOpBitcast || second.opcode != kOpBitcast || second.words[3] != first.words[2])
      continue;
    changed[second.offset + 3] = first.words[3];
    return changed;
  }
  FAIL("the module has no conversion of addresses");
  return changed;
}

}  // namespace vkmesh::test
