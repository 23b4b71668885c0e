// Numbering equal rows of floats: what welding points and writing shared OBJ attributes have in common.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vkmesh::detail {

/// Gives equal rows of N floats one number each, in order of first appearance. Equal means equal bits, but
/// for 0 and -0, which are one. An open-addressed table of numbers only: the rows themselves stay with the
/// caller.
template <std::size_t N>
class DistinctRows {
 public:
  /// The number of `row`; `rows` are the distinct rows so far, to which the row is appended when it is new.
  template <class Rows>
  std::uint32_t number(const float* row, Rows& rows) {
    if (2 * (rows.size() + 1) > slots_.size()) grow(rows);
    std::size_t slot = hash(row) & (slots_.size() - 1);
    while (slots_[slot] != kFree) {
      if (equal(row, &rows[slots_[slot]][0])) return slots_[slot];
      slot = (slot + 1) & (slots_.size() - 1);
    }
    const auto id = static_cast<std::uint32_t>(rows.size());
    rows.emplace_back();
    std::copy_n(row, N, &rows.back()[0]);
    slots_[slot] = id;
    return id;
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;

  static std::uint32_t bits(float x) { return x == 0.0f ? 0u : std::bit_cast<std::uint32_t>(x); }

  static std::size_t hash(const float* row) {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (std::size_t i = 0; i < N; ++i) {
      h = (h ^ bits(row[i])) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }

  static bool equal(const float* a, const float* b) {
    for (std::size_t i = 0; i < N; ++i)
      if (bits(a[i]) != bits(b[i])) return false;
    return true;
  }

  template <class Rows>
  void grow(const Rows& rows) {
    slots_.assign(std::max<std::size_t>(1024, 2 * slots_.size()), kFree);
    for (std::size_t id = 0; id < rows.size(); ++id) {
      std::size_t slot = hash(&rows[id][0]) & (slots_.size() - 1);
      while (slots_[slot] != kFree) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<std::uint32_t>(id);
    }
  }

  std::vector<std::uint32_t> slots_;
};

}  // namespace vkmesh::detail
