#include "decimation/collapse_neighbourhood.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "simd/transpose.h"

namespace vkmesh::detail {

void CollapseNeighbourhood::set(const LargeArray<VertexRecord>& vertices, const OneRing& p,
                                const OneRing& q) {
  ring_p_ = p;
  ring_q_ = q;
  const std::size_t corners = faces() + 2;
  // Whole blocks are copied, and four corners are taken apart at a time: what is beyond does not matter.
  if (ids_.size() < corners + 2 * kBlock) {
    ids_.resize(2 * corners + 4 * kBlock);
    for (Lanes* lanes : {&x_, &y_, &z_}) lanes->resize(ids_.size());
  }
  std::uint32_t* const ids = ids_.data();
  const auto copy = [](std::span<const std::uint32_t> from, std::uint32_t* to) {
    std::memcpy(to, from.data(), kBlock * sizeof(std::uint32_t));
    for (std::size_t i = kBlock; i < from.size(); i += kBlock)
      [[unlikely]] std::memcpy(to + i, from.data() + i, kBlock * sizeof(std::uint32_t));
  };
  copy(p.vertices, ids);
  copy(q.vertices, ids + faces_at_p());  // which begins where that of p ends
  for (std::size_t i = 0; i < 4; ++i) ids[faces() + 1 + i] = p.vertices[p.size() > 1 ? 1 : 0];
  flags_ = 0;
  std::array<float, 4> sources;
  for (std::size_t k = 0; k < corners; k += 4) {
    std::array<const void*, 4> records;
    for (std::size_t i = 0; i < 4; ++i) {
      const VertexRecord& vertex = vertices[ids[k + i]];
      records[i] = &vertex;
      flags_ |= vertex.source;
    }
    transpose_records<4>(records, [&, to = std::array{&x_[k], &y_[k], &z_[k], sources.data()}](
                                      std::size_t word) { return to[word]; });
  }
  may_share_ = false;
  for (std::size_t i = 1; i < std::min(p.size() - 1, kCompared + 1); ++i)
    for (std::size_t k = 1; k < kCompared + 1; ++k) may_share_ |= p.vertices[i] == q.vertices.data()[k];
}

}  // namespace vkmesh::detail
