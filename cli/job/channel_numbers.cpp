#include "job/channel_numbers.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <variant>

namespace vkmesh::cli {
namespace {

/// How the values of element a compare with those of b.
int compare(const Channel& channel, std::size_t a, std::size_t b) {
  return std::visit(
      [&](const auto& values) {
        for (std::size_t k = 0; k < channel.components; ++k) {
          const auto x = values[a * channel.components + k], y = values[b * channel.components + k];
          // What is no number comes first: an order must place it.
          const bool x_is_none = x != x, y_is_none = y != y;
          if (x_is_none != y_is_none) return x_is_none ? -1 : 1;
          if (x < y) return -1;
          if (y < x) return 1;
        }
        return 0;
      },
      channel.values);
}

}  // namespace

std::vector<std::uint32_t> numbers_of_values(std::span<const Channel> channels) {
  if (channels.empty()) return {};
  const std::size_t count = channels.front().scalar_count() / channels.front().components;
  std::vector<std::uint32_t> order(count), numbers(count);
  std::iota(order.begin(), order.end(), 0u);
  const auto compare_all = [&](std::uint32_t a, std::uint32_t b) {
    for (const Channel& channel : channels)
      if (const int c = compare(channel, a, b); c != 0) return c;
    return 0;
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return compare_all(a, b) < 0; });
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && compare_all(order[i - 1], order[i]) != 0) ++number;
    numbers[order[i]] = number;
  }
  return numbers;
}

}  // namespace vkmesh::cli
