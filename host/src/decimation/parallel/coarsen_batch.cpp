#include "decimation/parallel/coarsen_batch.h"

#include <algorithm>

#include "simd/target_clones.h"
#include "simd/transpose.h"

namespace vkmesh::detail {
namespace {

constexpr std::uint32_t kMaxNeighbours = CoarsenBatch::kMaxNeighbours;

// The first words of the neighbours' records, and what their quadrics say at their own places.
void gather_neighbours(const VertexRecord* vertices, CoarsenBatch& batch) {
  for (std::size_t i = 0; i < batch.count; ++i) {
    CoarsenBatch::Around& around = batch.around[i];
    for (std::size_t k = 0; k < CoarsenBatch::kMaxNeighbours; k += 4) {
      std::array<const void*, 4> records;
      for (std::size_t j = 0; j < 4; ++j) {
        const VertexRecord& neighbour = vertices[batch.ring[i].vertex[k + j]];
        records[j] = &neighbour;
        around.c[k + j] = neighbour.quadric.c;
      }
      transpose_records<4>(records, [&](std::size_t word) { return &around.words[word][k]; });
    }
  }
}

VKMESH_CLONES void find_best(const VertexRecord* vertices, const VertexRange& range, CoarsenBatch& batch) {
  for (std::size_t i = 0; i < batch.count; ++i) {
    const VertexRecord& p = vertices[batch.vertex[i]];
    const CoarsenBatch::Ring& ring = batch.ring[i];
    const CoarsenBatch::Around& around = batch.around[i];
    std::uint32_t least = CoarsenBatch::kNone, outside = 0;
    for (std::uint32_t k = 0; k < kMaxNeighbours; ++k) {
      const Vector3 there = {around.words[0][k], around.words[1][k], around.words[2][k]};
      const float cost = p.quadric.value(minus(there, p.position)) + around.c[k];
      const std::uint32_t bits = std::bit_cast<std::uint32_t>(cost) / kMaxNeighbours * kMaxNeighbours + k;
      least = least < bits ? least : bits;
      outside |= range.holds(ring.vertex[k]) ? 0u : 1u;
    }
    batch.is_inside[i] = 1 - outside;
    batch.best[i] = outside != 0 || ring.size == 0 ? CoarsenBatch::kNone : least;
  }
}

}  // namespace

void CoarsenBatch::set(const CollapseMesh& mesh, std::span<const std::uint32_t> chosen,
                       const VertexRange& range) {
  const VertexRecord* const vertices = mesh.vertices.data();
  count = chosen.size();
  std::copy(chosen.begin(), chosen.end(), vertex.begin());
  for (std::size_t i = 0; i < count; ++i) gather(ring[i], mesh, vertices[chosen[i]].leading);
  gather_neighbours(vertices, *this);
  find_best(vertices, range, *this);
  for (std::size_t i = 0; i < count; ++i)
    for (auto* const words : {&ring[i].vertex, &ring[i].edge}) {
      std::array<std::uint32_t, kMaxNeighbours> first;
      std::copy_n(words->begin(), kMaxNeighbours, first.begin());
      std::copy_n(first.begin(), kMaxNeighbours, words->begin() + ring[i].size);
    }
}

}  // namespace vkmesh::detail
