// The triangles that edges are swapped in, and the mesh that is made of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <vkmesh/mesh/half_edge_mesh.h>

#include "base/large_array.h"

namespace vkmesh::detail {

/// Triangles with their twins. Half-edge 4t + i starts at corner i of triangle t, so that shifts find it.
/// Corners may be kInvalid, the vertex at infinity, in triangles that close the boundary.
struct PlanarTriangles {
  LargeArray<std::uint32_t> origins, twins;  // three for each triangle
  std::uint32_t count = 0;                   // of triangles; there may be room for more

  static std::size_t slot(std::uint32_t h) { return h - (h >> 2); }
  static std::uint32_t next(std::uint32_t h) { return (h & ~3u) | (0b00'10'01u >> 2 * (h & 3u) & 3u); }
  static std::uint32_t previous(std::uint32_t h) { return (h & ~3u) | (0b01'00'10u >> 2 * (h & 3u) & 3u); }

  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return origins[slot(h)]; }
  [[nodiscard]] std::uint32_t twin(std::uint32_t h) const { return twins[slot(h)]; }
  void set_twins(std::uint32_t a, std::uint32_t b) {
    twins[slot(a)] = b;
    twins[slot(b)] = a;
  }

  /// Swaps the edge q → r of h, with the triangles (p, q, r) and (r, q, s), for p → s: h is q → s of
  /// (p, q, s) then, p where it was, and the record of the other triangle has (p, s, r), from corner 0 on.
  void swap(std::uint32_t h) {
    const std::uint32_t n = next(h), u = twin(h), first = u & ~3u;
    const std::uint32_t beyond_qs = twin(next(u)), beyond_sr = twin(previous(u)), beyond_rp = twin(n);
    const std::uint32_t p = origin(previous(h)), r = origin(n), s = origin(previous(u));
    const std::size_t at = slot(first);
    origins[at] = p;
    origins[at + 1] = s;
    origins[at + 2] = r;
    origins[slot(n)] = s;
    set_twins(h, beyond_qs);
    set_twins(n, first);
    set_twins(first + 1, beyond_sr);
    set_twins(first + 2, beyond_rp);
  }
};

/// The half-edges of a mesh by those of the triangles that it was made of.
class RenumberedHalfEdges {
 public:
  RenumberedHalfEdges() = default;
  /// For each triangle 4 times its face, and its corner that comes first there; kInvalid where it was left
  /// out.
  explicit RenumberedHalfEdges(std::vector<std::uint32_t> of_triangle)
      : of_triangle_(std::move(of_triangle)) {}
  /// kInvalid for triangles that were left out.
  [[nodiscard]] std::uint32_t operator()(std::uint32_t h) const {
    const std::uint32_t here = of_triangle_[h >> 2];
    return here == kInvalid ? kInvalid : 3 * (here >> 2) + kCorner[here & 3u][h & 3u];
  }

 private:
  static constexpr std::array<std::array<std::uint8_t, 3>, 3> kCorner = {{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}};
  std::vector<std::uint32_t> of_triangle_;
};

/// The mesh of the triangles without a corner at infinity. Faces begin with their least vertex, and are
/// ordered by it and the vertex after it. Takes the triangles apart. O(n).
HalfEdgeMesh canonical_mesh(PlanarTriangles triangles, std::size_t vertex_count,
                            RenumberedHalfEdges* numbers = nullptr);

}  // namespace vkmesh::detail
