// Half-edge connectivity of an oriented 2-manifold, in flat arrays that upload to a device as they are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/handles.h>

namespace vkmesh {

class HalfEdgeMesh;

/// Walks the half-edges of a face in cyclic order, or those leaving a vertex counter-clockwise (seen from
/// outside), on a boundary vertex from the one that starts its fan. `Step` advances, `Value` maps to what the
/// range yields.
template <class Step, class Value>
class CirculatorRange {
 public:
  class iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using iterator_concept = std::forward_iterator_tag;
    using difference_type = std::ptrdiff_t;
    using value_type =
        decltype(std::declval<const Value&>()(std::declval<const HalfEdgeMesh&>(), HalfEdgeId{}));
    using reference = value_type;
    using pointer = void;

    iterator() = default;
    iterator(const HalfEdgeMesh* mesh, HalfEdgeId start) : mesh_(mesh), start_(start), current_(start) {}
    reference operator*() const { return Value{}(*mesh_, current_); }
    iterator& operator++() {
      current_ = Step{}(*mesh_, current_);
      if (current_ == start_) current_ = HalfEdgeId{};
      return *this;
    }
    iterator operator++(int) {
      iterator copy = *this;
      ++*this;
      return copy;
    }
    friend bool operator==(const iterator& a, const iterator& b) { return a.current_ == b.current_; }

   private:
    const HalfEdgeMesh* mesh_ = nullptr;
    HalfEdgeId start_;
    HalfEdgeId current_;
  };

  CirculatorRange(const HalfEdgeMesh& mesh, HalfEdgeId start) : begin_(&mesh, start) {}
  [[nodiscard]] iterator begin() const { return begin_; }
  [[nodiscard]] iterator end() const { return {}; }

 private:
  iterator begin_;
};

namespace detail {
struct StepNext;
struct StepAroundVertex;
struct YieldHalfEdge;
struct YieldOrigin;
struct YieldFace;
struct YieldTwinFace;
}  // namespace detail

/// Connectivity only; positions and attributes stand in arrays of their own, indexed by the handles.
///
/// The half-edges of a face stand side by side in cyclic order, so half-edge 3f + i starts at corner i of
/// triangle f, and `next`, `previous` and `face` are arithmetic. Memory: for triangles 8 bytes a half-edge
/// and 4 a vertex (about 52 bytes a vertex on a closed mesh); polygons add 4 bytes a half-edge and 4 a face.
class VKMESH_API HalfEdgeMesh {
 public:
  HalfEdgeMesh() = default;

  /// Adopts arrays built elsewhere, without judging them: `validate` does. `face_offsets` empty means
  /// triangles.
  static HalfEdgeMesh from_arrays(std::vector<std::uint32_t> origin, std::vector<std::uint32_t> twin,
                                  std::vector<std::uint32_t> leading,
                                  std::vector<std::uint32_t> face_offsets = {});

  /// The same of triangles, with the leading half-edges that to_half_edge_mesh() finds. O(half-edges).
  static HalfEdgeMesh from_twins(std::vector<std::uint32_t> origin, std::vector<std::uint32_t> twin,
                                 std::size_t vertex_count);

  [[nodiscard]] std::size_t vertex_count() const { return leading_.size(); }
  [[nodiscard]] std::size_t half_edge_count() const { return origin_.size(); }
  [[nodiscard]] std::size_t face_count() const {
    return is_triangles() ? origin_.size() / 3 : face_offsets_.size() - 1;
  }
  /// Undirected edges: pairs of twins and boundary half-edges. O(half-edges).
  [[nodiscard]] std::size_t edge_count() const;
  /// O(half-edges).
  [[nodiscard]] std::size_t boundary_half_edge_count() const;
  [[nodiscard]] bool is_triangles() const { return face_offsets_.empty(); }

  // Each of these is O(1). Handles must be valid and of this mesh.
  [[nodiscard]] VertexId origin(HalfEdgeId h) const { return VertexId(origin_[h.index]); }
  [[nodiscard]] VertexId target(HalfEdgeId h) const { return origin(next(h)); }
  /// Invalid on the boundary.
  [[nodiscard]] HalfEdgeId twin(HalfEdgeId h) const { return HalfEdgeId(twin_[h.index]); }
  [[nodiscard]] HalfEdgeId next(HalfEdgeId h) const;
  [[nodiscard]] HalfEdgeId previous(HalfEdgeId h) const;
  [[nodiscard]] FaceId face(HalfEdgeId h) const {
    return FaceId(is_triangles() ? h.index / 3 : face_[h.index]);
  }
  [[nodiscard]] HalfEdgeId first(FaceId f) const {
    return HalfEdgeId(is_triangles() ? 3 * f.index : face_offsets_[f.index]);
  }
  [[nodiscard]] unsigned face_size(FaceId f) const {
    return is_triangles() ? 3 : face_offsets_[f.index + 1] - face_offsets_[f.index];
  }
  /// A half-edge that leaves v: on a boundary vertex the one that starts its fan (it has no twin); invalid
  /// when v is isolated.
  [[nodiscard]] HalfEdgeId leading(VertexId v) const { return HalfEdgeId(leading_[v.index]); }
  [[nodiscard]] bool is_boundary(HalfEdgeId h) const { return twin_[h.index] == kInvalid; }
  [[nodiscard]] bool is_boundary(VertexId v) const {
    return leading_[v.index] != kInvalid && twin_[leading_[v.index]] == kInvalid;
  }
  [[nodiscard]] bool is_isolated(VertexId v) const { return leading_[v.index] == kInvalid; }
  /// The next half-edge that leaves the same vertex, counter-clockwise; invalid past the end of an open fan.
  [[nodiscard]] HalfEdgeId around_vertex(HalfEdgeId h) const { return twin(previous(h)); }
  /// The half-edge that follows boundary half-edge h along its boundary loop.
  [[nodiscard]] HalfEdgeId next_on_boundary(HalfEdgeId h) const { return leading(target(h)); }
  /// The half-edge that stands for the edge of h: the smaller of h and its twin.
  [[nodiscard]] HalfEdgeId edge(HalfEdgeId h) const {
    return twin_[h.index] < h.index ? HalfEdgeId(twin_[h.index]) : h;
  }
  [[nodiscard]] std::array<VertexId, 2> vertices_of_edge(HalfEdgeId h) const {
    return {origin(h), target(h)};
  }
  /// The faces that hold the edge of h, its own first; the second is invalid on the boundary.
  [[nodiscard]] std::array<FaceId, 2> faces_of_edge(HalfEdgeId h) const {
    return {face(h), is_boundary(h) ? FaceId{} : face(twin(h))};
  }

  /// The half-edge from a to b, or invalid. O(valence of a).
  [[nodiscard]] HalfEdgeId find_half_edge(VertexId a, VertexId b) const;

  // Circulators: ranges that take time proportional to what they yield.
  [[nodiscard]] CirculatorRange<detail::StepNext, detail::YieldHalfEdge> half_edges_around(FaceId f) const;
  [[nodiscard]] CirculatorRange<detail::StepNext, detail::YieldOrigin> vertices_around(FaceId f) const;
  /// One for each edge of f; invalid across the boundary.
  [[nodiscard]] CirculatorRange<detail::StepNext, detail::YieldTwinFace> faces_around(FaceId f) const;
  /// The half-edges that leave v. On a boundary vertex there is one fewer than neighbours.
  [[nodiscard]] CirculatorRange<detail::StepAroundVertex, detail::YieldHalfEdge> half_edges_around(
      VertexId v) const;
  [[nodiscard]] CirculatorRange<detail::StepAroundVertex, detail::YieldFace> faces_around(VertexId v) const;

  /// Calls f(VertexId) for each neighbour of v, counter-clockwise; on a boundary vertex from one boundary
  /// edge to the other.
  template <class F>
  void for_each_neighbour(VertexId v, F&& f) const {
    const HalfEdgeId start = leading(v);
    HalfEdgeId h = start;
    while (h.valid()) {
      f(target(h));
      const HalfEdgeId incoming = previous(h);
      h = twin(incoming);
      if (h == start) return;
      if (!h.valid()) f(origin(incoming));
    }
  }

  /// Calls f(HalfEdgeId) with each edge of the mesh once, as edge() names it, ascending. O(half-edges).
  template <class F>
  void for_each_edge(F&& f) const {
    for (std::uint32_t h = 0; h < half_edge_count(); ++h)
      if (edge(HalfEdgeId(h)).index == h) f(HalfEdgeId(h));
  }
  /// Calls f(HalfEdgeId) with each edge that ends at v, as edge() names it, counter-clockwise; on a boundary
  /// vertex from one boundary edge to the other. O(valence).
  template <class F>
  void for_each_edge_around(VertexId v, F&& f) const {
    const HalfEdgeId start = leading(v);
    HalfEdgeId h = start;
    while (h.valid()) {
      f(edge(h));
      const HalfEdgeId incoming = previous(h);
      h = twin(incoming);
      if (h == start) return;
      if (!h.valid()) f(edge(incoming));
    }
  }
  /// Calls f(HalfEdgeId) with each edge that shares a vertex with that of h, around its origin and then
  /// around its target. O(their valences).
  template <class F>
  void for_each_neighbour_of_edge(HalfEdgeId h, F&& f) const {
    for (const VertexId v : vertices_of_edge(h))
      for_each_edge_around(v, [&](HalfEdgeId e) {
        if (e != edge(h)) f(e);
      });
  }

  /// Each boundary loop as its half-edges in order, the loops by their smallest half-edge. O(half-edges).
  [[nodiscard]] std::vector<std::vector<HalfEdgeId>> boundary_loops() const;

  [[nodiscard]] std::span<const std::uint32_t> origins() const { return origin_; }
  [[nodiscard]] std::span<const std::uint32_t> twins() const { return twin_; }
  [[nodiscard]] std::span<const std::uint32_t> leadings() const { return leading_; }
  /// Empty for triangles; else face_count() + 1 half-edge offsets.
  [[nodiscard]] std::span<const std::uint32_t> face_offsets() const { return face_offsets_; }
  /// Empty for triangles; else the face of each half-edge.
  [[nodiscard]] std::span<const std::uint32_t> faces() const { return face_; }

 private:
  std::vector<std::uint32_t> origin_;
  std::vector<std::uint32_t> twin_;
  std::vector<std::uint32_t> leading_;
  std::vector<std::uint32_t> face_offsets_;
  std::vector<std::uint32_t> face_;
};

/// Checks every invariant of the structure and names the first that is broken, with its element: sizes, index
/// ranges, twins that are mutual and opposite, no edge used twice in one direction, faces without repeated
/// vertices, leading half-edges that start their fans, and one fan for each vertex. O(half-edges). Errors:
/// kInternal with the invariant's name.
[[nodiscard]] VKMESH_API Result<void> validate(const HalfEdgeMesh& mesh);

inline HalfEdgeId HalfEdgeMesh::next(HalfEdgeId h) const {
  if (is_triangles()) return HalfEdgeId(h.index % 3 == 2 ? h.index - 2 : h.index + 1);
  const std::uint32_t f = face_[h.index];
  return HalfEdgeId(h.index + 1 == face_offsets_[f + 1] ? face_offsets_[f] : h.index + 1);
}

inline HalfEdgeId HalfEdgeMesh::previous(HalfEdgeId h) const {
  if (is_triangles()) return HalfEdgeId(h.index % 3 == 0 ? h.index + 2 : h.index - 1);
  const std::uint32_t f = face_[h.index];
  return HalfEdgeId(h.index == face_offsets_[f] ? face_offsets_[f + 1] - 1 : h.index - 1);
}

namespace detail {
struct StepNext {
  HalfEdgeId operator()(const HalfEdgeMesh& m, HalfEdgeId h) const { return m.next(h); }
};
struct StepAroundVertex {
  HalfEdgeId operator()(const HalfEdgeMesh& m, HalfEdgeId h) const { return m.around_vertex(h); }
};
struct YieldHalfEdge {
  HalfEdgeId operator()(const HalfEdgeMesh&, HalfEdgeId h) const { return h; }
};
struct YieldOrigin {
  VertexId operator()(const HalfEdgeMesh& m, HalfEdgeId h) const { return m.origin(h); }
};
struct YieldFace {
  FaceId operator()(const HalfEdgeMesh& m, HalfEdgeId h) const { return m.face(h); }
};
struct YieldTwinFace {
  FaceId operator()(const HalfEdgeMesh& m, HalfEdgeId h) const {
    return m.is_boundary(h) ? FaceId{} : m.face(m.twin(h));
  }
};
}  // namespace detail

inline CirculatorRange<detail::StepNext, detail::YieldHalfEdge> HalfEdgeMesh::half_edges_around(
    FaceId f) const {
  return {*this, first(f)};
}
inline CirculatorRange<detail::StepNext, detail::YieldOrigin> HalfEdgeMesh::vertices_around(FaceId f) const {
  return {*this, first(f)};
}
inline CirculatorRange<detail::StepNext, detail::YieldTwinFace> HalfEdgeMesh::faces_around(FaceId f) const {
  return {*this, first(f)};
}
inline CirculatorRange<detail::StepAroundVertex, detail::YieldHalfEdge> HalfEdgeMesh::half_edges_around(
    VertexId v) const {
  return {*this, leading(v)};
}
inline CirculatorRange<detail::StepAroundVertex, detail::YieldFace> HalfEdgeMesh::faces_around(
    VertexId v) const {
  return {*this, leading(v)};
}

}  // namespace vkmesh
