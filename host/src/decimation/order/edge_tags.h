// The tags by which half-edges know where their edges wait.
#pragma once

#include <cstdint>

#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Tags of half-edges in CollapseMesh. kQueued: the edge's live entry in the queue is this half-edge.
/// kParked, of both halves: the collapse was illegal, and waits for a change nearby. kAtInterface: an end of
/// the edge is on the interface between partitions.
enum EdgeTag : unsigned { kQueued, kParked, kAtInterface };
/// The tag of a face's first half-edge, among the tags of the face.
[[nodiscard]] constexpr std::uint32_t tag_mask(EdgeTag tag) {
  return 1u << 4 * tag;
}

inline void set_parked(CollapseMesh& mesh, std::uint32_t h) {
  mesh.set_tag(h, kParked);
  mesh.set_tag(mesh.twin(h), kParked);
}
inline void clear_parked(CollapseMesh& mesh, std::uint32_t h) {
  mesh.clear_tag(h, kParked);
  mesh.clear_tag(mesh.twin(h), kParked);
}

enum class WasQueued : std::uint32_t { kNone, kOne, kBoth };
/// Two half-edges have become the two of one edge, which is not parked, and is queued by one of them, g if
/// either would do. Returns how many were queued before. Branchless. Edges to the apex are left alone.
inline WasQueued join_tags(CollapseMesh& mesh, std::uint32_t g, std::uint32_t t) {
  CollapseMesh::Face &one = mesh.face(g), &other = mesh.face(t);
  const std::uint32_t apex = mesh.apex();
  if (one.origin[g & 3u] == apex || other.origin[t & 3u] == apex) return WasQueued::kOne;
  const std::uint32_t has_g = one.tags >> (g & 3u) & 1u, has_t = other.tags >> (t & 3u) & 1u;
  one.tags = (one.tags | (1 - (has_g | has_t)) << (g & 3u)) & ~(tag_mask(kParked) << (g & 3u));
  other.tags &= ~((has_g & has_t) << (t & 3u)) & ~(tag_mask(kParked) << (t & 3u));
  return static_cast<WasQueued>(has_g + has_t);
}

}  // namespace vkmesh::detail
