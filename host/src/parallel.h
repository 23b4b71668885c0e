// Loops over all cores. Every use writes each element from one iteration only, so the bytes do not depend on
// the number of threads.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace vkmesh::detail {

/// Calls body(begin, end) for ranges that cover [0, count) once, of about `grain` elements, on any threads.
template <class Body>
void parallel_ranges(std::size_t count, std::size_t grain, Body&& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

/// The sum, in the order of the elements, of the parts that body(begin, end) returns for ranges that cover
/// [0, count) once. `Part` has `Part& operator+=(const Part&)` and is zero when default-made; for the same
/// bytes on any number of threads it must be associative.
template <class Part, class Body>
Part parallel_sum(std::size_t count, std::size_t grain, Body&& body) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, grain), Part{},
      [&](const tbb::blocked_range<std::size_t>& range, Part sum) {
        sum += body(range.begin(), range.end());
        return sum;
      },
      [](Part left, const Part& right) {
        left += right;
        return left;
      });
}

}  // namespace vkmesh::detail
