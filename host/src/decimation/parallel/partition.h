// Partitions of a surface that threads decimate side by side.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "decimation/order/edge_tags.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Tags all edges at a vertex that is not isolated and on the interface. O(valence).
inline void tag_interface_at(CollapseMesh& mesh, std::uint32_t v) {
  const std::uint32_t start = mesh.vertices[v].leading;
  std::uint32_t h = start;
  do {
    mesh.set_tag(h, kAtInterface);
    mesh.set_tag(CollapseMesh::previous(h), kAtInterface);
    h = mesh.around_vertex(h);
  } while (h != start);
}

/// The vertices that one thread may remove: those whose one-ring lies in its partition. Nobody else reads or
/// writes the faces at them, nor their corners. All other vertices are on the interface between partitions,
/// and once there stay there: a vertex that collapses on the interface leave next to another partition joins
/// it.
class Partition {
 public:
  static constexpr std::uint8_t kInner = 0x80, kInterface = 0x7f;

  /// The whole surface, which is not partitioned.
  Partition() = default;
  /// `labels`, for each vertex: its partition, and kInner unless it is on the interface. The partition
  /// kInterface is everything, for one thread while no other is at work.
  Partition(std::vector<std::uint8_t>& labels, std::uint8_t partition)
      : labels_(labels.data()), partition_(partition) {}

  /// Whether it is one of several, and not all of the surface.
  [[nodiscard]] bool is_bounded() const { return partition_ != kInterface; }
  /// Whether a vertex is inside a bounded partition.
  [[nodiscard]] bool holds(std::uint32_t v) const { return labels_[v] == (partition_ | kInner); }

  [[nodiscard]] bool is_interface() const { return labels_ != nullptr && !is_bounded(); }
  /// Updates the interface when a vertex has absorbed another, whose ring this was.
  void merge(CollapseMesh& mesh, std::uint32_t gone, std::uint32_t kept,
             std::span<const std::uint32_t> ring) {
    const auto owner = [&](std::uint32_t v) { return labels_[v] & ~kInner; };
    const auto leave = [&](std::uint32_t v) {
      labels_[v] &= ~kInner;
      tag_interface_at(mesh, v);
    };
    if (((labels_[gone] & labels_[kept]) & kInner) == 0) leave(kept);
    if (owner(gone) == owner(kept)) return;
    for (const std::uint32_t r : ring)
      if (owner(r) != owner(kept) && (labels_[r] & kInner) != 0 && r != mesh.apex()) leave(r);
  }

 private:
  std::uint8_t* labels_ = nullptr;
  std::uint8_t partition_ = kInterface;
};

/// Labels the vertices with `partitions` compact partitions of about equally many vertices, by a k-d tree. A
/// power of two below kInterface. O(n log partitions).
[[nodiscard]] std::vector<std::uint8_t> partition_kd(CollapseMesh& mesh, std::size_t partitions);

/// Merges partitions 2 i and 2 i + 1 of partition_kd into partition i. `faces`: all that are alive, with
/// ghosts; they are tagged anew. O(vertices + faces).
void merge_pairs(CollapseMesh& mesh, std::span<std::uint8_t> labels, std::span<const std::uint32_t> faces);

/// Tags the edges of a face that are at the interface, and returns for each the partition that it belongs to,
/// or Partition::kInterface. No partition may be at work before all faces are tagged.
[[gnu::always_inline]] inline std::array<std::uint8_t, 3> tag_interface(std::span<const std::uint8_t> labels,
                                                                        CollapseMesh::Face& face) {
  const std::array<std::uint8_t, 3> at = {labels[face.origin[0]], labels[face.origin[1]],
                                          labels[face.origin[2]]};
  std::array<std::uint8_t, 3> owner;
  std::uint32_t interface = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const bool inner = (at[i] & at[i < 2 ? i + 1 : 0] & Partition::kInner) != 0;
    interface |= (inner ? 0u : 1u) << i;
    owner[i] = inner ? at[i] & ~Partition::kInner : Partition::kInterface;
  }
  face.tags = (face.tags & ~(7u * tag_mask(kAtInterface))) | interface * tag_mask(kAtInterface);
  return owner;
}

}  // namespace vkmesh::detail
