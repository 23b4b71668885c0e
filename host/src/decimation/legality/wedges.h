// Where attributes are continuous, and where they are not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/stop.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// On which sides of the seam through a vertex its neighbours stand, which are counted counter-clockwise from
/// one end of it: to the other end, `last`, on side 0, and from there on and the first again on side 1. Where
/// no seam passes, all stand on side 0.
struct SeamSides {
  std::size_t last;
  bool split;

  [[nodiscard]] std::size_t count() const { return split ? 2 : 1; }
  [[nodiscard]] bool has(std::size_t side, std::size_t i) const {
    return side == 0 ? i <= last : i == 0 || i >= last;
  }
  /// Whether the edge of neighbours a < b has these on both sides.
  [[nodiscard]] bool cross(std::size_t a, std::size_t b) const {
    return split && a > 0 && a < last && b > last;
  }
  /// The side of a triangle no edge of which crosses; `c` is its last corner.
  [[nodiscard]] std::size_t of(std::size_t c) const { return c <= last ? 0 : 1; }
};

/// The corners of each vertex in wedges (H. Hoppe, "Efficient implementation of progressive meshes", 1998):
/// those that follow each other around it with the same attributes. An edge whose sides are of different
/// wedges at one of its ends, or both, is a seam.
///
/// Where two seams pass through a vertex inside the surface and split its corners into two wedges, it may
/// move and go, along the seam. Where a seam ends, the values at its last edge differ at the other end alone,
/// and the vertex there has one wedge. It moves and goes as any other if the seam comes from a pole, all of
/// whose edges are seams: so the pole of a textured sphere loses one wedge with each vertex of the next
/// circle. Any other vertex of a seam (where seams end, meet or reach the boundary) is fixed.
class Wedges {
 public:
  /// `same(c, d)`: whether two corners of the input, at one vertex, have the same attributes. Locks the
  /// vertices that are fixed. O(n). Where `stop` is set meanwhile they are of no use.
  template <class Same>
  Wedges(CollapseMesh& mesh, std::size_t vertex_count, Same&& same, Stop* stop)
      : of_(4 * mesh.face_count(), kInvalid), marks_(vertex_count, 0) {
    constexpr std::uint32_t kBetween = 1 << 14;  // vertices from one question to the next
    const auto for_each_alive = [&](auto&& body) {
      for (std::uint32_t v = 0; v < vertex_count; ++v) {
        if (v % kBetween == 0 && !goes_on(stop)) return;
        if (mesh.vertices[v].alive()) body(v);
      }
    };
    for_each_alive([&](std::uint32_t v) { find_wedges(mesh, v, same); });
    if (!goes_on(stop)) return;
    for_each_alive([&](std::uint32_t v) { mark(mesh, v); });
  }

  [[nodiscard]] std::size_t count() const { return source_corner_.size(); }
  /// The wedge at the origin corner of h; h is of no ghost.
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

  /// Whether the shape of the edge of h, a seam, matters: not so at a pole, of whose edges each is one.
  [[nodiscard]] bool holds_shape(const CollapseMesh& mesh, std::uint32_t h) const {
    return is_seam(mesh, h) && !ends_from_fixed(mesh, h) && !ends_from_fixed(mesh, mesh.twin(h));
  }

  /// Whether the seams and the boundary are, after the collapse of h, the same curves as before, each chart
  /// between them is left, and all wedges find one to become part of: the link condition of the complex in
  /// which they are edges of their own.
  [[nodiscard]] bool keeps_seams(const CollapseMesh& mesh, std::uint32_t h) const {
    const std::uint32_t t = mesh.twin(h);
    const std::uint8_t p = marks_[mesh.origin(h)], q = marks_[mesh.origin(t)];
    if (((p | q) & (kSeam | kEnd)) == 0) return true;
    const bool seam = is_seam(mesh, h);
    if (seam && !differs_at_both_ends(mesh, h)) return false;
    if (!seam && !on_boundary(mesh, h)) {
      if ((p & kCurve) != 0 && (q & kCurve) != 0) return false;
      if (((p & kSeam) != 0 && q != 0) || ((q & kSeam) != 0 && p != 0)) return false;
    }
    bool at_pole = false;
    for (const std::uint32_t g : {h, t}) {
      if (mesh.is_ghost(g)) continue;
      const std::uint32_t next = CollapseMesh::next(g), previous = CollapseMesh::previous(g);
      if (!is_curve(mesh, next) || !is_curve(mesh, previous)) continue;
      // The face's chart goes on across h, which one face of the two must let go on.
      if (at_pole || seam || on_boundary(mesh, h) || !ends_at_both(mesh, next, previous)) return false;
      at_pole = true;
    }
    if (at_pole && !ends_alone(mesh, mesh.origin(h)) && !ends_alone(mesh, mesh.origin(t))) return false;
    // Ends of seams would join these to curves around a chart.
    const bool ends_meet =
        ((p & kEnd) != 0 && (q & (kEnd | kBoundary)) != 0) || ((q & kEnd) != 0 && (p & kBoundary) != 0);
    return at_pole || !ends_meet || seam || on_boundary(mesh, h);
  }

  /// Whether the values on the two sides of the edge of h, a seam, differ at either end.
  [[nodiscard]] bool differs_at_both_ends(const CollapseMesh& mesh, std::uint32_t h) const {
    return differs_at_origin(mesh, h) && differs_at_origin(mesh, mesh.twin(h));
  }
  /// Whether the seam of h's edge ends at its origin, and comes from a vertex that is fixed.
  [[nodiscard]] bool ends_from_fixed(const CollapseMesh& mesh, std::uint32_t h) const {
    return is_seam(mesh, h) && !differs_at_origin(mesh, h) && is_fixed(mesh.target(h));
  }
  /// Whether seams that meet or reach the boundary hold the vertex where it is.
  [[nodiscard]] bool is_fixed(std::uint32_t v) const { return (marks_[v] & kFixed) != 0; }

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

  // What follows is for vertices that go and leave a hole. `edges` are all that leave one which is not fixed,
  // counter-clockwise, of `neighbours` on the mesh; the apex is the target of the last if of any, and the
  // first is a seam if any are.

  [[nodiscard]] SeamSides sides(const CollapseMesh& mesh, std::span<const std::uint32_t> edges,
                                std::size_t neighbours) const {
    std::size_t last = neighbours - 1;
    if (!on_seam(mesh.origin(edges[0]))) return {last, false};
    while (!is_seam(mesh, edges[last])) --last;
    return {last, true};
  }
  /// The vertex's own wedge on a side.
  [[nodiscard]] std::uint32_t on_side(std::span<const std::uint32_t> edges, const SeamSides& sides,
                                      std::size_t side) const {
    return of_[edges[side == 0 ? 0 : sides.last]];
  }
  /// That of a neighbour who stands on this side.
  [[nodiscard]] std::uint32_t of_neighbour(std::span<const std::uint32_t> edges, const SeamSides& sides,
                                           std::size_t side, std::size_t i) const {
    if (i != (side == 0 ? sides.last : 0)) return of_[CollapseMesh::next(edges[i])];
    return of_[CollapseMesh::previous(edges[i > 0 ? i - 1 : edges.size() - 1])];
  }

  /// The same as for collapses, where triangles fill the hole on each side of a seam for itself, and the edge
  /// between both is the seam from then on.
  [[nodiscard]] bool keeps_seams(const CollapseMesh& mesh, std::span<const std::uint32_t> edges,
                                 const SeamSides& sides) const {
    const auto across = [&](std::size_t i) { return CollapseMesh::next(edges[i]); };
    const std::size_t last = sides.last;
    if (!sides.split) {
      const bool is_ear = edges.size() == 3 && mesh.is_ghost(edges[2]);
      return (!is_ear || !is_seam(mesh, across(0))) && can_shift_ends(mesh, edges);
    }
    // Where a side is one face, none takes its place, and the edge across becomes the seam.
    if (last == 1 && is_curve(mesh, across(0))) return false;
    if (last + 1 == edges.size() && is_curve(mesh, across(last))) return false;
    const auto differs = [&](std::size_t i) {
      return of_neighbour(edges, sides, 0, i) != of_neighbour(edges, sides, 1, i);
    };
    return differs(0) || differs(last);
  }

  /// Calls f(i) for the neighbours from which seams come that end at the vertex. When it goes, each must get
  /// but one new face, with its value beyond edge i: its seam then ends at the neighbour before it.
  template <class F>
  void for_each_end(const CollapseMesh& mesh, std::span<const std::uint32_t> edges, F&& f) const {
    const std::uint8_t marks = marks_[mesh.origin(edges[0])];
    if ((marks & kEnd) == 0 || (marks & kSeam) != 0) return;
    for (std::size_t i = 0; i < edges.size(); ++i)
      if (is_seam(mesh, edges[i])) f(i);
  }

  /// To be called before the mesh fills the hole with the same.
  void fill_hole(const CollapseMesh& mesh, std::span<const std::uint32_t> edges, std::size_t neighbours,
                 const SeamSides& sides, std::span<const std::array<std::uint8_t, 3>> triangles,
                 std::size_t first) {
    for_each_end(mesh, edges, [&](std::size_t i) { marks_[mesh.target(before(edges, i))] |= kEnd; });
    std::array<std::array<std::uint32_t, 3>, CollapseMesh::kMaxHoleEdges> made;
    std::size_t count = 0;
    for (const auto& corners : triangles) {
      if (corners[2] == neighbours) continue;  // closes the boundary
      const std::size_t side = sides.of(corners[2]);
      for (std::size_t i = 0; i < 3; ++i) made[count][i] = of_neighbour(edges, sides, side, corners[i]);
      ++count;
    }
    for (std::size_t t = 0; t < count; ++t)
      for (std::uint32_t i = 0; i < 3; ++i)
        of_[(edges[(first + t) % (edges.size() - 1)] & ~3u) + i] = made[t][i];
  }

 private:
  // Values differ at the vertex; it lies on the boundary; they differ at the other end of an edge there.
  static constexpr std::uint8_t kSeam = 1, kBoundary = 2, kEnd = 4, kFixed = 8, kCurve = kSeam | kBoundary;

  static bool on_boundary(const CollapseMesh& mesh, std::uint32_t h) {
    return mesh.is_ghost(h) || mesh.is_ghost(mesh.twin(h));
  }
  [[nodiscard]] bool is_curve(const CollapseMesh& mesh, std::uint32_t h) const {
    return on_boundary(mesh, h) || is_seam(mesh, h);
  }
  [[nodiscard]] bool can_shift_ends(const CollapseMesh& mesh, std::span<const std::uint32_t> edges) const {
    // A curve of seams that meet at the vertex would be cut, and one that reaches the boundary part from it.
    const bool on_the_boundary = (marks_[mesh.origin(edges[0])] & kBoundary) != 0;
    bool can = true;
    std::size_t ends = 0;
    for_each_end(mesh, edges, [&](std::size_t i) {
      const std::uint32_t h = before(edges, i), v = mesh.target(h);
      // The neighbour on which the seam ends next has no other curve that it would be joined to.
      const bool same_pole = ends_alone(mesh, v) && is_seam(mesh, CollapseMesh::next(h));
      can = can && ++ends == 1 && !on_the_boundary && ends_from_fixed(mesh, edges[i]) &&
            (marks_[v] == 0 || same_pole);
    });
    return can;
  }
  static std::uint32_t before(std::span<const std::uint32_t> edges, std::size_t i) {
    return edges[i > 0 ? i - 1 : edges.size() - 1];
  }
  [[nodiscard]] bool differs_at_origin(const CollapseMesh& mesh, std::uint32_t h) const {
    return of_[h] != of_[CollapseMesh::next(mesh.twin(h))];
  }
  /// Whether one seam ends at the vertex, away from the boundary: nothing else is joined to what it meets.
  [[nodiscard]] bool ends_alone(const CollapseMesh& mesh, std::uint32_t v) const {
    if ((marks_[v] & kCurve) != 0) return false;
    std::size_t seams = 0;
    const std::uint32_t start = mesh.vertices[v].leading;
    std::uint32_t h = start;
    do {
      seams += is_seam(mesh, h) ? 1 : 0;
      h = mesh.around_vertex(h);
    } while (h != start);
    return seams == 1;
  }
  /// Whether the two sides of a face that become one when the third collapses are both seams that end at that
  /// side and come from a vertex that is fixed, which loses nothing but a wedge.
  [[nodiscard]] bool ends_at_both(const CollapseMesh& mesh, std::uint32_t next,
                                  std::uint32_t previous) const {
    return !on_boundary(mesh, next) && !on_boundary(mesh, previous) && ends_from_fixed(mesh, next) &&
           ends_from_fixed(mesh, mesh.twin(previous));
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
  void find_wedges(const CollapseMesh& mesh, std::uint32_t v, Same&& same) {
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

  /// Whether the seam of the vertex comes from a pole: away from the boundary, and each of its edges is a
  /// seam at which its own values differ.
  [[nodiscard]] bool ends_at_pole(const CollapseMesh& mesh, std::uint32_t v) const {
    std::uint32_t h = mesh.vertices[v].leading;
    while (!is_seam(mesh, h)) h = mesh.around_vertex(h);
    const std::uint32_t from_pole = mesh.twin(h);
    h = from_pole;
    do {
      if (on_boundary(mesh, h) || !differs_at_origin(mesh, h)) return false;
      h = mesh.around_vertex(h);
    } while (h != from_pole);
    return true;
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
    if (wedges == 1 && seams == 1 && !boundary && ends_at_pole(mesh, v)) {
      marks_[v] |= kEnd;
      return;
    }
    marks_[v] |= kSeam;
    if (!boundary && seams == 2 && wedges == 2) return;
    marks_[v] |= kFixed;
    mesh.vertices[v].source |= VertexRecord::kLocked;
  }

  std::vector<std::uint32_t> of_;             // by half-edge of the mesh's own faces
  std::vector<std::uint32_t> source_corner_;  // by wedge
  std::vector<std::uint8_t> marks_;           // by vertex
};

}  // namespace vkmesh::detail
