// Decimation by removing vertices and filling the holes they leave.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/handles.h>

#include "decimation/collapse_mesh.h"
#include "decimation/driver.h"
#include "decimation/hole.h"

namespace vkmesh::detail {

/// Vertex removals, the cheapest first.
///
/// Each vertex that may go stands in the queue once. One that cannot be removed is parked, and comes back
/// when a neighbour has gone: nothing else can make its removal legal.
template <class Queue>
class VertexRemovals {
 public:
  explicit VertexRemovals(DecimationState& state)
      : state_(state),
        mesh_(state.mesh),
        vertices_(state.mesh.vertices),
        queue_(vertices_.size(), vertices_.size()) {}

  static constexpr std::size_t kStep = Queue::kBatch;

  /// All vertices with their costs.
  void fill() {
    for (std::uint32_t v = 0; v < mesh_.apex(); ++v) {
      const CollapseVertex& vertex = vertices_[v];
      if (!vertex.alive() || vertex.has(CollapseVertex::kLocked)) continue;
      if (evaluate(v))
        queue_.fill(v, hole_.error());
      else
        park(v, Legality::kFoldOver);
    }
    queue_.start();
  }

  /// Takes the next of the queue and removes those that are due and may go. False when nothing is left.
  bool step() {
    std::array<std::uint32_t, Queue::kBatch> taken{};
    const std::size_t count = queue_.take(taken);
    prefetch_stars(std::span(taken).first(count));
    for (std::size_t i = 0; i < count && !state_.reached(); ++i)
      if (vertices_[taken[i]].alive()) attempt(taken[i]);
    return count > 0;
  }

  /// Whether a vertex that was refused for its error still is.
  [[nodiscard]] bool held_by_error() {
    for (std::uint32_t v = 0; v < mesh_.apex(); ++v)
      if (vertices_[v].alive() && vertices_[v].has(CollapseVertex::kHasParked) && evaluate(v) && too_far(v))
        return true;
    return false;
  }

 private:
  /// Walks around v: `edges_` leave it counter-clockwise, and a boundary vertex has the apex at the end of
  /// the last. False for too many neighbours.
  bool collect(std::uint32_t v) {
    std::uint32_t h = vertices_[v].leading;
    count_ = 0;
    std::size_t apex = Hole::kMost + 1;
    const std::uint32_t start = h;
    do {
      if (count_ == edges_.size()) return false;
      const std::uint32_t r = mesh_.target(h);
      if (r == mesh_.apex()) apex = count_;
      edges_[count_] = h;
      ring_[count_++] = r;
      h = mesh_.around_vertex(h);
    } while (h != start);
    closed_ = apex > Hole::kMost;
    if (closed_) return count_ <= Hole::kMost;
    const auto turn = static_cast<std::ptrdiff_t>(apex) + 1, all = static_cast<std::ptrdiff_t>(count_);
    std::rotate(edges_.begin(), edges_.begin() + turn, edges_.begin() + all);
    std::rotate(ring_.begin(), ring_.begin() + turn, ring_.begin() + all);
    return true;
  }

  /// The best that may take v's place, into `hole_`.
  bool evaluate(std::uint32_t v) {
    if (!collect(v)) return false;
    const CollapseVertex& vertex = vertices_[v];
    const std::size_t neighbours = closed_ ? count_ : count_ - 1;
    std::array<Hole::Vector, Hole::kMost> ring;
    for (std::size_t i = 0; i < neighbours; ++i)
      for (std::size_t k = 0; k < 3; ++k) ring[i][k] = vertices_[ring_[i]].position[k] - vertex.position[k];
    return hole_.set(std::span(ring).first(neighbours), closed_) &&
           hole_.fill({vertex.a, vertex.b, vertex.c}, state_.limits.cos_deviation);
  }

  void attempt(std::uint32_t v) {
    if (!evaluate(v)) return park(v, Legality::kFoldOver);
    if (!queue_.is_due(v, hole_.error())) return queue_.insert(v, hole_.error());
    if (too_far(v)) return park(v, Legality::kError);
    // The faces across from v have no such corner already: else what is left would be a triangle on itself.
    if (count_ == 3 && mesh_.origin(CollapseMesh::previous(beyond(0))) == ring_[2])
      return park(v, Legality::kLink);
    while (forbid_existing()) {
      const CollapseVertex& vertex = vertices_[v];
      if (!hole_.fill({vertex.a, vertex.b, vertex.c}, state_.limits.cos_deviation))
        return park(v, Legality::kLink);
      if (!queue_.is_due(v, hole_.error())) return queue_.insert(v, hole_.error());
      if (too_far(v)) return park(v, Legality::kError);
    }
    if (hole_.folds_over()) return park(v, Legality::kFoldOver);
    remove(v);
  }

  [[nodiscard]] bool too_far(std::uint32_t v) const {
    return static_cast<double>(hole_.error()) >
           state_.limits.error2 * static_cast<double>(vertices_[v].weight);
  }

  /// Beyond the face between neighbour i and the next.
  [[nodiscard]] std::uint32_t beyond(std::size_t i) const {
    return mesh_.twin(CollapseMesh::next(edges_[i]));
  }

  /// Forbids each new edge that the mesh has already; whether there was one.
  bool forbid_existing() {
    bool found = false;
    const auto look = [&](std::size_t i, std::size_t j) {
      if (!hole_.is_new(i, j)) return;
      if (!has_edge(ring_[i], ring_[j])) return;
      hole_.forbid(i, j);
      found = true;
    };
    for (const auto [i, l, j] : hole_.triangles()) {
      look(i, l);
      look(l, j);
      look(i, j);
    }
    return found;
  }
  [[nodiscard]] bool has_edge(std::uint32_t p, std::uint32_t q) const {
    const std::uint32_t start = vertices_[p].leading;
    std::uint32_t h = start;
    do {
      if (mesh_.target(h) == q) return true;
      h = mesh_.around_vertex(h);
    } while (h != start);
    return false;
  }

  void park(std::uint32_t v, Legality why) {
    ++state_.outcome.rejected[static_cast<std::size_t>(why)];
    vertices_[v].source |= CollapseVertex::kHasParked;
  }

  void remove(std::uint32_t v) {
    CollapseVertex& gone = vertices_[v];
    const auto heirs = hole_.heirs();
    for (const auto [neighbour, share] : heirs) absorb(vertices_[ring_[neighbour]], gone, share);
    const auto most = std::max_element(heirs.begin(), heirs.end(),
                                       [](const auto& a, const auto& b) { return a.share < b.share; });
    const std::uint32_t heir = ring_[most->neighbour];
    if (gone.weight > 0)
      state_.outcome.error2 = std::max(state_.outcome.error2,
                                       static_cast<double>(hole_.error()) / static_cast<double>(gone.weight));

    std::array<Hole::Triangle, Hole::kMost + 1> triangles;
    std::size_t filled = hole_.triangles().size();
    std::copy_n(hole_.triangles().begin(), filled, triangles.begin());
    if (!closed_)
      triangles[filled++] = {0, static_cast<std::uint8_t>(count_ - 2), static_cast<std::uint8_t>(count_ - 1)};
    const auto faces = mesh_.fill_hole(std::span(edges_).first(count_), std::span(triangles).first(filled));
    gone.leading = CollapseVertex::kGone | heir;
    if (state_.keep_events)
      state_.outcome.events.push_back({vertices_[heir].source & CollapseVertex::kSourceMask,
                                       gone.source & CollapseVertex::kSourceMask, vertices_[heir].position,
                                       false, faces});
    state_.faces -= closed_ ? 2 : 1;
    --state_.vertices;
    ++state_.outcome.collapses;
    touched_.assign(ring_.begin(),
                    ring_.begin() + static_cast<std::ptrdiff_t>(closed_ ? count_ : count_ - 1));
    for (const std::uint32_t r : touched_) {
      if (vertices_[r].has(CollapseVertex::kHasParked)) {
        vertices_[r].source &= ~CollapseVertex::kHasParked;
        queue_.insert_now(r);
      } else if (Queue::kExact && !vertices_[r].has(CollapseVertex::kLocked)) {
        queue_.insert_now(r);
      }
    }
  }

  /// Adds a share of the quadric of `gone` to that of `heir`.
  static void absorb(CollapseVertex& heir, CollapseVertex gone, float share) {
    std::array<float, 3> d;
    for (std::size_t k = 0; k < 3; ++k) d[k] = heir.position[k] - gone.position[k];
    gone.shift(d);
    for (std::size_t k = 0; k < 6; ++k) heir.a[k] += share * gone.a[k];
    for (std::size_t k = 0; k < 3; ++k) heir.b[k] += share * gone.b[k];
    heir.c += share * gone.c;
    heir.weight += share * gone.weight;
  }

  // Each step for all, so that one waits for all.
  void prefetch_stars(std::span<const std::uint32_t> taken) {
    for (const std::uint32_t v : taken) prefetch(&vertices_[v]);
    for (const std::uint32_t v : taken)
      if (vertices_[v].alive()) prefetch(&mesh_.face(vertices_[v].leading));
    walk_.clear();
    for (const std::uint32_t v : taken)
      if (vertices_[v].alive()) walk_.push_back(vertices_[v].leading);
    for (int step = 0; step < 6; ++step)
      for (std::uint32_t& h : walk_) {
        prefetch(&vertices_[mesh_.target(h)]);
        h = mesh_.around_vertex(h);
        prefetch(&mesh_.face(h));
      }
  }

  DecimationState& state_;
  CollapseMesh& mesh_;
  LargeArray<CollapseVertex>& vertices_;
  Queue queue_;
  Hole hole_;
  std::array<std::uint32_t, Hole::kMost + 1> edges_, ring_;
  std::size_t count_ = 0;
  bool closed_ = false;
  std::vector<std::uint32_t> walk_, touched_;
};

}  // namespace vkmesh::detail
