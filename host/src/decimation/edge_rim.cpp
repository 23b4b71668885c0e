#include "decimation/edge_rim.h"

#include <cstring>

#include "decimation/four_rows.h"

namespace vkmesh::detail {

std::uint32_t EdgeRim::set(const LargeArray<CollapseVertex>& vertices,
                           std::span<const std::uint32_t> around_p, std::span<const std::uint32_t> around_q) {
  at_p_ = around_p.size() - 1;
  faces_ = at_p_ + around_q.size() - 1;
  const std::size_t corners = faces_ + 2;
  // Whole blocks are copied, and four corners are turned at a time: what is beyond does not matter.
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
  std::uint32_t flags = 0;
  std::array<float, 4> sources;
  float *const x = x_.data(), *const y = y_.data(), *const z = z_.data();
  const CollapseVertex* const all = vertices.data();
  for (std::size_t k = 0; k < corners; k += 4) {
    std::array<const void*, 4> rows;
    for (std::size_t i = 0; i < 4; ++i) {
      const CollapseVertex& vertex = all[ids[k + i]];
      rows[i] = &vertex;
      flags |= vertex.source;
    }
    turn_four(rows, {x + k, y + k, z + k, sources.data()});
  }
  return flags;
}

}  // namespace vkmesh::detail
