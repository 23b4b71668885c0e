// Loops over all cores. Every use writes each element from one iteration only, so the bytes do not depend on
// the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include "base/tsan_happens_before.h"

namespace vkmesh::detail {

/// Calls body(begin, end) for ranges that cover [0, count) once, of about `grain` elements, on any threads.
template <class Body>
void parallel_ranges(std::size_t count, std::size_t grain, Body&& body) {
  Handover begun, ended;
  begun.give();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      const Handover::Work work(begun, ended);
                      body(range.begin(), range.end());
                    });
  ended.take();
}

/// The sum, in the order of the elements, of the parts that body(begin, end) returns for ranges that cover
/// [0, count) once. `Part` has `Part& operator+=(const Part&)` and is zero when default-made; for the same
/// bytes on any number of threads it must be associative.
template <class Part, class Body>
Part parallel_sum(std::size_t count, std::size_t grain, Body&& body) {
  Handover begun, ended;
  begun.give();
  Part all = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, grain), Part{},
      [&](const tbb::blocked_range<std::size_t>& range, Part sum) {
        const Handover::Work work(begun, ended);
        sum += body(range.begin(), range.end());
        return sum;
      },
      [&](Part left, const Part& right) {
        const Handover::Work work(ended, ended);
        left += right;
        return left;
      });
  ended.take();
  return all;
}

/// For consecutive ranges of `grain` elements that cover [0, count): make(begin, end, block) on any threads,
/// and then finish(begin, end, block) on one thread at a time, in the order of the ranges, while others make
/// what follows. `Block` is default-made and used again for later ranges.
template <class Block, class Make, class Finish>
void parallel_in_order(std::size_t count, std::size_t grain, Make&& make, Finish&& finish) {
  const std::size_t ranges = (count + grain - 1) / grain;
  // As ranges finish in order, the block of a range is free again when the one `in_flight` later begins.
  const std::size_t in_flight =
      std::min(ranges, 3 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
  if (ranges == 0) return;
  std::vector<Block> blocks(in_flight);
  std::vector<Handover> of_blocks(in_flight);
  Handover* const handovers = of_blocks.data();  // which no task has to ask the vector for
  Handover finished;
  for (Handover& handover : of_blocks) handover.give();
  std::size_t next = 0;
  const auto call = [&](auto& body, std::size_t range) {
    body(range * grain, std::min((range + 1) * grain, count), blocks[range % in_flight]);
  };
  tbb::parallel_pipeline(
      in_flight,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
        if (next == ranges) control.stop();
        return next++;
      }) & tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, [&](std::size_t range) {
        Handover& handover = handovers[range % in_flight];
        const Handover::Work work(handover, handover);
        call(make, range);
        return range;
      }) & tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order, [&](std::size_t range) {
        Handover& handover = handovers[range % in_flight];
        const Handover::Work work(handover, handover), in_order(finished, finished);
        call(finish, range);
      }));
  finished.take();
}

}  // namespace vkmesh::detail
