#include "decimation/territories.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "parallel.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kCells = 256;

/// Cells of a grid of kCells³ over the cube [-1/2, 1/2]³ that holds the surface.
using Cell = std::array<std::uint8_t, 4>;

Cell cell_of(const std::array<float, 3>& position) {
  Cell cell{};
  for (std::size_t k = 0; k < 3; ++k)
    cell[k] = static_cast<std::uint8_t>(std::clamp((position[k] + 0.5f) * kCells, 0.0f, kCells - 1.0f));
  return cell;
}

constexpr std::size_t kGrain = std::size_t{1} << 16;

/// How many vertices of each part lie in each layer of cells, by axis.
struct Counts {
  explicit Counts(std::size_t parts = 0) : in(parts) {}
  Counts& operator+=(const Counts& more) {
    in.resize(std::max(in.size(), more.in.size()));
    for (std::size_t i = 0; i < more.in.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < kCells; ++c) in[i][k][c] += more.in[i][k][c];
    return *this;
  }

  std::vector<std::array<std::array<std::uint32_t, kCells>, 3>> in;
};

}  // namespace

std::vector<std::uint8_t> divide(CollapseMesh& mesh, std::size_t parts) {
  const std::size_t n = mesh.apex();
  std::vector<Cell> cells(n);
  std::vector<std::uint8_t> part(n + 1, 0);
  parallel_ranges(n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) cells[v] = cell_of(mesh.vertices[v].position);
  });
  // Each part is cut in two halves where it is longest (J. L. Bentley, "Multidimensional binary search trees
  // used for associative searching", 1975), all of one level at once.
  for (std::size_t level = 1; level < parts; level *= 2) {
    const auto counts = parallel_sum<Counts>(n, kGrain, [&](std::size_t begin, std::size_t end) {
      Counts some(level);
      for (std::size_t v = begin; v < end; ++v)
        for (std::size_t k = 0; k < 3; ++k) ++some.in[part[v]][k][cells[v][k]];
      return some;
    });
    struct Cut {
      std::size_t axis = 0;
      std::uint8_t first = 0;  // of the upper half
    };
    std::vector<Cut> cuts(level);
    for (std::size_t i = 0; i < level; ++i) {
      std::size_t longest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& in = counts.in[i][k];
        const auto occupied = [](std::uint32_t count) { return count > 0; };
        const auto low = std::find_if(in.begin(), in.end(), occupied);
        const auto high = std::find_if(in.rbegin(), in.rend(), occupied);
        const auto length = static_cast<std::size_t>(std::max<std::ptrdiff_t>(high.base() - low, 0));
        if (length <= longest) continue;
        longest = length;
        std::uint64_t all = 0, below = 0;
        for (const std::uint32_t count : in) all += count;
        std::size_t cell = 0;
        while (cell + 1 < kCells && 2 * (below + in[cell]) <= all) below += in[cell++];
        cuts[i] = {k, static_cast<std::uint8_t>(cell)};
      }
    }
    parallel_ranges(n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Cut& cut = cuts[part[v]];
        part[v] = static_cast<std::uint8_t>(2 * part[v] + (cells[v][cut.axis] >= cut.first ? 1 : 0));
      }
    });
  }
  std::vector<std::uint8_t> labels(part.size());
  for (std::size_t v = 0; v < part.size(); ++v) labels[v] = part[v] | Territory::kInner;
  mesh.parts().for_each([&](const VertexParts::Part& range) {
    range.for_each_face([&](std::uint32_t f) {
      if (!mesh.alive(4 * f)) return;  // pruned
      const auto& [a, b, c] = mesh.face(4 * f).origin;
      if (part[a] == part[b] && part[b] == part[c]) return;
      for (const std::uint32_t v : {a, b, c})
        if (range.has(v)) labels[v] = part[v];
    });
  });
  // Faces hold what is asked most often.
  parallel_ranges(mesh.half_edge_bound() / 4, kGrain, [&](std::size_t begin, std::size_t end) {
    for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
      CollapseMesh::Face& face = mesh.face(4 * f);
      if (!face.alive()) continue;
      for (std::uint32_t i = 0; i < 3; ++i)
        face.tags |= (labels[face.origin[i]] & Territory::kInner) == 0 ? 256u << i : 0u;
    }
  });
  return labels;
}

}  // namespace vkmesh::detail
