#include "passes/valence_groups.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/prefetch.h"

namespace vkmesh::detail {
namespace {

// Vertices of so many neighbours and more are rare, and stand alone.
constexpr std::uint32_t kMany = 16;
// A counting sort: inside before boundary, by number of neighbours, then what is left out.
constexpr std::uint32_t kLeftOut = 2 * kMany + 2;

// How many vertices, of one in each group, have neighbours less than 2^k numbers ahead, and not less than
// 2^(k - 1).
struct Reaches {
  std::array<std::size_t, 33> count{};

  void add(std::uint32_t v, std::span<const std::uint32_t> ring) {
    const std::uint32_t farthest = std::max(v, *std::max_element(ring.begin(), ring.end()));
    ++count[static_cast<std::size_t>(std::bit_width(farthest - v))];
  }
  Reaches& operator+=(const Reaches& other) {
    for (std::size_t k = 0; k < count.size(); ++k) count[k] += other.count[k];
    return *this;
  }
  // The reach that serves all vertices but one in fifty.
  [[nodiscard]] std::size_t of_nearly_all() const {
    std::size_t all = 0, left = 0, k = count.size();
    for (const std::size_t n : count) all += n;
    while (k > 0 && left <= all / 50) left += count[--k];
    return std::size_t{1} << k;
  }
};

// So many positions of twelve bytes still leave room in a second cache, or a third.
constexpr std::size_t kFarthestReach = std::size_t{1} << 17;
// Rings are asked for so many numbers early: a read from memory ends before its turn comes.
constexpr std::size_t kRingsAhead = 2048;

}  // namespace

RingGroups::RingGroups(const NodeNeighbours& neighbours, std::span<const std::uint32_t> left_out,
                       bool copy_rings)
    : order_(neighbours.vertex_count()),
      rings_(copy_rings ? neighbours.ids.size() + kRingsPast : 0),
      chunks_((order_.size() + RingChunk::kMost - 1) / RingChunk::kMost) {
  const auto valence = [&](std::uint32_t v) { return neighbours.offsets[v + 1] - neighbours.offsets[v]; };
  const auto bit = [](std::span<const std::uint32_t> bits, std::uint32_t v) {
    return bits.empty() ? 0u : (bits[v / 32] >> (v % 32)) & 1u;
  };
  const auto kind = [&](std::uint32_t v) {
    const bool out = valence(v) == 0 || bit(left_out, v) != 0;
    return out ? kLeftOut : bit(neighbours.boundary_bits, v) * (kMany + 1) + std::min(valence(v), kMany);
  };
  const auto fill = [&](std::uint32_t first, RingChunk& chunk) {
    Reaches reaches;
    const auto last =
        static_cast<std::uint32_t>(std::min(order_.size(), std::size_t{first} + RingChunk::kMost));
    chunk.first = first, chunk.last = last;
    std::array<std::uint8_t, RingChunk::kMost> kinds;
    std::array<std::uint32_t, kLeftOut + 2> at{};
    for (std::uint32_t v = first; v < last; ++v) {
      kinds[v - first] = static_cast<std::uint8_t>(kind(v));
      ++at[kinds[v - first] + 1u];
    }
    at[0] = first;
    for (std::uint32_t k = 0; k <= kLeftOut; ++k) at[k + 1] += at[k];
    for (std::uint32_t v = first; v < last; ++v) order_[at[kinds[v - first]]++] = v;
    // Now at[k] is where kind k ends.
    std::size_t rings = neighbours.offsets[first];
    for (std::uint32_t k = 0, from = first; k < kLeftOut; from = at[k++]) {
      const bool many = k % (kMany + 1) == kMany;
      const std::uint32_t most = many ? 1 : static_cast<std::uint32_t>(RingGroup::kMost);
      for (std::uint32_t i = from; i < at[k]; i += most) {
        RingGroup group;
        group.vertices = std::span(&order_[i], std::min(most, at[k] - i));
        group.valence = valence(order_[i]);
        group.boundary = k > kMany;
        if (copy_rings) {
          group.rings = std::span(&rings_[rings], group.vertices.size() * group.valence);
          for (const std::uint32_t v : group.vertices) {
            // A call of memcpy for each would take longer.
            const std::uint32_t* const ring = &neighbours.ids[neighbours.offsets[v]];
            for (std::uint32_t n = 0; n < group.valence; ++n) rings_[rings + n] = ring[n];
            rings += group.valence;
          }
          reaches.add(group.vertices[0], group.rings.first(group.valence));
        }
        chunk.groups.push_back(group);
      }
    }
    if (copy_rings) std::fill(rings_.data() + rings, rings_.data() + neighbours.offsets[last], 0u);
    return reaches;
  };
  const auto reaches = parallel_sum<Reaches>(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    Reaches sum;
    for (std::size_t c = begin; c < end; ++c)
      sum += fill(static_cast<std::uint32_t>(c * RingChunk::kMost), chunks_[c]);
    return sum;
  });
  if (!copy_rings) return;
  std::fill_n(rings_.data() + neighbours.ids.size(), kRingsPast, 0u);
  reach_ = reaches.of_nearly_all();
  if (reach_ > kFarthestReach) reach_ = 0;
}

void RingGroups::prefetch_rings_after(const RingGroup& group) const {
  const auto begin = static_cast<std::size_t>(group.rings.data() - rings_.data()) + kRingsAhead;
  if (begin + group.rings.size() > rings_.size()) return;
  prefetch_for_later(&rings_[begin], group.rings.size_bytes());
}

}  // namespace vkmesh::detail
