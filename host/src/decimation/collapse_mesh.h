// Triangle connectivity that is edited in place, half-edge by half-edge.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/handles.h>

#include "decimation/large_array.h"

namespace vkmesh::detail {

/// Asks for the cache line at `address` without waiting for it.
[[gnu::always_inline]] inline void prefetch(const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(address);
#else
  static_cast<void>(address);
#endif
}

/// What decimation knows of a vertex, in one cache line: its place, the quadric Σ w (n·(x − position) − d)²
/// of the planes that it stands for as xᵀA x + 2 b·x + c about its place, the sum of their weights, and where
/// its fan begins.
struct alignas(64) CollapseVertex {
  std::array<float, 3> position;
  std::array<float, 6> a;  // xx, xy, xz, yy, yz, zz
  std::array<float, 3> b;
  float c;
  float weight;
  /// A half-edge that leaves it; kGone | the vertex that absorbed it; kInvalid when it is isolated.
  std::uint32_t leading;
  std::uint32_t source;  // its number in the input, and flags

  static constexpr std::uint32_t kGone = 0x80000000u;
  static constexpr std::uint32_t kLocked = 1u << 28;
  static constexpr std::uint32_t kMoved = 1u << 29;
  static constexpr std::uint32_t kTouched = 1u << 30;    // a collapse of this batch has changed it
  static constexpr std::uint32_t kHasParked = 1u << 31;  // some edge at it is parked
  static constexpr std::uint32_t kSourceMask = kLocked - 1;

  [[nodiscard]] bool has(std::uint32_t flag) const { return (source & flag) != 0; }
  [[nodiscard]] bool alive() const { return (leading & kGone) == 0; }
};
static_assert(sizeof(CollapseVertex) == 64);

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
    std::uint32_t tags;  // bit i: half-edge i is queued for its edge; bit 4 + i: its edge is parked
    std::array<std::uint32_t, 3> twin;
    std::uint32_t source;  // its number in the input

    [[nodiscard]] bool alive() const { return origin[0] != kInvalid; }
  };

  static constexpr std::size_t kMaxFaces = std::size_t{1} << 29;
  static constexpr std::size_t kMaxVertices = std::size_t{1} << 28;

  /// Fills the faces and makes room for the vertices, and sets `leading` to a half-edge that leaves each
  /// vertex, kInvalid where there is none; corners must be < vertex_count. False when the faces form no
  /// oriented manifold of simple triangles; the mesh is then of no use. O(n).
  [[nodiscard]] bool build(std::size_t vertex_count, std::span<const std::uint32_t> corners,
                           std::vector<std::uint32_t>& leading) {
    face_count_ = corners.size() / 3;
    apex_ = static_cast<std::uint32_t>(vertex_count);
    faces_ = LargeArray<Face>(face_count_ + face_count_ / 16 + 64);
    vertices = LargeArray<CollapseVertex>(vertex_count + 1);
    // The half-edges whose twins have not come yet, of each edge at its smaller vertex, linked by `twin`.
    std::vector<std::uint32_t> waiting(vertex_count, kInvalid);
    for (std::uint32_t f = 0; f < face_count_; ++f) {
      Face& face = faces_[f];
      face.origin = {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]};
      face.tags = 0;
      face.source = f;
      if (face.origin[0] == face.origin[1] || face.origin[1] == face.origin[2] ||
          face.origin[2] == face.origin[0])
        return false;
      for (std::uint32_t i = 0; i < 3; ++i)
        if (!pair(4 * f + i, waiting)) return false;
    }
    if (!close(waiting)) return false;
    leading = std::move(waiting);
    std::fill(leading.begin(), leading.end(), kInvalid);
    for (std::uint32_t f = 0; f < face_count_; ++f)
      for (std::uint32_t i = 0; i < 3; ++i) leading[faces_[f].origin[i]] = 4 * f + i;
    return fans_are_single(leading);
  }

  [[nodiscard]] std::uint32_t apex() const { return apex_; }
  [[nodiscard]] std::size_t face_count() const { return face_count_; }
  /// All half-edges are less, those of ghosts included.
  [[nodiscard]] std::size_t half_edge_bound() const { return 4 * (face_count_ + ghosts_); }
  [[nodiscard]] bool is_ghost(std::uint32_t h) const { return h / 4 >= face_count_; }

  [[nodiscard]] static std::uint32_t next(std::uint32_t h) { return (h & 3u) == 2 ? h - 2 : h + 1; }
  [[nodiscard]] static std::uint32_t previous(std::uint32_t h) { return (h & 3u) == 0 ? h + 2 : h - 1; }
  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return faces_[h >> 2].origin[h & 3u]; }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return origin(next(h)); }
  [[nodiscard]] std::uint32_t twin(std::uint32_t h) const { return faces_[h >> 2].twin[h & 3u]; }
  /// The next half-edge that leaves the same vertex, counter-clockwise.
  [[nodiscard]] std::uint32_t around_vertex(std::uint32_t h) const { return twin(previous(h)); }
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

  /// Removes the origin p of h and the two faces at h; what met at p meets at the target q. The link
  /// condition must hold. Returns how many of the two faces were the mesh's own. O(valence of p).
  unsigned collapse(std::uint32_t h) {
    const std::uint32_t t = twin(h);
    const std::uint32_t p = origin(h), q = origin(t);
    const std::uint32_t q_to_a = next(h), a_to_p = previous(h);
    const std::uint32_t p_to_b = next(t), b_to_q = previous(t);
    for (std::uint32_t out = around_vertex(h); out != h; out = around_vertex(out))
      faces_[out >> 2].origin[out & 3u] = q;

    const std::uint32_t a_out = twin(q_to_a), b_out = twin(p_to_b);  // a → q and b → p, which b → q becomes
    const std::uint32_t a = origin(a_to_p), b = origin(b_to_q);
    vertices[q].leading = twin(a_to_p);  // p → a, now q → a
    if (a != apex_) vertices[a].leading = a_out;
    if (b != apex_) vertices[b].leading = b_out;
    vertices[p].leading = CollapseVertex::kGone | q;
    set_twins(a_out, twin(a_to_p));
    set_twins(b_out, twin(b_to_q));
    const unsigned own = (is_ghost(h) ? 0u : 1u) + (is_ghost(t) ? 0u : 1u);
    faces_[h >> 2].origin[0] = kInvalid;
    faces_[t >> 2].origin[0] = kInvalid;
    return own;
  }

  LargeArray<CollapseVertex> vertices;

 private:
  void set_twins(std::uint32_t a, std::uint32_t b) {
    faces_[a >> 2].twin[a & 3u] = b;
    faces_[b >> 2].twin[b & 3u] = a;
  }

  bool pair(std::uint32_t h, std::vector<std::uint32_t>& waiting) {
    const std::uint32_t from = origin(h), to = target(h);
    std::uint32_t* link = &waiting[std::min(from, to)];
    while (*link != kInvalid) {
      const std::uint32_t g = *link;
      const std::uint32_t its_from = origin(g), its_to = target(g);
      std::uint32_t& its_link = faces_[g >> 2].twin[g & 3u];
      if (its_from == to && its_to == from) {
        *link = its_link;
        set_twins(g, h);
        return true;
      }
      if (its_from == from && its_to == to) return false;
      link = &its_link;
    }
    faces_[h >> 2].twin[h & 3u] = kInvalid;
    *link = h;
    return true;
  }

  // Puts a ghost, the triangle (target, origin, apex), beyond each boundary edge.
  bool close(std::vector<std::uint32_t>& waiting) {
    std::vector<std::uint32_t> boundary;
    for (std::uint32_t& first : waiting) {
      for (std::uint32_t h = first; h != kInvalid; h = twin(h)) boundary.push_back(h);
      first = kInvalid;
    }
    const std::size_t all = face_count_ + boundary.size();
    if (all > kMaxFaces) return false;
    if (all > faces_.size()) faces_.grow(all, face_count_);
    auto ghost = static_cast<std::uint32_t>(face_count_);
    std::vector<std::uint32_t>& ghost_from = waiting;  // by the vertex that its boundary edge leaves
    for (const std::uint32_t h : boundary) {
      const std::uint32_t from = origin(h), to = target(h);
      if (ghost_from[from] != kInvalid) return false;
      ghost_from[from] = ghost;
      faces_[ghost].origin = {to, from, apex_};
      faces_[ghost].tags = 0;
      faces_[ghost].source = kInvalid;
      set_twins(h, 4 * ghost);
      ++ghost;
    }
    // The ghost of v → w arrives from the apex where that of the next edge w → x leaves for it.
    for (auto g = static_cast<std::uint32_t>(face_count_); g < ghost; ++g) {
      const std::uint32_t after = ghost_from[faces_[g].origin[0]];
      if (after == kInvalid) return false;
      set_twins(4 * g + 2, 4 * after + 1);
    }
    ghosts_ = boundary.size();
    return true;
  }

  // A vertex of several fans has half-edges that a walk around it does not meet.
  [[nodiscard]] bool fans_are_single(const std::vector<std::uint32_t>& leading) const {
    std::size_t met = 0;
    for (const std::uint32_t start : leading) {
      if (start == kInvalid) continue;
      std::uint32_t h = start;
      do {
        ++met;
        h = around_vertex(h);
      } while (h != start);
    }
    return met == 3 * face_count_ + 2 * ghosts_;
  }

  LargeArray<Face> faces_;
  std::size_t face_count_ = 0;
  std::size_t ghosts_ = 0;
  std::uint32_t apex_ = 0;
};

}  // namespace vkmesh::detail
