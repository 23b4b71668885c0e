// The vertices of a mesh in ranges, for loops over faces that add something up at their corners.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <tbb/task_arena.h>

#include "base/parallel.h"
#include "base/stop.h"

namespace vkmesh::detail {

/// A thread takes a range of vertices and all the blocks of faces with a corner in it, in order, so that each
/// vertex is written by one thread, and in the order of its faces: the bytes do not depend on how many
/// threads there are. Where neighbours stand near each other few faces are looked at twice.
class VertexRanges {
 public:
  VertexRanges() = default;
  struct Extent {
    std::uint32_t low = std::numeric_limits<std::uint32_t>::max(), high = 0;

    void add(std::uint32_t v) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
  };

  /// range_of(begin, end), called once for each block of faces on any threads, tells among which vertices
  /// their corners are.
  template <class RangeOf>
  VertexRanges(std::size_t vertex_count, std::size_t face_count, RangeOf&& range_of)
      : vertex_count_(vertex_count), face_count_(face_count), blocks_((face_count + kBlock - 1) / kBlock) {
    range_count_ = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    parallel_ranges(blocks_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        blocks_[b] = range_of(kBlock * b, std::min(kBlock * (b + 1), face_count));
    });
  }

  /// Calls body(range) once for each range, on any threads. Where `stop` is set meanwhile, what the loops
  /// over faces have still to come to is left out.
  template <class Body>
  void for_each(Body&& body, Stop* stop = nullptr) const {
    parallel_ranges(range_count_, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        body(Range{*this, static_cast<std::uint32_t>(vertex_count_ * i / range_count_),
                   static_cast<std::uint32_t>(vertex_count_ * (i + 1) / range_count_), stop});
    });
  }

  struct Range {
    const VertexRanges& all;
    std::uint32_t begin, end;
    Stop* stop;

    [[nodiscard]] bool has(std::uint32_t v) const { return v - begin < end - begin; }
    /// Calls f(begin, end) in ascending order for ranges of faces among which are all that have a corner in
    /// the range.
    template <class F>
    void for_each_range(F&& f) const {
      for (std::size_t b = 0; b < all.blocks_.size(); ++b) {
        if (all.blocks_[b].high < begin || all.blocks_[b].low >= end) continue;
        if (!goes_on(stop)) return;
        f(static_cast<std::uint32_t>(b * kBlock),
          static_cast<std::uint32_t>(std::min((b + 1) * kBlock, all.face_count_)));
      }
    }
    /// The same, face by face.
    template <class F>
    void for_each_face(F&& f) const {
      for_each_range([&](std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t face = first; face < last; ++face) f(face);
      });
    }
  };

 private:
  static constexpr std::size_t kBlock = 2048;
  std::size_t vertex_count_ = 0, face_count_ = 0, range_count_ = 1;
  std::vector<Extent> blocks_;
};

}  // namespace vkmesh::detail
