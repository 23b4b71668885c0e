// Edges between the queue and their collapse.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/prefetch.h"
#include "decimation/cost/edge_batch.h"
#include "decimation/vertex_record.h"
#include "mesh/edit/one_ring.h"

namespace vkmesh::detail {

/// A batch of edges that were taken from the queue. Waits for what they need of memory overlap.
template <std::size_t kBatch>
struct PendingEdges {
  std::array<std::uint32_t, kBatch> ids;  // half-edges, of which the first `count` are meant
  std::size_t count = 0;
  std::array<DueEdge, kBatch> due;  // of these edges, `due_count`
  std::size_t due_count = 0;
  /// The neighbours of p but q, and of q but p, of each due edge, before any of them collapsed.
  using Ring = FixedRing<16>;
  std::array<Ring, 2 * kBatch> walked;

  /// Prefetches the ends of the edges, and drops entries that are stale.
  void fetch(const CollapseMesh& mesh) {
    const CollapseMesh::Face* const faces = mesh.faces();
    const VertexRecord* const vertices = mesh.vertices.data();
    for (const std::uint32_t h : std::span(ids).first(count)) prefetch(&faces[h >> 2]);
    std::size_t queued = 0;
    for (const std::uint32_t h : std::span(ids).first(count)) {
      const std::uint32_t corner = h & 3u;
      const CollapseMesh::Face& face = faces[h >> 2];
      // Branchless: whether it is queued is unpredictable. Vertex 0 stands in for what is not needed.
      const std::uint32_t is_queued = face.tags >> corner & 1u;
      prefetch(&vertices[face.origin[corner] & (0 - is_queued)]);
      prefetch(&vertices[face.origin[CollapseMesh::kNextCorner[corner]] & (0 - is_queued)]);
      ids[queued] = h;
      queued += is_queued;
    }
    count = queued;
  }

  /// Walks around the ends of all due edges.
  void walk(const CollapseMesh& mesh) {
    const VertexRecord* const vertices = mesh.vertices.data();
    walks_.start(static_cast<std::uint32_t>(walked[0].vertex.size()));
    for (std::uint32_t i = 0; i < due_count; ++i) {
      const std::uint32_t h = due[i].half_edge, t = mesh.twin(h);
      prefetch(&mesh.face(t));
      walks_.add(h, h, walked[2 * i]);
      walks_.add(t, t, walked[2 * i + 1]);
    }
    walks_.walk(
        mesh,
        [vertices](Ring& ring, std::uint32_t number, const RingStep& step, bool) {
          prefetch(&vertices[step.vertex]);
          ring.vertex[number] = step.vertex;
          ring.edge[number] = step.edge;
          ring.size = number;
          return true;
        },
        [](Ring& ring) { ring.size = Ring::kTooLong; });
  }

 private:
  RingWalks<Ring> walks_;
};

}  // namespace vkmesh::detail
