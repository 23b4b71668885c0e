// The vertices of a mesh in groups that fill vector registers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/node_neighbours.h>

#include "base/large_array.h"
#include "base/parallel.h"

namespace vkmesh::detail {

/// Vertices near each other that have equally many neighbours, and are all of the boundary or all not: a loop
/// over neighbours runs as often for each of them.
struct RingGroup {
  std::span<const std::uint32_t> vertices;
  std::span<const std::uint32_t>
      rings;  ///< The neighbours of one after those of another, if they were copied.
  std::uint32_t valence = 0;
  bool boundary = false;

  static constexpr std::size_t kMost = 64;  ///< So that what is summed up for them stays in the first cache.
};

/// A point for each vertex of a group, coordinate by coordinate as vector registers take them.
struct RingPoints {
  float x[RingGroup::kMost], y[RingGroup::kMost], z[RingGroup::kMost];

  void set(std::size_t i, Vec3 v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
  [[nodiscard]] Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }

  /// The positions of the group.
  void take(const RingGroup& group, const Vec3* positions) {
    for (std::size_t i = 0; i < group.vertices.size(); ++i) set(i, positions[group.vertices[i]]);
  }
  /// Those of its k-th neighbours.
  void take(const RingGroup& group, const Vec3* positions, const NodeNeighbours& neighbours,
            std::uint32_t k) {
    const std::uint32_t* const ids = neighbours.ids.data();
    for (std::size_t i = 0; i < group.vertices.size(); ++i)
      set(i, positions[ids[neighbours.offsets[group.vertices[i]] + k]]);
  }
};

/// Goes around the vertices `here` of a group. compute(fan, here, q, r, count) tells what the triangles here,
/// q, r have to say, as a Fan; add(q, before, after, count) takes it for the edges from here to q: of the
/// triangles before and after each, where there is none a Fan as it is made.
template <class Fan, class Compute, class Add>
void go_around(const RingGroup& group, const Vec3* positions, const NodeNeighbours& neighbours,
               const RingPoints& here, Compute&& compute, Add&& add) {
  const std::size_t count = group.vertices.size();
  RingPoints q, r;
  q.take(group, positions, neighbours, 0);
  // The triangle between the last neighbour and the first, which is none on the boundary.
  Fan last;
  if (!group.boundary) {
    r.take(group, positions, neighbours, group.valence - 1);
    compute(last, here, r, q, count);
  }
  Fan before = last, after;
  for (std::uint32_t k = 0; k < group.valence; ++k) {
    if (k + 1 < group.valence) {
      r.take(group, positions, neighbours, k + 1);
      compute(after, here, q, r, count);
    } else {
      after = last;
    }
    add(q, before, after, count);
    std::swap(before, after);
    q = r;
  }
}

/// Consecutive vertices [first, last), those of its groups among them.
struct RingChunk {
  std::uint32_t first = 0, last = 0;
  std::vector<RingGroup> groups;

  static constexpr std::size_t kMost = 8192;  ///< So that their positions stay in the second cache.
};

/// All vertices that have neighbours, but those whose bit is set in `left_out` (as in
/// NodeNeighbours::boundary_bits), in groups. O(vertices), in parallel. 4 bytes a vertex; with copied rings,
/// for those that go around them many times, O(edges) and 4 bytes a directed edge more.
class RingGroups {
 public:
  explicit RingGroups(const NodeNeighbours& neighbours, std::span<const std::uint32_t> left_out = {},
                      bool copy_rings = false);
  /// So many numbers of vertices can be read past a copied ring: those of others, or 0.
  static constexpr std::size_t kRingsPast = 200;

  RingGroups(const RingGroups&) = delete;
  RingGroups& operator=(const RingGroups&) = delete;

  /// Calls body(chunk) for chunks that cover all vertices, on any threads.
  template <class Body>
  void for_each_chunk(Body&& body) const {
    parallel_ranges(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) body(chunks_[c]);
    });
  }
  /// Calls body(group) for groups of at most RingGroup::kMost vertices that cover all, on any threads.
  template <class Body>
  void for_each(Body&& body) const {
    for_each_chunk([&](const RingChunk& chunk) {
      for (const RingGroup& group : chunk.groups) body(group);
    });
  }

  /// How far ahead, in numbers of vertices, the neighbours of nearly all vertices lie at most, if rings were
  /// copied; 0 where that is so far that caches would not keep what is asked for so early.
  [[nodiscard]] std::size_t reach() const { return reach_; }

  /// Asks for the copied rings that are wanted some groups after this one.
  void prefetch_rings_after(const RingGroup& group) const;

 private:
  LargeArray<std::uint32_t> order_, rings_;
  std::vector<RingChunk> chunks_;
  std::size_t reach_ = 0;
};

}  // namespace vkmesh::detail
