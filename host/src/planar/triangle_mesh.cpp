#include "planar/triangle_mesh.h"

#include <algorithm>
#include <span>
#include <utility>

#include "base/huge_pages.h"
#include "base/parallel.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kLeastPart = 1 << 14;  // for a thread

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

HalfEdgeMesh canonical_mesh(PlanarTriangles triangles, std::size_t vertex_count,
                            RenumberedHalfEdges* numbers) {
  const std::uint32_t* const origin = triangles.origins.data();
  const std::size_t count = triangles.count;
  // The corner at the least vertex; 3 for triangles that are left out. kInvalid is the greatest number.
  const auto first_corner = [&](std::size_t t) -> std::uint32_t {
    const std::uint32_t a = origin[3 * t], b = origin[3 * t + 1], c = origin[3 * t + 2];
    if (std::max({a, b, c}) == kInvalid) return 3;
    return a < b ? (a < c ? 0 : 2) : (b < c ? 1 : 2);
  };
  // Each part of the triangles counts and places by itself; the parts of a vertex stand one after the other.
  const std::size_t parts = std::clamp<std::size_t>(
      count / kLeastPart, 1, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
  const auto for_each_in_part = [&](std::size_t part, auto&& use) {
    for (std::size_t t = count * part / parts; t < count * (part + 1) / parts; ++t)
      if (const std::uint32_t k = first_corner(t); k < 3)
        use(origin + 3 * t, k, static_cast<std::uint32_t>(t));
  };
  std::vector<std::vector<std::uint32_t>> ends(parts);
  parallel_ranges(parts, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t part = first; part < last; ++part) {
      ends[part].assign(vertex_count, 0);
      for_each_in_part(part, [&](const std::uint32_t* corner, std::uint32_t k, std::uint32_t) {
        ++ends[part][corner[k]];
      });
    }
  });
  std::uint32_t faces = 0;
  for (std::size_t v = 0; v < vertex_count; ++v)
    for (std::vector<std::uint32_t>& end : ends) {
      const std::uint32_t size = end[v];
      end[v] = faces;
      faces += size;
    }
  LargeArray<Face> by_vertex(faces);
  parallel_ranges(parts, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t part = first; part < last; ++part)
      for_each_in_part(part, [&](const std::uint32_t* corner, std::uint32_t k, std::uint32_t t) {
        by_vertex[ends[part][corner[k]]++] = {corner[(k + 1) % 3], corner[(k + 2) % 3], 4 * t + k};
      });
  });
  triangles.origins = {};
  const std::vector<std::uint32_t> end = std::move(ends.back());
  ends.clear();
  std::vector<std::uint32_t> origins = large_vector<std::uint32_t>(3 * std::size_t{faces});
  // For each triangle 4 times its face, and its corner that comes first.
  std::vector<std::uint32_t> renumbered(count, kInvalid);
  parallel_ranges(vertex_count, kLeastPart, [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v) {
      const std::uint32_t begin = v == 0 ? 0 : end[v - 1];
      sort_by_second(std::span(by_vertex.data(), faces).subspan(begin, end[v] - begin));
      for (std::uint32_t f = begin; f < end[v]; ++f) {
        const Face& face = by_vertex[f];
        origins[3 * std::size_t{f}] = static_cast<std::uint32_t>(v);
        origins[3 * std::size_t{f} + 1] = face.second;
        origins[3 * std::size_t{f} + 2] = face.third;
        renumbered[face.half_edge >> 2] = 4 * f + (face.half_edge & 3u);
      }
    }
  });
  by_vertex = {};
  std::vector<std::uint32_t> twins = large_vector<std::uint32_t>(3 * std::size_t{faces});
  constexpr std::array<std::array<std::uint8_t, 3>, 3> kCorner = {{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}};
  parallel_ranges(count, kLeastPart, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      const std::uint32_t here = renumbered[t];
      if (here == kInvalid) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t other = triangles.twins[3 * t + i], there = renumbered[other >> 2];
        twins[3 * std::size_t{here >> 2} + kCorner[here & 3u][i]] =
            there == kInvalid ? kInvalid : 3 * (there >> 2) + kCorner[there & 3u][other & 3u];
      }
    }
  });
  triangles.twins = {};
  if (numbers != nullptr) *numbers = RenumberedHalfEdges(std::move(renumbered));
  return HalfEdgeMesh::from_twins(std::move(origins), std::move(twins), vertex_count);
}

}  // namespace vkmesh::detail
