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

namespace vkmesh::detail {

/// The neighbours of a vertex but one, counter-clockwise, and the half-edges from it to them.
struct WalkedRing {
  static constexpr std::uint32_t kMaxNeighbours = 16, kTooLong = ~0u;
  std::array<std::uint32_t, kMaxNeighbours> vertex, edge;  // the first `size` are meant
  std::uint32_t size;                                      // kTooLong when there are more

  [[nodiscard]] bool is_whole() const { return size != kTooLong; }
};

/// A batch of edges. What it waits for from memory is asked for step by step, while batches before it are
/// worked on. What those have changed meanwhile is known by its marks: such an edge goes back, such a ring is
/// walked again.
template <std::size_t kBatch>
struct PendingEdges {
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  std::array<std::uint32_t, kBatch> ids;  // `count` half-edges were taken from the queue
  std::size_t count = 0, queued = 0;
  bool evaluated = false;
  std::array<DueEdge, kBatch> due;  // of these `due_count` are due, and `tried` done
  std::size_t due_count = 0, tried = 0;
  std::array<WalkedRing, 2 * kBatch> walked;  // those of p and q of each due edge

  void reset() {
    count = queued = faces_fetched_ = ends_fetched_ = due_count = walks_ = tried = 0;
    evaluated = false;
  }

  /// The faces of `some` more of those taken.
  void fetch_faces(const CollapseMesh& mesh, std::size_t some) {
    const std::size_t end = some < count - faces_fetched_ ? faces_fetched_ + some : count;
    const CollapseMesh::Face* const faces = mesh.faces();
#if defined(__GNUC__)
#pragma GCC unroll 4
#endif
    for (std::size_t i = faces_fetched_; i < end; ++i) prefetch(&faces[ids[i] >> 2]);
    faces_fetched_ = end;
  }

  /// The ends of `some` more of those taken. What the queue holds no more in earnest is left out from now on:
  /// the first `queued` of `ids` remain.
  void fetch_ends(const CollapseMesh& mesh, std::size_t some) {
    const std::size_t end = some < count - ends_fetched_ ? ends_fetched_ + some : count;
    const CollapseMesh::Face* const faces = mesh.faces();
    const VertexRecord* const vertices = mesh.vertices.data();
    for (std::size_t i = ends_fetched_; i < end; ++i) {
      const std::uint32_t h = ids[i], corner = h & 3u;
      const CollapseMesh::Face& face = faces[h >> 2];
      // Branchless: whether it is queued is unpredictable. Vertex 0 stands in for what is not needed.
      const std::uint32_t is = face.tags >> corner & 1u;
      prefetch(&vertices[face.origin[corner] & (0 - is)]);
      prefetch(&vertices[face.origin[CollapseMesh::kNextCorner[corner]] & (0 - is)]);
      ids[queued] = h;
      queued += is;
    }
    ends_fetched_ = end;
  }

  /// Calls f(half-edge) for all that were taken and not left out.
  template <class F>
  void for_each_waiting(F&& f) const {
    for (std::size_t i = 0; i < queued; ++i) f(ids[i]);
    for (std::size_t i = ends_fetched_; i < count; ++i) f(ids[i]);
  }

  /// When all that are due are known.
  void start_walks(const CollapseMesh& mesh) {
    walks_ = 2 * due_count;
    walker_ = go_on_ = 0;
    steps_ = 0;
    for (std::uint32_t i = 0; i < due_count; ++i) {
      const std::uint32_t h = due[i].half_edge, t = mesh.twin(h);
      prefetch(&mesh.face(t));
      walk_[2 * i] = {h, h, &walked[2 * i]};
      walk_[2 * i + 1] = {t, t, &walked[2 * i + 1]};
    }
  }

  /// Walks around the ends of all due edges, one step of each in turn: one waits for all. `some` more steps.
  void walk(const CollapseMesh& mesh, std::size_t some) {
    const CollapseMesh::Face* const faces = mesh.faces();
    const VertexRecord* const vertices = mesh.vertices.data();
    while (some > 0 && walks_ > 0) {
      const std::size_t end = some < walks_ - walker_ ? walker_ + some : walks_;
      some -= end - walker_;
      const Walk* walk = &walk_[walker_];
      const Walk* const last = walk + (end - walker_);
      Walk* left = &walk_[go_on_];
      const std::uint32_t steps = steps_;
      for (; walk != last; ++walk) {
        const auto [at, start, ring] = *walk;
        const std::uint32_t corner = CollapseMesh::kPreviousCorner[at & 3u];
        const CollapseMesh::Face& face = faces[at >> 2];
        const std::uint32_t out = face.twin[corner], v = face.origin[corner];
        prefetch(&vertices[v]);
        prefetch(&faces[out >> 2]);
        ring->vertex[steps] = v;
        ring->edge[steps] = out;
        // What an earlier batch takes away meanwhile leads to where it lay.
        ring->size = v == kInvalid ? WalkedRing::kTooLong : steps;
        *left = {out, start, ring};
        left += static_cast<std::size_t>(out != start) & static_cast<std::size_t>(v != kInvalid);
      }
      go_on_ = static_cast<std::size_t>(left - walk_.data());
      walker_ = end;
      if (end < walks_) return;
      walks_ = go_on_;
      walker_ = go_on_ = 0;
      if (++steps_ < WalkedRing::kMaxNeighbours) continue;
      for (std::size_t i = 0; i < walks_; ++i) walk_[i].ring->size = WalkedRing::kTooLong;
      walks_ = 0;
    }
  }

 private:
  /// A walk around an end of an edge: at which half-edge it is, where it ends, and the ring that it makes.
  struct Walk {
    std::uint32_t at, start;
    WalkedRing* ring;
  };
  std::size_t faces_fetched_ = 0, ends_fetched_ = 0;
  // `walks_` are under way. Of these those before `walker_` have taken this step, and those before `go_on_`
  // take another.
  std::array<Walk, 2 * kBatch> walk_;
  std::size_t walks_ = 0, walker_ = 0, go_on_ = 0;
  std::uint32_t steps_ = 0;
};

}  // namespace vkmesh::detail
