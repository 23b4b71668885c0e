#include "decimation/collapse_neighbourhood.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "simd/transpose.h"

namespace vkmesh::detail {

CollapseNeighbourhood::Summary CollapseNeighbourhood::set(const LargeArray<VertexRecord>& vertices,
                                                          std::span<const std::uint32_t> around_p,
                                                          std::span<const std::uint32_t> around_q) {
  at_p_ = around_p.size() - 1;
  faces_ = at_p_ + around_q.size() - 1;
  const std::size_t corners = faces_ + 2;
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
  copy(around_p, ids);
  copy(around_q, ids + at_p_);  // which begins where that of p ends
  for (std::size_t i = 0; i < 4; ++i) ids[faces_ + 1 + i] = around_p[at_p_ > 0 ? 1 : 0];
  Summary summary{};
  std::array<float, 4> sources;
  for (std::size_t k = 0; k < corners; k += 4) {
    std::array<const void*, 4> records;
    for (std::size_t i = 0; i < 4; ++i) {
      const VertexRecord& vertex = vertices[ids[k + i]];
      records[i] = &vertex;
      summary.flags |= vertex.source;
    }
    transpose_records<4>(records, [&, to = std::array{&x_[k], &y_[k], &z_[k], sources.data()}](
                                      std::size_t word) { return to[word]; });
  }
  for (std::size_t i = 1; i < std::min<std::size_t>(around_p.size() - 1, 9); ++i)
    for (std::size_t k = 1; k < 9; ++k) summary.may_share |= around_p[i] == around_q.data()[k];
  return summary;
}

}  // namespace vkmesh::detail
