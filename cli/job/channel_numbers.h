// Numbers for the values of channels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/mesh/channel.h>

namespace vkmesh::cli {

/// For each element a number, the same for those that have the same values in all of these channels, which
/// have as many elements each; what is no number equals itself. O(n log n).
[[nodiscard]] std::vector<std::uint32_t> numbers_of_values(std::span<const Channel> channels);

}  // namespace vkmesh::cli
