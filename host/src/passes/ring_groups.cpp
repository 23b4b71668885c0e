#include "passes/ring_groups.h"

#include <algorithm>
#include <array>

#include "large_pages.h"

namespace vkmesh::detail {
namespace {

// Of consecutive vertices, so that a chunk's positions stay in the cache while its groups are gone through.
constexpr std::size_t kChunk = 8192;
// Vertices of so many neighbours and more are rare, and stand alone.
constexpr std::uint32_t kMany = 16;

}  // namespace

RingGroups::RingGroups(const NodeNeighbours& neighbours, std::span<const std::uint32_t> left_out)
    : order_(large_vector<std::uint32_t>(neighbours.vertex_count())),
      chunks_((order_.size() + kChunk - 1) / kChunk) {
  const auto valence = [&](std::uint32_t v) { return neighbours.offsets[v + 1] - neighbours.offsets[v]; };
  const auto bit = [](std::span<const std::uint32_t> bits, std::uint32_t v) {
    return bits.empty() ? 0u : (bits[v / 32] >> (v % 32)) & 1u;
  };
  parallel_ranges(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const auto first = static_cast<std::uint32_t>(c * kChunk);
      const auto last = static_cast<std::uint32_t>(std::min(order_.size(), (c + 1) * kChunk));
      // A counting sort: inside before boundary, by number of neighbours, then what is left out.
      constexpr std::uint32_t kLeftOut = 2 * kMany + 2;
      const auto kind = [&](std::uint32_t v) {
        const bool out = valence(v) == 0 || bit(left_out, v) != 0;
        return out ? kLeftOut : bit(neighbours.boundary_bits, v) * (kMany + 1) + std::min(valence(v), kMany);
      };
      std::array<std::uint8_t, kChunk> kinds;
      std::array<std::uint32_t, kLeftOut + 2> at{};
      for (std::uint32_t v = first; v < last; ++v) {
        kinds[v - first] = static_cast<std::uint8_t>(kind(v));
        ++at[kinds[v - first] + 1u];
      }
      at[0] = first;
      for (std::uint32_t k = 0; k <= kLeftOut; ++k) at[k + 1] += at[k];
      for (std::uint32_t v = first; v < last; ++v) order_[at[kinds[v - first]]++] = v;
      // Now at[k] is where kind k ends.
      for (std::uint32_t k = 0, from = first; k < kLeftOut; from = at[k++]) {
        const bool many = k % (kMany + 1) == kMany;
        const std::uint32_t most = many ? 1 : static_cast<std::uint32_t>(RingGroup::kMost);
        for (std::uint32_t i = from; i < at[k]; i += most)
          chunks_[c].push_back(
              {std::span(order_).subspan(i, std::min(most, at[k] - i)), valence(order_[i]), k > kMany});
      }
    }
  });
}

}  // namespace vkmesh::detail
