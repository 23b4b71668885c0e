#include "decimation/parallel/partition.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <span>

#include "base/parallel.h"
#include "base/prefetch.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kCells = 256;

using Position = std::array<float, 3>;

/// The cell of a position along an axis, and where in it, in a grid of kCells³ over the cube [-1/2, 1/2]³
/// that holds the surface.
float along(const Position& position, std::size_t axis) {
  return (position[axis] + 0.5f) * kCells;
}

constexpr std::size_t kGrain = std::size_t{1} << 14;

/// Where partitions are split in halves: partition i of a level by split i of that level, into partitions 2i
/// and 2i + 1 of the next.
struct Split {
  std::size_t axis = 0;
  float first = 0;  // cell of the upper half
};
using Splits = std::vector<std::vector<Split>>;

std::size_t half_of(const Split& split, const Position& position) {
  return along(position, split.axis) >= split.first ? 1 : 0;
}

/// Splits each partition in two halves of as many positions where it is longest (J. L. Bentley,
/// "Multidimensional binary search trees used for associative searching", 1975), all of one level at once.
Splits split_at_medians(std::span<const Position> positions, std::size_t partitions) {
  Splits splits;
  std::vector<std::uint8_t> partition(positions.size(), 0);
  for (std::size_t level = 1; level < partitions; level *= 2) {
    std::vector<std::array<std::array<std::uint32_t, kCells>, 3>> counts(level);
    for (std::size_t i = 0; i < positions.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        ++counts[partition[i]][k]
                [static_cast<std::size_t>(std::clamp(along(positions[i], k), 0.0f, kCells - 1.0f))];
    std::vector<Split>& here = splits.emplace_back(level);
    for (std::size_t i = 0; i < level; ++i) {
      std::size_t longest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& in = counts[i][k];
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
        here[i] = {k, static_cast<float>(cell)};
      }
    }
    for (std::size_t i = 0; i < positions.size(); ++i)
      partition[i] = static_cast<std::uint8_t>(2 * partition[i] + half_of(here[partition[i]], positions[i]));
  }
  return splits;
}

}  // namespace

std::vector<std::uint8_t> partition_kd(CollapseMesh& mesh, std::size_t partitions) {
  const std::size_t n = mesh.apex();
  constexpr std::size_t kSample = std::size_t{1} << 15;  // vertices are enough to know where the middle is
  const std::size_t stride = std::max<std::size_t>(n / kSample, 1);
  std::vector<Position> sample;
  for (std::size_t v = 0; v < n; v += stride)
    if (mesh.vertices[v].alive()) sample.push_back(mesh.vertices[v].position);
  const Splits splits = split_at_medians(sample, partitions);

  std::vector<std::uint8_t> partition(n + 1, 0);
  parallel_ranges(n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const VertexRecord& vertex = mesh.vertices[v];
      prefetch_stream(&vertex);
      std::size_t at = 0;
      for (const std::vector<Split>& level : splits) at = 2 * at + half_of(level[at], vertex.position);
      partition[v] = static_cast<std::uint8_t>(at);
    }
  });
  std::vector<std::uint8_t> labels(partition.size());
  for (std::size_t v = 0; v < partition.size(); ++v) labels[v] = partition[v] | Partition::kInner;
  // Threads may write the same byte, and then the same value: collapses may have brought any corners to a
  // face.
  parallel_ranges(mesh.face_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      // Branchless: whether a face is alive is unpredictable. One that is gone has no first corner.
      const CollapseMesh::Face& face = mesh.face(static_cast<std::uint32_t>(4 * f));
      prefetch_stream(&face);
      const std::uint32_t a = std::min(face.origin[0], mesh.apex()), b = face.origin[1], c = face.origin[2];
      const auto differ =
          static_cast<std::uint32_t>((partition[a] ^ partition[b]) | (partition[b] ^ partition[c]));
      if ((differ & (0u - static_cast<std::uint32_t>(face.alive()))) == 0) continue;
      for (const std::uint32_t v : {a, b, c})
        std::atomic_ref(labels[v]).store(partition[v], std::memory_order_relaxed);
    }
  });
  return labels;
}

void merge_pairs(CollapseMesh& mesh, std::span<std::uint8_t> labels, std::span<const std::uint32_t> faces) {
  for (std::uint8_t& label : labels)
    label = static_cast<std::uint8_t>((label & ~Partition::kInner) >> 1) | Partition::kInner;
  const auto owner = [&](std::uint32_t v) { return labels[v] & ~Partition::kInner; };
  for (const std::uint32_t f : faces) {
    if (mesh.is_ghost(4 * f)) continue;
    const auto& [a, b, c] = mesh.face(4 * f).origin;
    if (((owner(a) ^ owner(b)) | (owner(b) ^ owner(c))) == 0) continue;
    for (const std::uint32_t v : {a, b, c}) labels[v] &= static_cast<std::uint8_t>(~Partition::kInner);
  }
  for (const std::uint32_t f : faces) tag_interface(labels, mesh.face(4 * f));
}

}  // namespace vkmesh::detail
