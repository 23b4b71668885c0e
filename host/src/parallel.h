// Loops over all cores. Every use writes each element from one iteration only, so the bytes do not depend on
// the number of threads.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace vkmesh::detail {

/// Calls body(begin, end) for ranges that cover [0, count) once, of about `grain` elements, on any threads.
template <class Body>
void parallel_ranges(std::size_t count, std::size_t grain, Body&& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

}  // namespace vkmesh::detail
