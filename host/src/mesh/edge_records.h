// The edges of all faces, sorted: what matching, repair and topology have in common.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/mesh/handles.h>
#include <vkmesh/mesh/indexed_face_set.h>

#include "base/stop.h"

namespace vkmesh::detail {

/// Errors: kUsage for corners that name no point or offsets that do not ascend from 0 to the number of
/// corners; kUnsuitable for more than 2^32 - 2 corners or points.
Result<void> check_face_set(std::size_t point_count, std::span<const std::uint32_t> corners,
                            std::span<const std::uint32_t> face_offsets);

/// Fewer than three corners, or a point repeated. O(n) for triangles, O(n log n) for n corners.
[[nodiscard]] bool is_degenerate(std::span<const std::uint32_t> face);

/// The face of each corner, and so of the half-edge that starts there. Looked up for polygons only.
class FaceOfCorner {
 public:
  /// O(1) for triangles, else O(corners).
  explicit FaceOfCorner(const IndexedFaceSet& mesh);
  [[nodiscard]] std::uint32_t operator()(std::uint32_t corner) const {
    return faces_.empty() ? corner / 3 : faces_[corner];
  }

 private:
  std::vector<std::uint32_t> faces_;  ///< Empty for triangles.
};

/// Calls visit(half-edge, from, to) for each edge of the faces [first, last), in order.
template <class Visit>
void for_each_edge(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> offsets,
                   std::size_t first, std::size_t last, Visit&& visit) {
  if (offsets.empty()) {
    for (auto h = static_cast<std::uint32_t>(3 * first); h < 3 * last; h += 3) {
      const std::uint32_t a = corners[h], b = corners[h + 1], c = corners[h + 2];
      visit(h, a, b);
      visit(h + 1, b, c);
      visit(h + 2, c, a);
    }
  } else {
    for (std::size_t f = first; f < last; ++f)
      for (std::uint32_t h = offsets[f]; h < offsets[f + 1]; ++h)
        visit(h, corners[h], corners[h + 1 == offsets[f + 1] ? offsets[f] : h + 1]);
  }
}

/// A record for each edge of each face, filed under the smaller of its points: the larger point above, the
/// half-edge below, so that the plain order of the 64-bit words is the order wanted.
struct EdgeRecords {
  /// Stands for the other end of an edge that joins a point to itself: such edges take no part.
  static constexpr std::uint32_t kLoop = kInvalid;

  std::vector<std::uint64_t> records;
  std::vector<std::uint32_t> end;  ///< Where the records of each point end.

  [[nodiscard]] std::span<std::uint64_t> of(std::size_t point) {
    const std::size_t begin = point == 0 ? 0 : end[point - 1];
    return {records.data() + begin, end[point] - begin};
  }

  /// Sorts the records of the points [first, last), and calls visit(a, b, uses) for each edge among them in
  /// ascending order of (a, b), a < b; the half-edge of a use is its lower half. Different points may be
  /// visited by different threads.
  template <class Visit>
  void for_each_group(std::size_t first, std::size_t last, Visit&& visit) {
    for (std::size_t a = first; a < last; ++a) {
      const std::span<std::uint64_t> all = of(a);
      sort_records(all);
      for (auto i = all.begin(); i != all.end();) {
        const auto b = static_cast<std::uint32_t>(*i >> 32);
        if (b == kLoop) break;
        auto j = i + 1;
        while (j != all.end() && *j >> 32 == b) ++j;
        visit(static_cast<std::uint32_t>(a), b, std::span<const std::uint64_t>(i, j));
        i = j;
      }
    }
  }

  static void sort_records(std::span<std::uint64_t> records);
};

/// Files the edges of all faces under their smaller points (a counting sort). O(points + corners). Where
/// `stop` is set meanwhile they are of no use.
[[nodiscard]] EdgeRecords distribute_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                                           std::span<const std::uint32_t> face_offsets,
                                           std::size_t face_count, Stop* stop = nullptr);

}  // namespace vkmesh::detail
