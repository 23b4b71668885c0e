#include "planar/triangle_mesh.h"

#include <algorithm>
#include <span>
#include <utility>

#include "base/huge_pages.h"

namespace vkmesh::detail {
namespace {

struct Face {
  std::uint32_t second, third, half_edge;  // the one that starts at the least vertex
};

/// Most vertices have two faces.
void sort_by_second(std::span<Face> faces) {
  constexpr std::size_t kMany = 16;
  if (faces.size() > kMany)
    return std::sort(faces.begin(), faces.end(),
                     [](const Face& a, const Face& b) { return a.second < b.second; });
  for (std::size_t i = 1; i < faces.size(); ++i)
    for (std::size_t k = i; k > 0 && faces[k].second < faces[k - 1].second; --k)
      std::swap(faces[k], faces[k - 1]);
}

}  // namespace

HalfEdgeMesh canonical_mesh(PlanarTriangles triangles, std::size_t vertex_count) {
  const std::uint32_t* const origin = triangles.origins.data();
  const std::size_t count = triangles.count;
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
  LargeArray<Face> by_vertex(faces);
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t k = first_corner(t);
    if (k == 3) continue;
    const std::uint32_t* const corner = origin + 3 * std::size_t{t};
    by_vertex[end[corner[k]]++] = {corner[(k + 1) % 3], corner[(k + 2) % 3], 4 * t + k};
  }
  triangles.origins = {};
  std::vector<std::uint32_t> origins = large_vector<std::uint32_t>(3 * std::size_t{faces});
  // For each triangle 4 times its face, and its corner that comes first.
  std::vector<std::uint32_t> renumbered(count, kInvalid);
  for (std::uint32_t v = 0, f = 0; v < vertex_count; ++v) {
    sort_by_second(std::span(by_vertex.data(), faces).subspan(f, end[v] - f));
    for (; f < end[v]; ++f) {
      const Face& face = by_vertex[f];
      origins[3 * std::size_t{f}] = v;
      origins[3 * std::size_t{f} + 1] = face.second;
      origins[3 * std::size_t{f} + 2] = face.third;
      renumbered[face.half_edge >> 2] = 4 * f + (face.half_edge & 3u);
    }
  }
  by_vertex = {};
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
  triangles.twins = {};
  return HalfEdgeMesh::from_twins(std::move(origins), std::move(twins), vertex_count);
}

}  // namespace vkmesh::detail
