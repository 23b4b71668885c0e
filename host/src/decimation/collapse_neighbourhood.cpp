#include "decimation/collapse_neighbourhood.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "simd/target_clones.h"
#include "simd/transpose.h"

namespace vkmesh::detail {
namespace {

/// Where the corners `ids` lie, some at a time: beyond `count` come some more of them.
struct Corners {
  const VertexRecord* vertices;
  const std::uint32_t* ids;
  std::size_t count;
  std::array<float*, 3> to;
};

#if defined(VKMESH_HAS_CLONES)
__attribute__((target("avx2"))) CollapseNeighbourhood::Summary look_around(const Corners& corners,
                                                                           std::span<const std::uint32_t> p,
                                                                           const std::uint32_t* q) {
  using Eight = std::uint32_t __attribute__((vector_size(32)));
  using Four = std::uint64_t __attribute__((vector_size(32)));
  Eight flags{}, same{}, of_p;
  std::array<float, 8> sources;
  for (std::size_t k = 0; k < corners.count; k += 8) {
    std::array<const void*, 8> rows;
    for (std::size_t i = 0; i < 8; ++i) rows[i] = &corners.vertices[corners.ids[k + i]];
    turn_eight(rows, {corners.to[0] + k, corners.to[1] + k, corners.to[2] + k, sources.data()});
    Eight some;
    __builtin_memcpy(&some, sources.data(), sizeof some);
    flags |= some;
  }
  __builtin_memcpy(&of_p, p.data(), sizeof of_p);
  of_p |= reinterpret_cast<Eight>(Eight{0, 1, 2, 3, 4, 5, 6, 7} >= static_cast<std::uint32_t>(p.size()));
  for (std::size_t i = 0; i < 8; ++i) same |= reinterpret_cast<Eight>(of_p == Eight{} + q[i]);
  const auto any = [](const Four& words) { return words[0] | words[1] | words[2] | words[3]; };
  const std::uint64_t both = any(reinterpret_cast<Four>(flags));
  return {static_cast<std::uint32_t>(both | both >> 32), any(reinterpret_cast<Four>(same)) != 0};
}

__attribute__((target("default")))
#endif
CollapseNeighbourhood::Summary
look_around(const Corners& corners, std::span<const std::uint32_t> p, const std::uint32_t* q) {
  std::uint32_t flags = 0;
  std::array<float, 4> sources;
  for (std::size_t k = 0; k < corners.count; k += 4) {
    std::array<const void*, 4> rows;
    for (std::size_t i = 0; i < 4; ++i) {
      const VertexRecord& vertex = corners.vertices[corners.ids[k + i]];
      rows[i] = &vertex;
      flags |= vertex.source;
    }
    turn_four(rows, {corners.to[0] + k, corners.to[1] + k, corners.to[2] + k, sources.data()});
  }
  bool may_share = false;
  for (const std::uint32_t v : p.first(std::min<std::size_t>(p.size(), 8)))
    for (std::size_t i = 0; i < 8; ++i) may_share |= v == q[i];
  return {flags, may_share};
}

}  // namespace

CollapseNeighbourhood::Summary CollapseNeighbourhood::set(const LargeArray<VertexRecord>& vertices,
                                                          std::span<const std::uint32_t> around_p,
                                                          std::span<const std::uint32_t> around_q) {
  at_p_ = around_p.size() - 1;
  faces_ = at_p_ + around_q.size() - 1;
  const std::size_t corners = faces_ + 2;
  // Whole blocks are copied, and eight corners are turned at a time: what is beyond does not matter.
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
  for (std::size_t i = 0; i < 8; ++i) ids[faces_ + 1 + i] = around_p[at_p_ > 0 ? 1 : 0];
  return look_around({vertices.data(), ids, corners, {x_.data(), y_.data(), z_.data()}},
                     around_p.subspan(1, std::max<std::size_t>(around_p.size(), 2) - 2), around_q.data() + 1);
}

}  // namespace vkmesh::detail
