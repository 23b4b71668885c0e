#include "core/spirv.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace vkmesh::detail {
namespace {

constexpr std::uint32_t kMagic = 0x07230203;
constexpr std::uint32_t kVersion14 = 0x00010400;
constexpr std::size_t kHeaderWords = 5;

enum Opcode : std::uint16_t {
  kOpEntryPoint = 15,
  kOpExecutionMode = 16,
  kOpCapability = 17,
  kOpTypeInt = 21,
  kOpTypeFloat = 22,
  kOpTypeVector = 23,
  kOpTypeStruct = 30,
  kOpTypePointer = 32,
  kOpVariable = 59,
  kOpMemberDecorate = 72,
  kOpBitcast = 124,
};

constexpr std::uint32_t kExecutionModelGlCompute = 5;
constexpr std::uint32_t kModeLocalSize = 17;
constexpr std::uint32_t kModeSignedZeroInfNanPreserve = 4461;
constexpr std::uint32_t kModeRoundingModeRte = 4462;
constexpr std::uint32_t kCapabilitySignedZeroInfNanPreserve = 4466;
constexpr std::uint32_t kCapabilityRoundingModeRte = 4467;
constexpr std::uint32_t kStoragePushConstant = 9;
constexpr std::uint32_t kStoragePhysicalStorageBuffer = 5349;
constexpr std::uint32_t kDecorationOffset = 35;

tl::unexpected<Error> unfit(const std::string& why) {
  return fail(ErrorCode::kUsage, "the SPIR-V cannot be a kernel: " + why);
}

std::uint32_t first_word(std::size_t words, std::uint16_t opcode) {
  return (static_cast<std::uint32_t>(words) << 16) | opcode;
}

/// The literal string that starts at `words[0]`.
std::string literal(std::span<const std::uint32_t> words) {
  std::string text;
  for (const std::uint32_t word : words)
    for (unsigned shift = 0; shift < 32; shift += 8) {
      const char c = static_cast<char>((word >> shift) & 0xffu);
      if (c == 0) return text;
      text += c;
    }
  return text;
}

/// Sizes of the types that push constants are made of.
class Types {
 public:
  void add(const SpirvInstruction& i) {
    if (i.words.size() >= 2 &&
        (i.opcode == kOpTypeInt || i.opcode == kOpTypeFloat || i.opcode == kOpTypeVector ||
         i.opcode == kOpTypeStruct || i.opcode == kOpTypePointer))
      types_[i.words[1]] = i;
    if (i.opcode == kOpMemberDecorate && i.words.size() == 5 && i.words[3] == kDecorationOffset)
      offsets_[{i.words[1], i.words[2]}] = i.words[4];
  }

  [[nodiscard]] std::optional<std::uint32_t> pointee(std::uint32_t pointer) const {
    const auto type = types_.find(pointer);
    if (type == types_.end() || type->second.opcode != kOpTypePointer || type->second.words.size() != 4)
      return {};
    return type->second.words[3];
  }

  [[nodiscard]] std::optional<std::uint32_t> bytes(std::uint32_t id, int depth = 0) const {
    const auto found = types_.find(id);
    if (found == types_.end() || depth > 8) return {};
    const auto& words = found->second.words;
    switch (found->second.opcode) {
      case kOpTypeInt:
      case kOpTypeFloat:
        if (words.size() < 3) return {};
        return words[2] / 8;
      case kOpTypePointer:
        if (words.size() < 3 || words[2] != kStoragePhysicalStorageBuffer) return {};
        return 8;
      case kOpTypeVector: {
        if (words.size() < 4) return {};
        const auto component = bytes(words[2], depth + 1);
        if (!component) return {};
        return *component * words[3];
      }
      case kOpTypeStruct: {
        std::uint32_t end = 0;
        for (std::uint32_t member = 0; member + 2 < words.size(); ++member) {
          const auto size = bytes(words[member + 2], depth + 1);
          const auto offset = offsets_.find({id, member});
          if (!size || offset == offsets_.end()) return {};
          end = std::max(end, offset->second + *size);
        }
        return end;
      }
      default:
        return {};
    }
  }

 private:
  std::map<std::uint32_t, SpirvInstruction> types_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> offsets_;
};

}  // namespace

Result<std::vector<SpirvInstruction>> spirv_instructions(std::span<const std::uint32_t> module) {
  if (module.size() < kHeaderWords || module[0] != kMagic) return unfit("it does not start like a module");
  std::vector<SpirvInstruction> instructions;
  for (std::size_t at = kHeaderWords; at < module.size();) {
    const std::size_t words = module[at] >> 16;
    if (words == 0 || words > module.size() - at)
      return unfit("the instruction at word " + std::to_string(at) + " is cut off");
    instructions.push_back({static_cast<std::uint16_t>(module[at] & 0xffffu), module.subspan(at, words), at});
    at += words;
  }
  return instructions;
}

bool bitcasts_pointers(std::span<const SpirvInstruction> instructions) {
  // Names and decorations come before all types. So behind a type, an instruction whose first word is that
  // type makes a value of it, whatever its opcode; and a value comes before its use.
  std::set<std::uint32_t> pointer_types, pointers;
  for (const SpirvInstruction& i : instructions) {
    if (i.opcode == kOpTypePointer && i.words.size() >= 2) pointer_types.insert(i.words[1]);
    if (i.words.size() < 3 || !pointer_types.contains(i.words[1])) continue;
    pointers.insert(i.words[2]);
    if (i.opcode == kOpBitcast && i.words.size() >= 4 && pointers.contains(i.words[3])) return true;
  }
  return false;
}

Result<SpirvKernel> inspect_spirv(std::span<const std::uint32_t> module) {
  VKMESH_TRY(const auto instructions, spirv_instructions(module));
  SpirvKernel kernel;
  kernel.bitcasts_pointers = bitcasts_pointers(instructions);
  Types types;
  std::optional<std::uint32_t> push_constants;
  std::size_t entry_points = 0;
  for (const SpirvInstruction& i : instructions) {
    types.add(i);
    if (i.opcode == kOpEntryPoint && i.words.size() >= 4) {
      ++entry_points;
      if (i.words[1] != kExecutionModelGlCompute) return unfit("it is no compute shader");
      kernel.entry_point = literal(i.words.subspan(3));
    }
    if (i.opcode == kOpExecutionMode && i.words.size() == 6 && i.words[2] == kModeLocalSize) {
      if (i.words[4] != 1 || i.words[5] != 1) return unfit("its workgroups have more than one dimension");
      kernel.workgroup_size = i.words[3];
    }
    if (i.opcode == kOpVariable && i.words.size() >= 4 && i.words[3] == kStoragePushConstant) {
      if (push_constants) return unfit("it has several blocks of push constants");
      push_constants = i.words[1];
    }
  }
  if (entry_points != 1) return unfit("it has " + std::to_string(entry_points) + " entry points");
  if (kernel.workgroup_size == 0) return unfit("its workgroup size is not fixed");
  if (!push_constants) return unfit("it has no push constants");
  const auto block = types.pointee(*push_constants);
  const auto bytes = block ? types.bytes(*block) : std::nullopt;
  if (!bytes) return unfit("its push constants hold a type that kernels do not take");
  kernel.push_constant_bytes = *bytes;
  return kernel;
}

std::vector<std::uint32_t> with_float_controls(std::span<const std::uint32_t> module,
                                               const FloatControls& controls) {
  std::vector<std::uint32_t> result(module.begin(), module.end());
  const auto instructions = spirv_instructions(module);
  if (!instructions || module[1] < kVersion14) return result;

  // Capabilities come first in a module; execution modes right after the entry points.
  std::size_t after_capabilities = kHeaderWords, after_entry_points = kHeaderWords;
  std::uint32_t entry_point = 0;
  for (const SpirvInstruction& i : *instructions) {
    const std::size_t end = i.offset + i.words.size();
    if (i.opcode == kOpCapability) after_capabilities = end;
    if (i.opcode == kOpEntryPoint) {
      after_entry_points = end;
      entry_point = i.words[2];
    }
  }
  std::vector<std::uint32_t> capabilities, modes;
  const auto ask = [&](std::uint32_t capability, std::uint32_t mode) {
    capabilities.insert(capabilities.end(), {first_word(2, kOpCapability), capability});
    modes.insert(modes.end(), {first_word(4, kOpExecutionMode), entry_point, mode, 32});
  };
  if (controls.round_to_nearest_even) ask(kCapabilityRoundingModeRte, kModeRoundingModeRte);
  if (controls.keep_signed_zeros) ask(kCapabilitySignedZeroInfNanPreserve, kModeSignedZeroInfNanPreserve);
  // From the back, so that the first place stays where it is.
  result.insert(result.begin() + static_cast<std::ptrdiff_t>(after_entry_points), modes.begin(), modes.end());
  result.insert(result.begin() + static_cast<std::ptrdiff_t>(after_capabilities), capabilities.begin(),
                capabilities.end());
  return result;
}

}  // namespace vkmesh::detail
