// Sets of elements that are united step by step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace vkmesh::detail {

/// R. E. Tarjan, "Efficiency of a good but not linear set union algorithm" (1975), with path halving. The
/// smallest element of a set stands for it, so that the result does not depend on the order of unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t elements) : parent_(elements) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }

  /// The smallest element of the set of `i`. O(log n) amortised.
  [[nodiscard]] std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// True when they were not one set already.
  bool unite(std::uint32_t i, std::uint32_t j) {
    i = find(i);
    j = find(j);
    if (i == j) return false;
    if (j < i) std::swap(i, j);
    parent_[j] = i;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace vkmesh::detail
