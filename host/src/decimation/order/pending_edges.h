// Edges on their way from the queue to their collapse.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <vkmesh/mesh/handles.h>

#include "base/prefetch.h"
#include "decimation/cost/edge_batch.h"
#include "decimation/vertex_record.h"
#include "mesh/edit/one_ring.h"

namespace vkmesh::detail {

/// A batch of edges on their way from the queue. What they need of memory is prefetched step by step, while
/// batches before it are worked on. Vertices that those have changed meanwhile are tagged as touched: such an
/// edge goes back to the queue, such a ring is walked again.
template <std::size_t kBatch>
struct PendingEdges {
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  std::array<std::uint32_t, kBatch> ids;  // `count` half-edges were taken from the queue
  std::size_t count = 0, queued = 0;
  bool evaluated = false;
  std::array<DueEdge, kBatch> due;  // of these `due_count` are due, and `tried` done
  std::size_t due_count = 0, tried = 0;
  /// The neighbours of p but q, and of q but p, of each due edge.
  using Ring = FixedRing<16>;
  std::array<Ring, 2 * kBatch> walked;

  void reset() {
    count = queued = faces_fetched_ = ends_fetched_ = due_count = tried = 0;
    evaluated = false;
    walks_.start(0);
  }

  /// Prefetches the faces of up to so many more of those taken.
  void fetch_faces(const CollapseMesh& mesh, std::size_t edges) {
    const std::size_t end = edges < count - faces_fetched_ ? faces_fetched_ + edges : count;
    const CollapseMesh::Face* const faces = mesh.faces();
#if defined(__GNUC__)
#pragma GCC unroll 4
#endif
    for (std::size_t i = faces_fetched_; i < end; ++i) prefetch(&faces[ids[i] >> 2]);
    faces_fetched_ = end;
  }

  /// Prefetches the ends of up to so many more of those taken. Stale entries are dropped from now on:
  /// the first `queued` of `ids` remain.
  void fetch_ends(const CollapseMesh& mesh, std::size_t edges) {
    const std::size_t end = edges < count - ends_fetched_ ? ends_fetched_ + edges : count;
    const CollapseMesh::Face* const faces = mesh.faces();
    const VertexRecord* const vertices = mesh.vertices.data();
    for (std::size_t i = ends_fetched_; i < end; ++i) {
      const std::uint32_t h = ids[i], corner = h & 3u;
      const CollapseMesh::Face& face = faces[h >> 2];
      // Branchless: whether it is queued is unpredictable. Vertex 0 stands in for what is not needed.
      const std::uint32_t is_queued = face.tags >> corner & 1u;
      prefetch(&vertices[face.origin[corner] & (0 - is_queued)]);
      prefetch(&vertices[face.origin[CollapseMesh::kNextCorner[corner]] & (0 - is_queued)]);
      ids[queued] = h;
      queued += is_queued;
    }
    ends_fetched_ = end;
  }

  /// Calls f(half-edge) for all that were taken and not dropped.
  template <class F>
  void for_each_waiting(F&& f) const {
    for (std::size_t i = 0; i < queued; ++i) f(ids[i]);
    for (std::size_t i = ends_fetched_; i < count; ++i) f(ids[i]);
  }

  /// When all that are due are known.
  void start_walks(const CollapseMesh& mesh) {
    walks_.start(static_cast<std::uint32_t>(walked[0].vertex.size()));
    for (std::uint32_t i = 0; i < due_count; ++i) {
      const std::uint32_t h = due[i].half_edge, t = mesh.twin(h);
      prefetch(&mesh.face(t));
      walks_.add(h, h, walked[2 * i]);
      walks_.add(t, t, walked[2 * i + 1]);
    }
  }

  /// Walks around the ends of all due edges, up to so many more steps.
  void walk(const CollapseMesh& mesh, std::size_t steps) {
    const VertexRecord* const vertices = mesh.vertices.data();
    walks_.walk(
        mesh, steps,
        [vertices](Ring& ring, std::uint32_t number, const RingStep& step, bool) {
          prefetch(&vertices[step.vertex]);
          ring.vertex[number] = step.vertex;
          ring.edge[number] = step.edge;
          // What an earlier batch takes away meanwhile leads to where it lay.
          ring.size = step.vertex == kInvalid ? Ring::kTooLong : number;
          return step.vertex != kInvalid;
        },
        [](Ring& ring) { ring.size = Ring::kTooLong; });
  }

 private:
  std::size_t faces_fetched_ = 0, ends_fetched_ = 0;
  RingWalks<Ring> walks_;
};

}  // namespace vkmesh::detail
