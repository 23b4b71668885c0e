#include "planar/triangle_mesh.h"

#include <algorithm>
#include <utility>

#include "base/huge_pages.h"

namespace vkmesh::detail {
namespace {

/// Its memory is free afterwards, which it is not after the assignment of an empty list.
template <class T>
void release(std::vector<T>& vector) {
  std::vector<T>().swap(vector);
}

}  // namespace

HalfEdgeMesh canonical_mesh(PlanarTriangles triangles, std::size_t vertex_count) {
  const std::uint32_t* const origin = triangles.origins.data();
  const std::size_t count = triangles.origins.size() / 3;
  // The corner at the least vertex; 3 for triangles that are left out. kInvalid is the greatest number.
  const auto first_corner = [&](std::size_t t) -> std::uint32_t {
    const std::uint32_t a = origin[3 * t], b = origin[3 * t + 1], c = origin[3 * t + 2];
    if (std::max({a, b, c}) == kInvalid) return 3;
    return a < b ? (a < c ? 0 : 2) : (b < c ? 1 : 2);
  };
  std::vector<std::uint32_t> end(vertex_count + 1, 0);
  for (std::size_t t = 0; t < count; ++t)
    if (const std::uint32_t k = first_corner(t); k < 3) ++end[origin[3 * t + k]];
  std::uint32_t faces = 0;
  for (std::uint32_t& offset : end) {
    const std::uint32_t size = offset;
    offset = faces;
    faces += size;
  }
  struct Face {
    std::uint32_t second, third, half_edge;  // the one that starts at the least vertex
  };
  std::vector<Face> by_vertex = large_vector<Face>(faces);
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t k = first_corner(t);
    if (k == 3) continue;
    const std::uint32_t* const corner = origin + 3 * std::size_t{t};
    by_vertex[end[corner[k]]++] = {corner[(k + 1) % 3], corner[(k + 2) % 3], 4 * t + k};
  }
  release(triangles.origins);
  std::vector<std::uint32_t> origins = large_vector<std::uint32_t>(3 * std::size_t{faces});
  // For each triangle 4 times its face, and its corner that comes first.
  std::vector<std::uint32_t> renumbered(count, kInvalid);
  for (std::uint32_t v = 0, f = 0; v < vertex_count; ++v) {
    std::sort(by_vertex.begin() + f, by_vertex.begin() + end[v],
              [](const Face& a, const Face& b) { return a.second < b.second; });
    for (; f < end[v]; ++f) {
      const Face& face = by_vertex[f];
      origins[3 * std::size_t{f}] = v;
      origins[3 * std::size_t{f} + 1] = face.second;
      origins[3 * std::size_t{f} + 2] = face.third;
      renumbered[face.half_edge >> 2] = 4 * f + (face.half_edge & 3u);
    }
  }
  release(by_vertex);
  std::vector<std::uint32_t> twins = large_vector<std::uint32_t>(3 * std::size_t{faces});
  constexpr std::array<std::array<std::uint8_t, 3>, 3> kCorner = {{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}};
  for (std::size_t t = 0; t < count; ++t) {
    const std::uint32_t here = renumbered[t];
    if (here == kInvalid) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t other = triangles.twins[3 * t + i], there = renumbered[other >> 2];
      twins[3 * std::size_t{here >> 2} + kCorner[here & 3u][i]] =
          there == kInvalid ? kInvalid : 3 * (there >> 2) + kCorner[there & 3u][other & 3u];
    }
  }
  release(triangles.twins);
  return HalfEdgeMesh::from_twins(std::move(origins), std::move(twins), vertex_count);
}

}  // namespace vkmesh::detail
