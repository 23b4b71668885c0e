// The rules of exact arithmetic (docs/exactness.md), checked in the SPIR-V of every embedded kernel.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <unistd.h>

#include "core/spirv.h"
#include "shaders.h"
#include "support/pointer_bitcast.h"

namespace vkmesh::test {
namespace {

// SPIR-V opcodes and decorations, by their numbers in the specification.
constexpr std::uint16_t kOpExtInst = 12, kOpCapability = 17, kOpTypeFloat = 22, kOpDecorate = 71;
constexpr std::uint32_t kNoContraction = 42;

/// Roundings of one 32-bit operation each, the same on every device as long as they are not fused.
const std::set<std::uint16_t> kMustNotContract = {129 /* OpFAdd */, 131 /* OpFSub */, 133 /* OpFMul */,
                                                  142 /* OpVectorTimesScalar */};

/// Whose rounding or order is left to the device.
bool is_forbidden(std::uint16_t opcode) {
  const bool division = opcode == 136 || opcode == 140 || opcode == 141;  // OpFDiv, OpFRem, OpFMod
  const bool products = opcode >= 143 && opcode <= 148;                   // matrices, outer product, OpDot
  const bool derivatives = opcode >= 207 && opcode <= 215;                // OpDPdx and its kin
  const bool atomics = opcode >= 227 && opcode <= 242;                    // OpAtomic*
  const bool float_atomics = opcode == 5614 || opcode == 5615 || opcode == 6035;
  const bool subgroups = (opcode >= 259 && opcode <= 271) || (opcode >= 333 && opcode <= 366);
  return division || products || derivatives || atomics || float_atomics || subgroups;
}

/// GLSL.std.450 functions that are exact. All others are refused: roots, transcendental functions, fma,
/// length, normalize, cross and so on; and min and max of floats, which may return either zero of two.
const std::set<std::uint32_t> kAllowedFunctions = {
    4 /* FAbs */,  5 /* SAbs */,  38 /* UMin */,   39 /* SMin */,
    41 /* UMax */, 42 /* SMax */, 44 /* UClamp */, 45 /* SClamp */};

/// What Vulkan 1.2 with bufferDeviceAddress offers, and no other feature.
const std::set<std::uint32_t> kAllowedCapabilities = {1 /* Shader */,
                                                      5347 /* PhysicalStorageBufferAddresses */};

const std::string kPointerBitcast = "a pointer is bitcast to a pointer, on which SwiftShader crashes";

/// Each breach of the rules, as a sentence.
std::vector<std::string> breaches(std::span<const std::uint32_t> module) {
  const auto instructions = detail::spirv_instructions(module);
  REQUIRE(instructions);
  std::set<std::uint32_t> not_contracted;
  for (const auto& i : *instructions)
    if (i.opcode == kOpDecorate && i.words[2] == kNoContraction) not_contracted.insert(i.words[1]);
  std::vector<std::string> found;
  for (const auto& i : *instructions) {
    const std::string at = " at word " + std::to_string(i.offset);
    if (kMustNotContract.contains(i.opcode) && !not_contracted.contains(i.words[2]))
      found.push_back("operation " + std::to_string(i.opcode) + " is not marked NoContraction" + at);
    if (is_forbidden(i.opcode)) found.push_back("operation " + std::to_string(i.opcode) + at);
    if (i.opcode == kOpExtInst && !kAllowedFunctions.contains(i.words[4]))
      found.push_back("function " + std::to_string(i.words[4]) + " of GLSL.std.450" + at);
    if (i.opcode == kOpCapability && !kAllowedCapabilities.contains(i.words[1]))
      found.push_back("capability " + std::to_string(i.words[1]) + at);
    if (i.opcode == kOpTypeFloat && i.words[2] != 32)
      found.push_back("a float of " + std::to_string(i.words[2]) + " bits" + at);
  }
  if (detail::bitcasts_pointers(*instructions)) found.push_back(kPointerBitcast);
  return found;
}

std::vector<std::uint32_t> copy_of(std::span<const std::uint32_t> module) {
  return {module.begin(), module.end()};
}

}  // namespace

TEST_CASE("shaders keep the rules of exact arithmetic", "[no-device]") {
  CHECK(shaders::kernels().size() >= 13);
  for (const KernelSource& source : shaders::kernels())
    for (const std::string& breach : breaches(source.spirv)) FAIL_CHECK(source.name << ": " << breach);
}

TEST_CASE("drawing shaders, which are not exact, bitcast no pointer to a pointer either", "[no-device]") {
  for (const KernelSource& source :
       {shaders::draw_corners_vert, shaders::draw_indexed_vert, shaders::draw_lines_frag,
        shaders::draw_lines_vert, shaders::draw_points_frag, shaders::draw_points_vert,
        shaders::draw_surface_frag}) {
    INFO(source.name);
    const auto instructions = detail::spirv_instructions(source.spirv);
    REQUIRE(instructions);
    CHECK(!detail::bitcasts_pointers(*instructions));
  }
}

TEST_CASE("a bitcast from pointer to pointer is seen", "[no-device]") {
  CHECK(breaches(with_pointer_bitcast(shaders::vertex_normals.spirv)) == std::vector{kPointerBitcast});
}

TEST_CASE("a breach of the rules is seen", "[no-device]") {
  const auto original = shaders::canary.spirv;
  REQUIRE(breaches(original).empty());
  const auto instructions = detail::spirv_instructions(original);
  REQUIRE(instructions);
  // Decorations of other results, such as conversions, are not needed and not missed.
  std::set<std::uint32_t> rounded;
  for (const auto& i : *instructions)
    if (kMustNotContract.contains(i.opcode)) rounded.insert(i.words[2]);
  std::set<std::string> kinds;
  for (const auto& i : *instructions) {
    std::vector<std::uint32_t> changed = copy_of(original);
    if (i.opcode == kOpDecorate && i.words[2] == kNoContraction && rounded.contains(i.words[1]))
      changed[i.offset + 2] = 0;  // RelaxedPrecision
    else if (i.opcode == 133)
      changed[i.offset] = (5u << 16) | 136u;  // x * y becomes x / y
    else if (i.opcode == kOpExtInst)
      changed[i.offset + 4] = 31;  // Sqrt
    else if (i.opcode == kOpTypeFloat)
      changed[i.offset + 2] = 64;
    else if (i.opcode == kOpCapability)
      changed[i.offset + 1] = 11;  // Int64
    else
      continue;
    INFO("instruction " << i.opcode << " at word " << i.offset);
    CHECK(breaches(changed).size() == 1);
    kinds.insert(std::to_string(i.opcode));
  }
  CHECK(kinds.size() == 5);
}

TEST_CASE("shaders are valid SPIR-V, as compiled and with float controls", "[no-device]") {
  if (std::system("command -v spirv-val > /dev/null 2>&1") != 0) {
    WARN("spirv-val is not installed (Debian's package spirv-tools): not checked");
    return;
  }
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("vkmesh_shader_" + std::to_string(getpid()) + ".spv");
  const auto is_valid = [&](std::span<const std::uint32_t> module) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(module.data()),
               static_cast<std::streamsize>(module.size_bytes()));
    const std::string command = "spirv-val --target-env vulkan1.2 '" + file.string() + "' > /dev/null 2>&1";
    return std::system(command.c_str()) == 0;
  };
  for (const KernelSource& source : shaders::kernels()) {
    INFO(source.name);
    CHECK(is_valid(source.spirv));
    for (const detail::FloatControls& controls :
         {detail::FloatControls{true, false}, detail::FloatControls{false, true},
          detail::FloatControls{true, true}}) {
      const auto patched = detail::with_float_controls(source.spirv, controls);
      const std::size_t asked =
          (controls.round_to_nearest_even ? 1u : 0u) + (controls.keep_signed_zeros ? 1u : 0u);
      CHECK(patched.size() == source.spirv.size() + 6 * asked);
      CHECK(is_valid(patched));
    }
  }
  std::vector<std::uint32_t> broken = copy_of(shaders::canary.spirv);
  broken.back() = 0;
  CHECK(!is_valid(broken));
  std::filesystem::remove(file);
}

}  // namespace vkmesh::test
