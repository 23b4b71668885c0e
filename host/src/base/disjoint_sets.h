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

  [[nodiscard]] std::size_t size() const { return parent_.size(); }

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

/// Sets numbered in ascending order of their smallest elements: the connected components of what was united.
struct NumberedSets {
  std::vector<std::uint32_t> of;   ///< The number of each element's set.
  std::vector<std::size_t> sizes;  ///< The number of elements of each set.
};

/// O(n log n) for n elements, in practice linear.
[[nodiscard]] inline NumberedSets number_sets(DisjointSets& sets) {
  NumberedSets result;
  result.of.resize(sets.size());
  for (std::uint32_t i = 0; i < result.of.size(); ++i) {
    const std::uint32_t first = sets.find(i);
    if (first == i) {
      result.of[i] = static_cast<std::uint32_t>(result.sizes.size());
      result.sizes.push_back(0);
    } else {
      result.of[i] = result.of[first];
    }
    ++result.sizes[result.of[i]];
  }
  return result;
}

}  // namespace vkmesh::detail
