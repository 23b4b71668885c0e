// Triangle connectivity that is edited in place, half-edge by half-edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/half_edge_mesh.h>
#include <vkmesh/vec.h>

namespace vkmesh::detail {

/// Asks for the cache line at `address` without waiting for it.
inline void prefetch(const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(address);
#else
  static_cast<void>(address);
#endif
}

/// The mesh closed by one extra vertex, the apex, joined to every boundary edge by a triangle: there is no
/// boundary, so no walk has a special case, and the link condition of the closed complex is that of the mesh
/// with boundary (T. Dey, H. Edelsbrunner, S. Guha, D. Nekhayev, "Topology preserving edge contraction",
/// 1999). Only the apex may have several fans, and nothing walks around it.
///
/// Half-edge 4f + i starts at corner i of face f, i < 3: a face is a record of 32 bytes and shifts find it.
/// The faces of the mesh come first and keep their numbers.
class CollapseMesh {
 public:
  struct Face {
    std::array<std::uint32_t, 4> origin;  // [3] unused
    std::array<std::uint32_t, 4> twin;
  };

  static constexpr std::size_t kMaxFaces = std::size_t{1} << 30;

  /// A vertex and what is most often asked about it, in one cache line.
  struct Vertex {
    Vec3 position;
    std::uint32_t leading = kInvalid;
  };

  CollapseMesh(const HalfEdgeMesh& mesh, std::span<const Vec3> positions)
      : face_count_(mesh.face_count()), apex_(static_cast<std::uint32_t>(mesh.vertex_count())) {
    const auto origins = mesh.origins();
    const auto twins = mesh.twins();
    faces_.resize(face_count_ + mesh.boundary_half_edge_count());
    vertices_.reserve(mesh.vertex_count());
    for (const Vec3& position : positions) vertices_.push_back({position, kInvalid});
    const auto renumber = [](std::uint32_t h) { return 4 * (h / 3) + h % 3; };
    auto ghost = static_cast<std::uint32_t>(face_count_);
    for (std::uint32_t f = 0; f < face_count_; ++f)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t h = 4 * f + i, old_twin = twins[3 * f + i];
        faces_[f].origin[i] = origins[3 * f + i];
        vertices_[origins[3 * f + i]].leading = h;
        if (old_twin != kInvalid) {
          faces_[f].twin[i] = renumber(old_twin);
        } else {
          // The triangle (target, origin, apex) beyond the boundary edge.
          faces_[ghost].origin = {origins[3 * f + (i + 1) % 3], origins[3 * f + i], apex_, 0};
          set_twins(h, 4 * ghost);
          ++ghost;
        }
      }
    // Each boundary vertex has one ghost that leaves it towards the apex and one that arrives from there.
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const HalfEdgeId start = mesh.leading(VertexId(static_cast<std::uint32_t>(v)));
      if (!start.valid() || !mesh.is_boundary(start)) continue;
      const HalfEdgeId after = mesh.next_on_boundary(start);
      // start runs v → w, so its ghost holds w → v, v → apex, apex → w; that of the next edge w → x holds w →
      // apex.
      set_twins(twin(renumber(start.index)) + 2, twin(renumber(after.index)) + 1);
    }
  }

  /// Asks for what a walk around the ends p and q of half-edge h reads first.
  void prefetch(std::uint32_t h, std::uint32_t p, std::uint32_t q) const {
    detail::prefetch(&faces_[h >> 2]);
    detail::prefetch(&vertices_[p]);
    detail::prefetch(&vertices_[q]);
  }
  [[nodiscard]] std::uint32_t apex() const { return apex_; }
  [[nodiscard]] std::size_t face_count() const { return face_count_; }
  [[nodiscard]] bool is_ghost(std::uint32_t h) const { return h / 4 >= face_count_; }

  [[nodiscard]] static std::uint32_t next(std::uint32_t h) { return (h & 3u) == 2 ? h - 2 : h + 1; }
  [[nodiscard]] static std::uint32_t previous(std::uint32_t h) { return (h & 3u) == 0 ? h + 2 : h - 1; }
  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return faces_[h >> 2].origin[h & 3u]; }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return origin(next(h)); }
  [[nodiscard]] std::uint32_t twin(std::uint32_t h) const { return faces_[h >> 2].twin[h & 3u]; }
  /// The next half-edge that leaves the same vertex, counter-clockwise.
  [[nodiscard]] std::uint32_t around_vertex(std::uint32_t h) const { return twin(previous(h)); }
  /// A half-edge that leaves v; kInvalid when v is isolated or was removed.
  [[nodiscard]] std::uint32_t leading(std::uint32_t v) const { return vertices_[v].leading; }
  [[nodiscard]] const Vec3& position(std::uint32_t v) const { return vertices_[v].position; }
  [[nodiscard]] bool alive(std::size_t f) const { return faces_[f].origin[0] != kInvalid; }

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
    vertices_[q].leading = twin(a_to_p);  // p → a, now q → a
    if (a != apex_) vertices_[a].leading = a_out;
    if (b != apex_) vertices_[b].leading = b_out;
    vertices_[p].leading = kInvalid;
    set_twins(a_out, twin(a_to_p));
    set_twins(b_out, twin(b_to_q));
    const unsigned own = (is_ghost(h) ? 0u : 1u) + (is_ghost(t) ? 0u : 1u);
    faces_[h >> 2].origin[0] = kInvalid;
    faces_[t >> 2].origin[0] = kInvalid;
    return own;
  }

 private:
  void set_twins(std::uint32_t a, std::uint32_t b) {
    faces_[a >> 2].twin[a & 3u] = b;
    faces_[b >> 2].twin[b & 3u] = a;
  }

  std::vector<Face> faces_;
  std::vector<Vertex> vertices_;
  std::size_t face_count_ = 0;
  std::uint32_t apex_ = 0;
};

}  // namespace vkmesh::detail
