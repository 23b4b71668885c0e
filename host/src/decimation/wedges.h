// Where attributes are continuous, and where they are not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "decimation/collapse_mesh.h"

namespace vkmesh::detail {

/// The corners of each vertex in wedges (H. Hoppe, "Efficient implementation of progressive meshes", 1998):
/// those that follow each other around it with the same attributes. An edge whose sides are of different
/// wedges at one of its ends, or both, is a seam.
///
/// Where two seams pass through a vertex inside the surface and part its corners into two wedges, it may move
/// and go, along the seam. Any other vertex of a seam (where seams end, meet or reach the boundary) is fixed.
class Wedges {
 public:
  /// `same(c, d)`: whether two corners of the input, at one vertex, have the same attributes. Locks the
  /// vertices that are fixed. O(n).
  template <class Same>
  Wedges(CollapseMesh& mesh, std::size_t vertex_count, Same&& same)
      : of_(4 * mesh.face_count(), kInvalid), marks_(vertex_count, 0) {
    for (std::uint32_t v = 0; v < vertex_count; ++v)
      if (mesh.vertices[v].alive()) part(mesh, v, same);
    for (std::uint32_t v = 0; v < vertex_count; ++v)
      if (mesh.vertices[v].alive()) mark(mesh, v);
  }

  [[nodiscard]] std::size_t count() const { return source_corner_.size(); }
  /// Of the corner where h starts, which must not be of a ghost.
  [[nodiscard]] std::uint32_t operator[](std::uint32_t h) const { return of_[h]; }
  /// The first corner of the input that the wedge had.
  [[nodiscard]] std::uint32_t source_corner(std::uint32_t wedge) const { return source_corner_[wedge]; }

  [[nodiscard]] static std::uint32_t source_corner(const CollapseMesh& mesh, std::uint32_t h) {
    return 3 * mesh.face(h).source + (h & 3u);
  }

  [[nodiscard]] bool on_seam(std::uint32_t v) const { return (marks_[v] & kSeam) != 0; }
  [[nodiscard]] bool is_seam(const CollapseMesh& mesh, std::uint32_t h) const {
    const std::uint32_t t = mesh.twin(h);
    if (mesh.is_ghost(h) || mesh.is_ghost(t)) return false;
    return of_[h] != of_[CollapseMesh::next(t)] || of_[CollapseMesh::next(h)] != of_[t];
  }

  /// Whether the seams and the boundary are, after the collapse of h, the same curves as before, each chart
  /// between them is left, and all wedges find one to become part of: the link condition of the complex in
  /// which they are edges of their own.
  [[nodiscard]] bool keeps_seams(const CollapseMesh& mesh, std::uint32_t h) const {
    const std::uint32_t t = mesh.twin(h);
    const std::uint8_t p = marks_[mesh.origin(h)], q = marks_[mesh.origin(t)];
    if (((p | q) & kSeam) == 0) return true;
    const bool seam = is_seam(mesh, h);
    if (p != 0 && q != 0 && !seam && !on_boundary(mesh, h)) return false;
    if (seam && (of_[h] == of_[CollapseMesh::next(t)] || of_[CollapseMesh::next(h)] == of_[t])) return false;
    for (const std::uint32_t g : {h, t})
      if (!mesh.is_ghost(g) && is_curve(mesh, CollapseMesh::next(g)) &&
          is_curve(mesh, CollapseMesh::previous(g)))
        return false;
    return true;
  }

  /// Calls f(p's wedge, q's wedge) for those that the collapse of h = p → q makes one: two at a seam, else
  /// one.
  template <class F>
  void for_each_pair(const CollapseMesh& mesh, std::uint32_t h, F&& f) const {
    const std::uint32_t t = mesh.twin(h);
    std::uint32_t p = kInvalid, q = kInvalid;
    if (!mesh.is_ghost(h)) {
      p = of_[h];
      q = of_[CollapseMesh::next(h)];
      f(p, q);
    }
    if (mesh.is_ghost(t)) return;
    const std::uint32_t p2 = of_[CollapseMesh::next(t)], q2 = of_[t];
    if (p2 != p || q2 != q) f(p2, q2);
  }

  /// Calls f(wedge) once for each wedge of a vertex.
  template <class F>
  void for_each_at(const CollapseMesh& mesh, std::uint32_t v, F&& f) const {
    const std::uint32_t start = first_of_a_wedge(mesh, mesh.vertices[v].leading);
    std::uint32_t h = start, last = kInvalid;
    do {
      if (!mesh.is_ghost(h) && of_[h] != last) {
        last = of_[h];
        f(last);
      }
      h = mesh.around_vertex(h);
    } while (h != start);
  }

  /// To be called before the mesh collapses h = p → q: p's corners become q's.
  void collapse(const CollapseMesh& mesh, std::uint32_t h) {
    const std::uint32_t t = mesh.twin(h), p = mesh.origin(h), q = mesh.origin(t);
    const std::uint32_t on_left = mesh.is_ghost(h) ? kInvalid : of_[h];
    for (std::uint32_t out = mesh.around_vertex(h); out != h; out = mesh.around_vertex(out))
      if (!mesh.is_ghost(out)) of_[out] = of_[out] == on_left ? of_[CollapseMesh::next(h)] : of_[t];
    marks_[q] |= marks_[p];
  }

 private:
  static constexpr std::uint8_t kSeam = 1, kBoundary = 2;

  static bool on_boundary(const CollapseMesh& mesh, std::uint32_t h) {
    return mesh.is_ghost(h) || mesh.is_ghost(mesh.twin(h));
  }
  [[nodiscard]] bool is_curve(const CollapseMesh& mesh, std::uint32_t h) const {
    return on_boundary(mesh, h) || is_seam(mesh, h);
  }
  // The half-edge that leaves the same vertex, clockwise.
  static std::uint32_t before(const CollapseMesh& mesh, std::uint32_t h) {
    return CollapseMesh::next(mesh.twin(h));
  }
  [[nodiscard]] std::uint32_t first_of_a_wedge(const CollapseMesh& mesh, std::uint32_t start) const {
    const auto of = [&](std::uint32_t h) { return mesh.is_ghost(h) ? kInvalid : of_[h]; };
    std::uint32_t h = start;
    while (of(h) == of(before(mesh, h))) {
      h = mesh.around_vertex(h);
      if (h == start) break;
    }
    return h;
  }

  template <class Same>
  void part(const CollapseMesh& mesh, std::uint32_t v, Same&& same) {
    const auto begins = [&](std::uint32_t h) {
      const std::uint32_t b = before(mesh, h);
      return mesh.is_ghost(h) || mesh.is_ghost(b) || !same(source_corner(mesh, h), source_corner(mesh, b));
    };
    const std::uint32_t leading = mesh.vertices[v].leading;
    std::uint32_t start = leading;
    while (!begins(start)) {
      start = mesh.around_vertex(start);
      if (start == leading) break;
    }
    std::uint32_t h = start;
    do {
      if (!mesh.is_ghost(h)) {
        if (h == start || begins(h)) source_corner_.push_back(source_corner(mesh, h));
        of_[h] = static_cast<std::uint32_t>(source_corner_.size() - 1);
      }
      h = mesh.around_vertex(h);
    } while (h != start);
  }

  void mark(CollapseMesh& mesh, std::uint32_t v) {
    const std::uint32_t start = mesh.vertices[v].leading;
    std::size_t seams = 0, wedges = 0;
    bool boundary = false;
    std::uint32_t h = start;
    do {
      boundary |= mesh.is_ghost(h);
      seams += is_seam(mesh, h) ? 1 : 0;
      h = mesh.around_vertex(h);
    } while (h != start);
    for_each_at(mesh, v, [&](std::uint32_t) { ++wedges; });
    if (boundary) marks_[v] |= kBoundary;
    if (seams == 0) return;
    marks_[v] |= kSeam;
    if (boundary || seams != 2 || wedges != 2) mesh.vertices[v].source |= CollapseVertex::kLocked;
  }

  std::vector<std::uint32_t> of_;             // by half-edge of the mesh's own faces
  std::vector<std::uint32_t> source_corner_;  // by wedge
  std::vector<std::uint8_t> marks_;           // by vertex
};

}  // namespace vkmesh::detail
