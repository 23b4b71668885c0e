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

/// Which vertices one of several may remove, all of whose neighbours are of the same partition: faces at such
/// vertices, and the vertices of these faces, nobody else reads or writes. All others are on the interface
/// between partitions, and once there stay there: what the interface's collapses leave next to another
/// partition has joined it.
class Partition {
 public:
  static constexpr std::uint8_t kInner = 0x80, kInterface = 0x7f;

  /// Everywhere, and there are no partitions.
  Partition() = default;
  /// `labels`, for each vertex: its partition, and kInner unless it is on the interface. Of the partition
  /// kInterface everything is, while nobody else is at work.
  Partition(std::vector<std::uint8_t>& labels, std::uint8_t partition)
      : labels_(labels.data()), partition_(partition) {}

  [[nodiscard]] bool is_bounded() const { return partition_ != kInterface; }
  /// Of a partition.
  [[nodiscard]] bool holds(std::uint32_t v) const { return labels_[v] == (partition_ | kInner); }

  [[nodiscard]] bool is_interface() const { return labels_ != nullptr && !is_bounded(); }
  /// Of the interface: a vertex has absorbed another, which had this ring.
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

/// Labels of vertices, for `partitions` compact partitions of about as many vertices each; a power of two
/// below kInterface. O(n log partitions).
[[nodiscard]] std::vector<std::uint8_t> partition_kd(CollapseMesh& mesh, std::size_t partitions);

/// What partition_kd has made of partitions: 2 i and 2 i + 1 become partition i again. `faces`: all that are
/// left, ghosts too, which are marked anew. O(vertices + faces), of which the vertices take a byte each.
void merge_pairs(CollapseMesh& mesh, std::span<std::uint8_t> labels, std::span<const std::uint32_t> faces);

/// Tells a face which of its edges are at the interface, and returns for each who sees to it: a partition, or
/// Partition::kInterface. No partition may be at work before all faces know.
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
