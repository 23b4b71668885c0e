// The little that the engine needs to know of a SPIR-V module (Khronos, "SPIR-V Specification", 1.5).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/result.h>

namespace vkmesh::detail {

/// One instruction: `words[0]` holds its length and opcode.
struct SpirvInstruction {
  std::uint16_t opcode = 0;
  std::span<const std::uint32_t> words;
  std::size_t offset = 0;  ///< Where its first word stands in the module.
};

/// The instructions of a module in order. Errors: kUsage for what is no SPIR-V.
[[nodiscard]] Result<std::vector<SpirvInstruction>> spirv_instructions(std::span<const std::uint32_t> module);

struct SpirvKernel {
  std::string entry_point;
  std::uint32_t workgroup_size = 0;
  std::uint32_t push_constant_bytes = 0;  ///< Up to the end of the last member.
  bool bitcasts_pointers = false;         ///< bitcasts_pointers() of its instructions.
};

/// Whether some OpBitcast makes a pointer of a pointer: valid, but SwiftShader crashes on it.
[[nodiscard]] bool bitcasts_pointers(std::span<const SpirvInstruction> instructions);

/// Errors: kUsage unless there is one compute entry point, with a fixed workgroup of one dimension, and push
/// constants made of scalars, vectors, buffer addresses and structs of these.
[[nodiscard]] Result<SpirvKernel> inspect_spirv(std::span<const std::uint32_t> module);

struct FloatControls {
  bool round_to_nearest_even = false;
  bool keep_signed_zeros = false;
};

/// The module with these asked for, for 32-bit floats. `module` must have passed inspect_spirv(). Modules
/// older than SPIR-V 1.4, which would need an extension for it, stay as they are.
[[nodiscard]] std::vector<std::uint32_t> with_float_controls(std::span<const std::uint32_t> module,
                                                             const FloatControls& controls);

}  // namespace vkmesh::detail
