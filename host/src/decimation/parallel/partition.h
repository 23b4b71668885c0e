// Parts of a surface that threads decimate side by side.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/edit/collapse_mesh.h"

namespace vkmesh::detail {

/// Which vertices one of several may remove, all of whose neighbours are of the same part: faces at such
/// vertices, and the vertices of these faces, nobody else reads or writes. All others are on the interface
/// between parts, and once there stay there: what the interface's collapses leave next to another part has
/// joined it.
class Territory {
 public:
  static constexpr std::uint8_t kInner = 0x80, kInterface = 0x7f;

  /// Everywhere, and there are no parts.
  Territory() = default;
  /// `labels`, for each vertex: its part, and kInner unless it is on the interface. Of the part kInterface
  /// everything is, while nobody else is at work.
  Territory(std::vector<std::uint8_t>& labels, std::uint8_t part) : labels_(labels.data()), part_(part) {}

  [[nodiscard]] bool is_part() const { return part_ != kInterface; }
  /// Of a part.
  [[nodiscard]] bool holds(std::uint32_t v) const { return labels_[v] == (part_ | kInner); }

  [[nodiscard]] bool is_interface() const { return labels_ != nullptr && !is_part(); }
  /// Of the interface: a vertex has absorbed another, which had this ring.
  void merge(CollapseMesh& mesh, std::uint32_t gone, std::uint32_t kept,
             std::span<const std::uint32_t> ring) {
    const auto owner = [&](std::uint32_t v) { return labels_[v] & ~kInner; };
    const auto leave = [&](std::uint32_t v) {
      labels_[v] &= ~kInner;
      mesh.tag_interface_at(v);
    };
    if (((labels_[gone] & labels_[kept]) & kInner) == 0) leave(kept);
    if (owner(gone) == owner(kept)) return;
    for (const std::uint32_t r : ring)
      if (owner(r) != owner(kept) && (labels_[r] & kInner) != 0 && r != mesh.apex()) leave(r);
  }

 private:
  std::uint8_t* labels_ = nullptr;
  std::uint8_t part_ = kInterface;
};

/// Labels of vertices, for `parts` compact parts of about as many vertices each; a power of two below
/// kInterface. O(n log parts).
[[nodiscard]] std::vector<std::uint8_t> divide(CollapseMesh& mesh, std::size_t parts);

/// What divide has made of parts: 2 i and 2 i + 1 become part i again. `faces`: all that are left, ghosts
/// too, which are marked anew. O(vertices + faces), of which the vertices take a byte each.
void join_halves(CollapseMesh& mesh, std::span<std::uint8_t> labels, std::span<const std::uint32_t> faces);

/// Tells a face which of its edges are at the interface, and returns for each who sees to it: a part, or
/// Territory::kInterface. No part may be at work before all faces know.
[[gnu::always_inline]] inline std::array<std::uint8_t, 3> tag_interface(std::span<const std::uint8_t> labels,
                                                                        CollapseMesh::Face& face) {
  const std::array<std::uint8_t, 3> at = {labels[face.origin[0]], labels[face.origin[1]],
                                          labels[face.origin[2]]};
  std::array<std::uint8_t, 3> owner;
  std::uint32_t interface = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const bool inner = (at[i] & at[i < 2 ? i + 1 : 0] & Territory::kInner) != 0;
    interface |= (inner ? 0u : 1u) << i;
    owner[i] = inner ? at[i] & ~Territory::kInner : Territory::kInterface;
  }
  face.tags =
      (face.tags & ~(7u << CollapseMesh::kInterfaceShift)) | interface << CollapseMesh::kInterfaceShift;
  return owner;
}

}  // namespace vkmesh::detail
