// Triangle connectivity that is edited in place, half-edge by half-edge.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/mesh/handles.h>

#include "base/large_array.h"
#include "base/prefetch.h"
#include "math/quadric.h"
#include "mesh/edit/vertex_ranges.h"

namespace vkmesh::detail {

/// What decimation knows of a vertex, in one cache line: its place, the sum of the weighted planes that
/// it stands for as a quadric, the sum of their weights, and where its fan begins.
struct alignas(64) VertexRecord {
  std::array<float, 3> position;
  std::uint32_t source;  // its number in the input, and flags
  float weight;
  Quadric quadric;  // about its place
  /// A half-edge that leaves it; kGone | the vertex that absorbed it; kInvalid when it is isolated.
  std::uint32_t leading;

  static constexpr std::uint32_t kGone = 0x80000000u;
  static constexpr std::uint32_t kLocked = 1u << 28;
  static constexpr std::uint32_t kMoved = 1u << 29;
  static constexpr std::uint32_t kTouched = 1u << 30;    // a collapse of this batch has changed it
  static constexpr std::uint32_t kHasParked = 1u << 31;  // some edge at it is parked
  /// Coarsening, which parks nothing, tags what it has removed.
  static constexpr std::uint32_t kAbsorbed = kHasParked;
  static constexpr std::uint32_t kSourceMask = kLocked - 1;

  /// Where in the record's sixteen words each member begins, for loops that take records apart into lanes.
  enum Word : std::size_t { kX, kY, kZ, kSource, kWeight, kA, kC = kA + 6, kB, kLeading = kB + 3 };

  [[nodiscard]] bool has(std::uint32_t flag) const { return (source & flag) != 0; }
  [[nodiscard]] bool alive() const { return (leading & kGone) == 0; }
};
static_assert(sizeof(VertexRecord) == 64);
static_assert(offsetof(VertexRecord, source) == 4 * VertexRecord::kSource &&
              offsetof(VertexRecord, quadric.a) == 4 * VertexRecord::kA &&
              offsetof(VertexRecord, quadric.c) == 4 * VertexRecord::kC &&
              offsetof(VertexRecord, quadric.b) == 4 * VertexRecord::kB &&
              offsetof(VertexRecord, leading) == 4 * VertexRecord::kLeading);

/// The mesh closed by one extra vertex, the apex, joined to every boundary edge by a triangle, its ghost:
/// there is no boundary, so no walk has a special case, and the link condition of the closed complex is that
/// of the mesh with boundary (T. Dey, H. Edelsbrunner, S. Guha, D. Nekhayev, "Topology preserving edge
/// contraction", 1999). Only the apex may have several fans, and nothing walks around it.
///
/// Half-edge 4f + i starts at corner i of face f, i < 3: a face is a record of 32 bytes and shifts find it.
/// The faces of the mesh come first.
class CollapseMesh {
 public:
  struct alignas(32) Face {
    std::array<std::uint32_t, 3> origin;
    /// Bit i: half-edge i is queued for its edge; bit 4 + i: its edge is parked; bit 8 + i: an end of it is
    /// on the interface between partitions. A face that is gone has none.
    std::uint32_t tags;
    std::array<std::uint32_t, 3> twin;
    std::uint32_t source;  // its number in the input

    [[nodiscard]] bool alive() const { return origin[0] != kInvalid; }
  };

  static constexpr unsigned kInterfaceShift = 8;  // of the tags

  /// Where the half-edge of a face after that at a corner starts, and the one before it. From a table it is
  /// fewer instructions than next() and previous(), and a longer wait.
  static constexpr std::array<std::uint8_t, 4> kNextCorner = {1, 2, 0, 0}, kPreviousCorner = {2, 0, 1, 0};

  static constexpr std::size_t kMaxFaces = std::size_t{1} << 29;
  static constexpr std::size_t kMaxVertices = std::size_t{1} << 28;

  enum class Built { kDone, kNoSuchVertex, kNoManifold };
  /// Makes faces of what face_of(f), called on any threads, gives of each but its twins, and sets `leading`
  /// to a half-edge that leaves each vertex, kInvalid where there is none. Unless corners are below
  /// vertex_count and the faces form an oriented manifold of simple triangles the mesh is of no use. O(n),
  /// and O(d log d) for each vertex of many faces d. The vertices have room, and no values yet.
  template <class FaceOf>
  [[nodiscard]] Built build(std::size_t vertex_count, std::size_t face_count, FaceOf&& face_of,
                            std::vector<std::uint32_t>& leading) {
    face_count_ = face_count;
    apex_ = static_cast<std::uint32_t>(vertex_count);
    faces_ = LargeArray<Face>(face_count + face_count / 16 + 64);
    std::atomic<bool> simple = true, in_range = true;
    ranges_ = VertexRanges(vertex_count, face_count, [&](std::size_t begin, std::size_t end) {
      VertexRanges::Extent range;
      bool all_simple = true;
      for (std::size_t f = begin; f < end; ++f) {
        prefetch_stream(&faces_[f]);
        const Face face = face_of(f);
        const auto& [a, b, c] = face.origin;
        all_simple &= (a != b) & (b != c) & (c != a);
        for (const std::uint32_t v : face.origin) range.add(v);
        faces_[f] = face;
      }
      if (!all_simple) simple = false;
      if (range.high >= vertex_count) in_range = false;
      return range;
    });
    if (!in_range) return Built::kNoSuchVertex;
    return simple && connect(vertex_count, leading) ? Built::kDone : Built::kNoManifold;
  }

  /// For loops over the faces that write to their corners.
  [[nodiscard]] const VertexRanges& vertex_ranges() const { return ranges_; }
  [[nodiscard]] std::uint32_t apex() const { return apex_; }
  [[nodiscard]] std::size_t face_count() const { return face_count_; }
  /// All half-edges are less, those of ghosts included.
  [[nodiscard]] std::size_t half_edge_bound() const { return 4 * (face_count_ + ghosts_); }
  [[nodiscard]] bool is_ghost(std::uint32_t h) const { return h / 4 >= face_count_; }
  /// Of a vertex that is not isolated. O(valence).
  [[nodiscard]] bool on_boundary(std::uint32_t v) const {
    std::uint32_t h = vertices[v].leading;
    do {
      if (is_ghost(h)) return true;
      h = around_vertex(h);
    } while (h != vertices[v].leading);
    return false;
  }

  // Packed 2-bit lookup table; branchless.
  [[nodiscard]] static std::uint32_t next(std::uint32_t h) {
    return (h & ~3u) | (0b00'10'01u >> 2 * (h & 3u) & 3u);
  }
  [[nodiscard]] static std::uint32_t previous(std::uint32_t h) {
    return (h & ~3u) | (0b01'00'10u >> 2 * (h & 3u) & 3u);
  }
  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return faces_[h >> 2].origin[h & 3u]; }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return origin(next(h)); }
  [[nodiscard]] std::uint32_t twin(std::uint32_t h) const { return faces_[h >> 2].twin[h & 3u]; }
  /// The next half-edge that leaves the same vertex, counter-clockwise.
  [[nodiscard]] std::uint32_t around_vertex(std::uint32_t h) const { return twin(previous(h)); }
  /// For loops that read them often; half-edge h is of face h / 4.
  [[nodiscard]] const Face* faces() const { return faces_.data(); }
  [[nodiscard]] Face& face(std::uint32_t h) { return faces_[h >> 2]; }
  [[nodiscard]] const Face& face(std::uint32_t h) const { return faces_[h >> 2]; }
  [[nodiscard]] bool alive(std::uint32_t h) const { return face(h).alive(); }

  [[nodiscard]] bool queued(std::uint32_t h) const { return (face(h).tags >> (h & 3u) & 1u) != 0; }
  void set_queued(std::uint32_t h) { face(h).tags |= 1u << (h & 3u); }
  void clear_queued(std::uint32_t h) { face(h).tags &= ~(1u << (h & 3u)); }
  [[nodiscard]] bool parked(std::uint32_t h) const { return (face(h).tags >> (4 + (h & 3u)) & 1u) != 0; }
  /// Both halves of the edge.
  void set_parked(std::uint32_t h) {
    const std::uint32_t t = twin(h);
    face(h).tags |= 16u << (h & 3u);
    face(t).tags |= 16u << (t & 3u);
  }
  void clear_parked(std::uint32_t h) {
    const std::uint32_t t = twin(h);
    face(h).tags &= ~(16u << (h & 3u));
    face(t).tags &= ~(16u << (t & 3u));
  }

  static constexpr std::uint32_t kNoneQueued = 0, kOneQueued = 1, kBothQueued = 2;
  /// Two half-edges have become the two of one edge, which is not parked, and queued by one of them, g in
  /// doubt. Returns what there was before. Branchless. Edges to the apex are left
  /// alone.
  std::uint32_t make_one(std::uint32_t g, std::uint32_t t) {
    Face &one = face(g), &other = face(t);
    if (one.origin[g & 3u] == apex_ || other.origin[t & 3u] == apex_) return kOneQueued;
    const std::uint32_t has_g = one.tags >> (g & 3u) & 1u, has_t = other.tags >> (t & 3u) & 1u;
    one.tags = (one.tags | (1 - (has_g | has_t)) << (g & 3u)) & ~(16u << (g & 3u));
    other.tags &= ~((has_g & has_t) << (t & 3u)) & ~(16u << (t & 3u));
    return has_g + has_t;
  }

  /// Whether an end of the edge is on the interface between partitions.
  [[nodiscard]] bool at_interface(std::uint32_t h) const {
    return (face(h).tags >> kInterfaceShift >> (h & 3u) & 1u) != 0;
  }
  /// Of a vertex that is not isolated. O(valence).
  void tag_interface_at(std::uint32_t v) {
    std::uint32_t h = vertices[v].leading;
    do {
      face(h).tags |= (1u << (h & 3u) | 1u << kPreviousCorner[h & 3u]) << kInterfaceShift;
      h = around_vertex(h);
    } while (h != vertices[v].leading);
  }

  struct Collapsed {
    unsigned faces;  ///< How many of the two faces were the mesh's own.
    /// Half-edges, the first from the vertex that is left, that have become the two of one edge: two edges
    /// were one of each.
    std::array<std::array<std::uint32_t, 2>, 2> joined;
  };
  /// Removes the origin p of h and the two faces at h; what met at p meets at the target q. `others`: the
  /// half-edges that leave p, but h. The link condition must hold. O(valence of p).
  Collapsed collapse(std::uint32_t h, std::span<const std::uint32_t> others) {
    const std::uint32_t t = twin(h);
    const std::uint32_t p = origin(h), q = origin(t);
    const std::uint32_t q_to_a = next(h), a_to_p = previous(h);
    const std::uint32_t p_to_b = next(t), b_to_q = previous(t);
    for (const std::uint32_t out : others) faces_[out >> 2].origin[out & 3u] = q;

    // p → a, now q → a, and a → q; q → b, and b → p, which b → q becomes.
    const Collapsed result = {(is_ghost(h) ? 0u : 1u) + (is_ghost(t) ? 0u : 1u),
                              {{{twin(a_to_p), twin(q_to_a)}, {twin(b_to_q), twin(p_to_b)}}}};
    const auto& [to_a, from_a] = result.joined[0];
    const auto& [to_b, from_b] = result.joined[1];
    const std::uint32_t a = origin(a_to_p), b = origin(b_to_q);
    vertices[q].leading = to_a;
    if (a != apex_) vertices[a].leading = from_a;
    if (b != apex_) vertices[b].leading = from_b;
    vertices[p].leading = VertexRecord::kGone | q;
    set_twins(from_a, to_a);
    set_twins(from_b, to_b);
    remove(h >> 2);
    remove(t >> 2);
    return result;
  }

  /// Takes away a face of the mesh and the ghosts at it; the rest of its component must go too.
  void erase_with_ghosts(std::uint32_t f) {
    for (const std::uint32_t t : faces_[f].twin)
      if (is_ghost(t)) remove(t >> 2);
    remove(f);
  }

  static constexpr std::size_t kMaxHoleEdges = 17;
  /// Removes the origin of `edges`, all that leave it, counter-clockwise, and puts these triangles in the
  /// place of its faces: corners are numbers of edges in ascending order, and stand for their targets. Each
  /// new edge stands in an earlier triangle as one between neighbouring corners, and in a later one between
  /// the first and the last. The apex is the target of the last edge if of any. No new edge may be in the
  /// mesh. Triangles that close no boundary get the records of the faces of the edges from number `first` on,
  /// then from 0 on; never that of the last edge. Returns the sources of the two faces that went, kInvalid
  /// for a ghost. At most kMaxHoleEdges edges; O(edges).
  std::array<std::uint32_t, 2> fill_hole(std::span<const std::uint32_t> edges,
                                         std::span<const std::array<std::uint8_t, 3>> triangles,
                                         std::size_t first = 0);

  LargeArray<VertexRecord> vertices;

 private:
  void remove(std::uint32_t f) {
    faces_[f].origin[0] = kInvalid;
    faces_[f].tags = 0;
  }
  void set_twins(std::uint32_t a, std::uint32_t b) {
    faces_[a >> 2].twin[a & 3u] = b;
    faces_[b >> 2].twin[b & 3u] = a;
  }

  bool connect(std::size_t vertex_count, std::vector<std::uint32_t>& leading);

  class Fan;
  class SmallFan;
  bool close(std::span<const std::uint32_t> boundary);

  LargeArray<Face> faces_;
  VertexRanges ranges_;
  std::size_t face_count_ = 0;
  std::size_t ghosts_ = 0;
  std::uint32_t apex_ = 0;
};

}  // namespace vkmesh::detail
