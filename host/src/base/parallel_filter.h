// Which elements have a property.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel.h"

namespace vkmesh::detail {

/// The numbers below `count` that f(number) is true for, in ascending order; f is called on any threads.
template <class F>
std::vector<std::uint32_t> collect(std::size_t count, F&& f) {
  struct List {
    std::vector<std::uint32_t> all;
    List& operator+=(const List& after) {
      all.insert(all.end(), after.all.begin(), after.all.end());
      return *this;
    }
  };
  constexpr std::size_t kGrain = 1 << 15, kBlock = 1 << 10;
  return parallel_sum<List>(count, kGrain,
                            [&](std::size_t begin, std::size_t end) {
                              List list;
                              std::array<std::uint32_t, kBlock> some;
                              for (std::size_t first = begin; first < end; first += kBlock) {
                                std::size_t found = 0;  // branchless: the branch is unpredictable
                                for (std::size_t i = first; i < std::min(first + kBlock, end); ++i) {
                                  some[found] = static_cast<std::uint32_t>(i);
                                  found += f(some[found]) ? 1 : 0;
                                }
                                list.all.insert(list.all.end(), some.begin(), some.begin() + found);
                              }
                              return list;
                            })
      .all;
}

}  // namespace vkmesh::detail
