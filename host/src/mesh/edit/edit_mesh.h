// Triangle connectivity that changes: edges collapse, flip and are split, vertices go and their holes are
// filled.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/handles.h>

#include "base/large_array.h"
#include "base/parallel.h"
#include "base/parallel_filter.h"
#include "base/prefetch.h"
#include "base/stop.h"
#include "mesh/edit/vertex_ranges.h"

namespace vkmesh::detail {

/// Faces of an EditMesh, with their twins: all of its connectivity but where the fan of a vertex begins.
///
/// The surface is closed by one extra vertex, the apex, joined to every boundary edge by a triangle, its
/// ghost: there is no boundary, so no walk has a special case, and the link condition of the closed complex
/// is that of the mesh with boundary (T. Dey, H. Edelsbrunner, S. Guha, D. Nekhayev, "Topology preserving
/// edge contraction", 1999). Only the apex may have several fans, and nothing walks around it.
///
/// Half-edge 4f + i starts at corner i of face f, i < 3: a face is a record of 32 bytes and shifts find it.
/// The faces of the mesh come first, then the ghosts; the apex is corner 2 of a ghost. Records of faces that
/// are gone are not used again.
class EditFaces {
 public:
  struct alignas(32) Face {
    std::array<std::uint32_t, 3> origin;
    /// For the user: bit 4k + i is tag k of half-edge i, bit 4k + 3 tag k of the face. 0 when the face is
    /// gone.
    std::uint32_t tags;
    std::array<std::uint32_t, 3> twin;
    std::uint32_t source;  // for the user: as the number of the face in the input

    [[nodiscard]] bool alive() const { return origin[0] != kInvalid; }
  };

  /// The corner after another in its face, and the one before. From a table it is fewer instructions than
  /// next() and previous(), and a longer wait.
  static constexpr std::array<std::uint8_t, 4> kNextCorner = {1, 2, 0, 0}, kPreviousCorner = {2, 0, 1, 0};

  static constexpr std::size_t kMaxFaces = std::size_t{1} << 29;
  static constexpr std::size_t kMaxVertices = std::size_t{1} << 28;

  /// Ranges of vertices, for loops over the faces that were built which write to their corners.
  [[nodiscard]] const VertexRanges& vertex_ranges() const { return ranges_; }
  /// The vertex that closes the boundary: the number after the last vertex that was built.
  [[nodiscard]] std::uint32_t apex() const { return apex_; }
  [[nodiscard]] std::size_t face_count() const { return face_count_; }
  /// All half-edges are less, those of ghosts included.
  [[nodiscard]] std::size_t half_edge_bound() const { return 4 * (face_count_ + ghosts_); }
  [[nodiscard]] bool is_ghost(std::uint32_t h) const { return h / 4 >= face_count_; }

  // Packed 2-bit lookup tables; branchless.
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

  /// Tag k of half-edge h, k < 8.
  [[nodiscard]] bool has_tag(std::uint32_t h, unsigned k) const {
    return (face(h).tags >> 4 * k >> (h & 3u) & 1u) != 0;
  }
  void set_tag(std::uint32_t h, unsigned k) { face(h).tags |= 1u << 4 * k << (h & 3u); }
  void clear_tag(std::uint32_t h, unsigned k) { face(h).tags &= ~(1u << 4 * k << (h & 3u)); }

 protected:
  EditFaces() = default;

  void remove(std::uint32_t f) {
    faces_[f].origin[0] = kInvalid;
    faces_[f].tags = 0;
  }
  void set_twins(std::uint32_t a, std::uint32_t b) {
    faces_[a >> 2].twin[a & 3u] = b;
    faces_[b >> 2].twin[b & 3u] = a;
  }
  /// Pairs the half-edges of the faces, finds one that leaves each vertex, and adds the ghosts. False unless
  /// the faces form an oriented manifold. `scratch`: room for scratch_words() words. Where `stop` is set
  /// meanwhile the mesh is of no use.
  [[nodiscard]] bool connect(std::size_t vertex_count, std::vector<std::uint32_t>& leading,
                             std::uint32_t* scratch, Stop* stop);
  [[nodiscard]] std::size_t scratch_words() const { return 3 * face_count_ + kScratchTail; }
  /// Copies the faces of a mesh with their twins, and adds the ghosts. False where there are too many. O(n).
  [[nodiscard]] bool copy(const HalfEdgeMesh& mesh);
  /// See EditMesh::validate(). `leading`: of each vertex, kInvalid for the apex.
  [[nodiscard]] Result<void> validate_connectivity(std::span<const std::uint32_t> leading) const;

  LargeArray<Face> faces_;
  VertexRanges ranges_;
  std::size_t face_count_ = 0;
  std::size_t ghosts_ = 0;
  std::uint32_t apex_ = 0;

 private:
  static constexpr std::size_t kScratchTail = 70;  // what a loop reads ahead

  class Fan;
  bool add_ghosts(std::span<const std::uint32_t> boundary);
};

/// The flag of `leading` of a vertex that is gone.
inline constexpr std::uint32_t kVertexGone = 0x80000000u;

/// A triangle mesh whose connectivity is edited in place. `Vertex`: what the user knows of a vertex, with a
/// member `leading`: a half-edge that leaves it; kVertexGone | the vertex that absorbed it; kInvalid when it
/// is isolated. The mesh touches nothing else of it. No edit checks whether it is legal: can_flip() and
/// meets_link_condition() (link_condition.h) tell. Edits whose faces and vertices are apart may run side by
/// side on several threads, but for split().
template <class Vertex>
class EditMesh : public EditFaces {
 public:
  enum class Built { kDone, kNoSuchVertex, kNoManifold, kStopped };
  /// Makes faces of what face_of(f), called on any threads, gives of each but its twins, and sets `leading`
  /// to a half-edge that leaves each vertex, kInvalid where there is none. Unless corners are below
  /// vertex_count and the faces form an oriented manifold of simple triangles the mesh is of no use. O(n),
  /// and O(d log d) for each vertex of many faces d. The vertices have room, and no values yet. Every part
  /// asks `stop`; where that is set the mesh is of no use.
  template <class FaceOf>
  [[nodiscard]] Built build(std::size_t vertex_count, std::size_t face_count, FaceOf&& face_of,
                            std::vector<std::uint32_t>& leading, Stop* stop = nullptr) {
    face_count_ = face_count;
    apex_ = static_cast<std::uint32_t>(vertex_count);
    vertex_bound_ = vertex_count + 1;
    faces_ = LargeArray<Face>(face_count + face_count / 16 + 64);
    std::atomic<bool> simple = true, in_range = true;
    ranges_ = VertexRanges(vertex_count, face_count, [&](std::size_t begin, std::size_t end) {
      VertexRanges::Extent extent;
      if (!goes_on(stop)) return extent;
      bool all_simple = true;
      for (std::size_t f = begin; f < end; ++f) {
        prefetch_stream(&faces_[f]);
        const Face face = face_of(f);
        const auto& [a, b, c] = face.origin;
        all_simple &= (a != b) & (b != c) & (c != a);
        for (const std::uint32_t v : face.origin) extent.add(v);
        faces_[f] = face;
      }
      if (!all_simple) simple = false;
      if (extent.high >= vertex_count) in_range = false;
      return extent;
    });
    if (!goes_on(stop)) return Built::kStopped;
    if (!in_range) return Built::kNoSuchVertex;
    if (!simple) return Built::kNoManifold;
    // Until the vertices have values their memory is scratch, at no cost.
    constexpr std::size_t kWords = sizeof(Vertex) / sizeof(std::uint32_t);
    vertices = LargeArray<Vertex>(std::max(vertex_bound_, (scratch_words() + kWords - 1) / kWords));
    const bool manifold =
        connect(vertex_count, leading, reinterpret_cast<std::uint32_t*>(&vertices[0]), stop);
    if (!goes_on(stop)) return Built::kStopped;
    return manifold ? Built::kDone : Built::kNoManifold;
  }

  /// Takes over the connectivity of a valid mesh of triangles, with its numbers: half-edge 3f + i becomes
  /// 4f + i, f is the source of face f, no tag is set, and vertices are default-made but for `leading`. False
  /// where there are more than kMaxFaces faces and boundary edges or kMaxVertices vertices. O(n).
  [[nodiscard]] bool build(const HalfEdgeMesh& mesh) {
    if (mesh.vertex_count() > kMaxVertices || !copy(mesh)) return false;
    vertex_bound_ = mesh.vertex_count() + 1;
    vertices = LargeArray<Vertex>(vertex_bound_);
    parallel_ranges(mesh.vertex_count(), std::size_t{1} << 14, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const std::uint32_t h = mesh.leadings()[v];
        vertices[v] = {};
        vertices[v].leading = h == kInvalid ? kInvalid : h + h / 3;
      }
    });
    vertices[apex_] = {};
    return true;
  }

  /// Leaves out what is gone: faces, ghosts and vertices, isolated ones too. The others keep their order, and
  /// have no tags. No edge may have been split. O(n) of what there was.
  void compact() {
    const std::vector<std::uint32_t> kept_faces = collect(face_count_ + ghosts_, [&](std::uint32_t f) {
      prefetch_stream(&faces_[f]);
      return faces_[f].alive();
    });
    const std::vector<std::uint32_t> kept = collect(vertex_bound_, [&](std::uint32_t v) {
      prefetch_stream(&vertices[v]);
      return v == apex_ || (vertices[v].leading & kVertexGone) == 0;
    });
    const std::size_t own = static_cast<std::size_t>(
        std::ranges::lower_bound(kept_faces, static_cast<std::uint32_t>(face_count_)) - kept_faces.begin());
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    const auto numbers_of = [](const std::vector<std::uint32_t>& list, std::size_t bound) {
      auto number = std::make_unique_for_overwrite<std::uint32_t[]>(bound);
      parallel_ranges(list.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) number[list[i]] = static_cast<std::uint32_t>(i);
      });
      return number;
    };
    const auto face_number = numbers_of(kept_faces, face_count_ + ghosts_),
               vertex_number = numbers_of(kept, vertex_bound_);
    const auto half_edge = [&](std::uint32_t h) { return 4 * face_number[h / 4] + h % 4; };

    LargeArray<Face> faces(kept_faces.size() + 64);
    const auto copy_face = [&](std::size_t i) {
      Face face = faces_[kept_faces[i]];
      face.tags = 0;
      for (std::uint32_t& v : face.origin) v = vertex_number[v];
      for (std::uint32_t& t : face.twin) t = half_edge(t);
      faces[i] = face;
      return face;
    };
    ranges_ = VertexRanges(kept.size() - 1, own, [&](std::size_t begin, std::size_t end) {
      VertexRanges::Extent extent;
      for (std::size_t i = begin; i < end; ++i)
        for (const std::uint32_t v : copy_face(i).origin) extent.add(v);
      return extent;
    });
    for (std::size_t i = own; i < kept_faces.size(); ++i) copy_face(i);
    LargeArray<Vertex> moved(kept.size());
    parallel_ranges(kept.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        moved[i] = vertices[kept[i]];
        if (kept[i] != apex_) moved[i].leading = half_edge(moved[i].leading);
      }
    });
    apex_ = vertex_number[apex_];
    vertex_bound_ = kept.size();
    face_count_ = own;
    ghosts_ = kept_faces.size() - own;
    faces_ = std::move(faces);
    vertices = std::move(moved);
  }

  /// All vertices are less, the apex and those of splits included.
  [[nodiscard]] std::size_t vertex_bound() const { return vertex_bound_; }
  /// Whether a vertex that is not isolated has a ghost. O(valence).
  [[nodiscard]] bool on_boundary(std::uint32_t v) const {
    std::uint32_t h = vertices[v].leading;
    do {
      if (is_ghost(h)) return true;
      h = around_vertex(h);
    } while (h != vertices[v].leading);
    return false;
  }
  /// Whether an edge joins two vertices. Walks around both at once, since one may have many edges.
  [[nodiscard]] bool has_edge(std::uint32_t p, std::uint32_t q) const {
    const std::uint32_t p0 = vertices[p].leading, q0 = vertices[q].leading;
    std::uint32_t at_p = p0, at_q = q0;
    do {
      if (target(at_p) == q || target(at_q) == p) return true;
      at_p = around_vertex(at_p);
      at_q = around_vertex(at_q);
    } while (at_p != p0 && at_q != q0);
    return false;
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
    vertices[p].leading = kVertexGone | q;
    set_twins(from_a, to_a);
    set_twins(from_b, to_b);
    remove(h >> 2);
    remove(t >> 2);
    return result;
  }

  /// Whether h may flip: it is not on the boundary, and no edge joins the vertices across from it.
  /// O(valence).
  [[nodiscard]] bool can_flip(std::uint32_t h) const {
    const std::uint32_t t = twin(h);
    return !is_ghost(h) && !is_ghost(t) && !has_edge(origin(previous(h)), origin(previous(t)));
  }
  /// Turns the edge p → q of h, with the faces (p, q, a) and (q, p, b), counter-clockwise into b → a: faces
  /// are (b, a, p) and (a, b, q), in the records of the old ones. Tags stay with their half-edges. Four flips
  /// change nothing. O(1).
  void flip(std::uint32_t h) {
    const std::uint32_t t = twin(h), nh = next(h), ph = previous(h), nt = next(t), pt = previous(t);
    Face &f = face(h), &g = face(t);
    const std::uint32_t p = origin(h), q = origin(t), a = origin(ph), b = origin(pt);
    const std::uint32_t beyond_qa = twin(nh), beyond_ap = twin(ph), beyond_pb = twin(nt),
                        beyond_bq = twin(pt);
    const std::uint32_t tags_f = f.tags, tags_g = g.tags;
    f.origin[h & 3u] = b;
    f.origin[nh & 3u] = a;
    f.origin[ph & 3u] = p;
    g.origin[t & 3u] = a;
    g.origin[nt & 3u] = b;
    g.origin[pt & 3u] = q;
    set_twins(nh, beyond_ap);
    set_twins(ph, beyond_pb);
    set_twins(nt, beyond_bq);
    set_twins(pt, beyond_qa);
    f.tags = (tags_f & (kTagsOfFace | kTagsOfFirst << (h & 3u))) | tags_for(tags_f, ph, nh) |
             tags_for(tags_g, nt, ph);
    g.tags = (tags_g & (kTagsOfFace | kTagsOfFirst << (t & 3u))) | tags_for(tags_g, pt, nt) |
             tags_for(tags_f, nh, pt);
    vertices[a].leading = nh;
    vertices[p].leading = ph;
    vertices[b].leading = nt;
    vertices[q].leading = pt;
  }
  /// Undoes flip(h).
  void unflip(std::uint32_t h) {
    for (int turns = 0; turns < 3; ++turns) flip(h);
  }

  /// Puts a vertex on the edge p → q of h, which is of no ghost, and returns it: m, whose record is a copy of
  /// p's but for `leading`. h is p → m afterwards. Both halves of the edge have its tags; a new face has the
  /// tags and the source of the face it was split from, and the edge between them no tags. On the boundary
  /// the ghost is split, too. O(1) on the average: arrays may grow, and a ghost may move to another record.
  std::uint32_t split(std::uint32_t h) {
    const std::uint32_t m = add_vertex(origin(h)), f = add_face();
    const std::uint32_t t = twin(h), g = is_ghost(t) ? add_ghost() : add_face();
    const std::uint32_t from_m = split_face(h, f, m), back_from_m = split_face(t, g, m);
    set_twins(h, back_from_m);
    set_twins(t, from_m);
    vertices[m].leading = from_m;
    return m;
  }

  /// Takes away a face of the mesh and the ghosts at it; the rest of its component must go, too.
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
  /// then from 0 on; never that of the last edge; `first` is 0 on the boundary. Their tags are 0. Returns the
  /// sources of the two faces that went, kInvalid for a ghost. At most kMaxHoleEdges edges; O(edges).
  std::array<std::uint32_t, 2> fill_hole(std::span<const std::uint32_t> edges,
                                         std::span<const std::array<std::uint8_t, 3>> triangles,
                                         std::size_t first = 0) {
    const std::size_t n = edges.size();
    std::array<std::uint32_t, kMaxHoleEdges> vertex, record;
    // By two corners the half-edge that waits for its twin: first what lies around the hole, then edges of
    // triangles whose other side is still to come.
    std::array<std::array<std::uint32_t, kMaxHoleEdges>, kMaxHoleEdges> beyond;
    for (std::size_t i = 0; i < n; ++i) {
      vertex[i] = target(edges[i]);
      record[i] = edges[i] >> 2;
      if (i + 1 < n)
        beyond[i][i + 1] = twin(next(edges[i]));
      else
        beyond[0][i] = twin(next(edges[i]));
    }
    // The faces at an apex are the last two.
    const std::size_t ghost = vertex[n - 1] == apex_ ? n - 1 : kInvalid;
    std::size_t taken = first;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t f = c == ghost ? record[n - 1] : record[taken], h = 4 * f;
      if (c != ghost) taken = taken + 2 < n ? taken + 1 : 0;
      Face& face = faces_[f];
      face.tags = 0;
      face.origin = {vertex[a], vertex[b], vertex[c]};
      vertices[vertex[a]].leading = h;
      vertices[vertex[b]].leading = h + 1;
      if (c != ghost) vertices[vertex[c]].leading = h + 2;
      set_twins(h + 2, beyond[a][c]);
      if (b == a + 1)
        set_twins(h, beyond[a][b]);
      else
        beyond[a][b] = h;
      if (c == b + 1)
        set_twins(h + 1, beyond[b][c]);
      else
        beyond[b][c] = h + 1;
    }
    const std::array<std::uint32_t, 2> gone = {record[taken], record[ghost == kInvalid ? n - 1 : n - 2]};
    for (const std::uint32_t f : gone) remove(f);
    return {faces_[gone[0]].source, faces_[gone[1]].source};
  }

  /// Names the first invariant that is broken, by element; nothing else can be relied on then. O(n log n).
  [[nodiscard]] Result<void> validate() const {
    std::vector<std::uint32_t> leading(vertex_bound_);
    for (std::size_t v = 0; v < vertex_bound_; ++v) leading[v] = v == apex_ ? kInvalid : vertices[v].leading;
    return validate_connectivity(leading);
  }

  LargeArray<Vertex> vertices;

 private:
  std::uint32_t add_vertex(std::uint32_t like) {
    if (vertex_bound_ == vertices.size()) vertices.grow(2 * vertex_bound_, vertex_bound_);
    vertices[vertex_bound_] = vertices[like];
    return static_cast<std::uint32_t>(vertex_bound_++);
  }
  std::uint32_t add_ghost() {
    const std::size_t used = face_count_ + ghosts_++;
    if (used == faces_.size()) faces_.grow(2 * used, used);
    return static_cast<std::uint32_t>(used);
  }
  /// A record for a face of the mesh, where the first ghost was, which moves to the end.
  std::uint32_t add_face() {
    const std::uint32_t end = add_ghost();
    const auto f = static_cast<std::uint32_t>(face_count_++);
    --ghosts_;
    if (f == end) return f;
    faces_[end] = faces_[f];
    if (!faces_[f].alive()) return f;
    for (std::uint32_t i = 0; i < 3; ++i) {
      set_twins(4 * end + i, faces_[end].twin[i]);
      if (const std::uint32_t v = faces_[end].origin[i]; v != apex_ && vertices[v].leading == 4 * f + i)
        vertices[v].leading = 4 * end + i;
    }
    return f;
  }
  /// Splits the face (x, y, a) of h = x → y into (x, m, a) and, in record f, (m, y, a). Returns m → y, which
  /// has no twin yet, and neither has h.
  std::uint32_t split_face(std::uint32_t h, std::uint32_t f, std::uint32_t m) {
    const std::uint32_t from_m = 4 * f + (h & 3u), nh = next(h), beyond = twin(nh), y = origin(nh);
    faces_[f] = face(h);
    faces_[f].origin[h & 3u] = m;
    face(h).origin[nh & 3u] = m;
    face(h).tags &= ~(kTagsOfFirst << (nh & 3u));
    faces_[f].tags &= ~(kTagsOfFirst << (previous(h) & 3u));
    set_twins(next(from_m), beyond);
    set_twins(previous(from_m), nh);
    if (vertices[y].leading == nh) vertices[y].leading = next(from_m);
    return from_m;
  }

  static constexpr std::uint32_t kTagsOfFirst = 0x11111111u, kTagsOfFace = 0x88888888u;
  /// The tags of one half-edge, for another corner.
  static std::uint32_t tags_for(std::uint32_t tags, std::uint32_t from, std::uint32_t to) {
    return (tags >> (from & 3u) & kTagsOfFirst) << (to & 3u);
  }

  std::size_t vertex_bound_ = 0;
};

}  // namespace vkmesh::detail
