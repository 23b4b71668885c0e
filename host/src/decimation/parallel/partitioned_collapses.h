// Edge collapses in several parts of a large surface side by side.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.h"
#include "base/parallel_filter.h"
#include "base/prefetch.h"
#include "decimation/decimation_state.h"
#include "decimation/edge_collapses.h"
#include "decimation/order/collapse_queues.h"
#include "decimation/parallel/partition.h"

namespace vkmesh::detail {

/// Edge collapses, the cheapest first. A large surface is divided in parts: in rounds, each part does by
/// itself what costs no more than the round's limit, and then one thread does what lies on the interface
/// between them. What happens depends on the surface, and not on how many threads there are. With attributes
/// or criteria a surface is one part.
template <class Placement, class Queue, bool kAttributes>
class PartedCollapses {
 public:
  static constexpr std::size_t kStep = kRemovalsBetweenReports;
  static constexpr bool kMaySweep = !Queue::kExact;

  explicit PartedCollapses(DecimationState& state) : state_(state) {
    const std::size_t count = part_count(), edges = 3 * state.mesh.face_count() / 2 + 1;
    if (count > 1) {
      labels_ = divide(state.mesh, count);
      for (std::size_t i = 0; i < count; ++i)
        parts_.push_back(
            std::make_unique<Part>(state, edges / count, Territory(labels_, static_cast<std::uint8_t>(i))));
    }
    rest_ = count > 1 ? std::make_unique<Share>(state, edges / 16, Territory(labels_, Territory::kInterface))
                      : std::make_unique<Share>(state, edges);
  }

  void fill() {
    CollapseMesh& mesh = state_.mesh;
    if (parts_.empty()) {
      mine().fill([](CollapseMesh::Face&) { return std::array<std::uint8_t, 3>{}; },
                  [&](std::uint8_t, std::uint32_t h, float cost) { rest_->queue.fill(h, cost); });
      rest_->queue.start();
      return;
    }
    const auto mark = [&](CollapseMesh::Face& face) { return tag_interface(labels_, face); };
    for (std::size_t g = 4 * mesh.face_count(); g < mesh.half_edge_bound(); g += 4)
      if (CollapseMesh::Face& ghost = mesh.face(static_cast<std::uint32_t>(g)); ghost.alive()) mark(ghost);
    std::array<Queue*, Territory::kInterface + 1> queues{};
    for (std::size_t i = 0; i < parts_.size(); ++i) queues[i] = &parts_[i]->share.queue;
    queues[Territory::kInterface] = &rest_->queue;
    mine().fill(mark, [&](std::uint8_t part, std::uint32_t h, float cost) { queues[part]->fill(h, cost); });
  }

  bool step() {
    if constexpr (!Queue::kExact) {
      while (parts_.size() > 2 && is_small()) join_halves_of_parts();
      if (!parts_.empty() && (is_small() || is_late())) unite();
      if (!parts_.empty()) return round();
    }
    Worker& worker = mine();
    for (std::size_t i = 0; i < kStep / Queue::kBatch && !state_.reached(); ++i)
      if (!worker.step()) return i > 0;
    return true;
  }

  void hold() { mine().hold(); }

 private:
  using Worker = EdgeCollapses<Placement, Queue, kAttributes>;
  using Share = typename Worker::Share;

  static constexpr std::size_t kMostParts = 64;
  /// Buckets of a round: two octaves; one for the last quarter of the removals; and a quarter of one where
  /// there are less than three times as many faces or vertices as are to be left, which decides over those.
  static constexpr std::uint32_t kFar = 32, kLast = 16, kNear = 4;

  [[nodiscard]] std::size_t part_count() const {
    if (Queue::kExact || kAttributes || state_.criteria != nullptr) return 1;
    return std::clamp<std::size_t>(std::bit_floor(state_.mesh.face_count() / state_.part_faces), 1,
                                   kMostParts);
  }

  struct Part {
    Part(const DecimationState& all, std::size_t edges, Territory territory)
        : own(all), share(own.state, edges, territory) {}

    PartState own;
    std::size_t collapses = 0;  // of the last round, of which the next will have about as many
    Share share;
  };

  /// Of this thread, at work on what lies outside the parts.
  Worker& mine() {
    Worker& worker = workers_.local();
    worker.work_on(*rest_);
    return worker;
  }

  /// All parts, each by a worker, up to the bucket `last`. Together they do not go beyond the limits.
  void run_side_by_side(std::uint32_t last) {
    const std::size_t divisor = 2 * parts_.size(), faces = (state_.faces - state_.limits.faces) / divisor,
                      vertices = (state_.vertices - state_.limits.vertices) / divisor;
    // Those with most to do first, or threads would wait for the last of them.
    std::vector<Part*> by_work;
    for (const auto& part : parts_) by_work.push_back(part.get());
    std::ranges::stable_sort(by_work, std::ranges::greater(), &Part::collapses);
    std::atomic<std::size_t> next = 0;
    parallel_ranges(parts_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (; begin < end; ++begin) {
        Part& part = *by_work[next++];
        part.own.start(faces, vertices);
        Worker& worker = workers_.local();
        worker.work_on(part.share);
        worker.run(last);
      }
    });
    for (const auto& part : parts_) {
      part->collapses = part->own.state.outcome.collapses;
      part->own.report_to(state_);
    }
  }

  bool round() {
    std::uint32_t last = rest_->queue.first();
    for (const auto& part : parts_) last = std::min(last, part->share.queue.first());
    if (last == MonotoneQueue::kNone) return false;
    last += (is_near() ? kNear : is_last() ? kLast : kFar) - 1;
    for (const auto& part : parts_) part->share.watch(state_);
    const auto done = static_cast<std::ptrdiff_t>(state_.outcome.events.size());
    run_side_by_side(last);
    Worker& worker = mine();
    for (const auto& part : parts_) worker.take_over(part->share);
    // A history that stops anywhere has done as much in each part.
    std::ranges::stable_sort(state_.outcome.events.begin() + done, state_.outcome.events.end(), {},
                             &Event::bucket);
    worker.run(last);
    return true;
  }

  [[nodiscard]] bool is_last() const {
    return 4 * (state_.faces - state_.limits.faces) < state_.mesh.face_count() - state_.limits.faces ||
           4 * (state_.vertices - state_.limits.vertices) < state_.mesh.apex() - state_.limits.vertices;
  }
  [[nodiscard]] bool is_near() const {
    return state_.faces < 3 * state_.limits.faces || state_.vertices < 3 * state_.limits.vertices;
  }
  /// Parts must have some faces,
  [[nodiscard]] bool is_small() const { return state_.faces < state_.part_faces / 16 * parts_.size(); }
  /// and some to remove in a round.
  [[nodiscard]] bool is_late() const {
    const std::size_t few = std::max(state_.part_faces / 16, 4 * parts_.size());
    return state_.faces - state_.limits.faces < few || state_.vertices - state_.limits.vertices < few / 2;
  }
  /// Half as many parts, with less interface between them.
  void join_halves_of_parts() {
    CollapseMesh& mesh = state_.mesh;
    if (faces_left_.empty()) {
      faces_left_ = collect(mesh.half_edge_bound() / 4, [&](std::uint32_t f) {
        prefetch_stream(&mesh.face(4 * f));
        return mesh.alive(4 * f);
      });
    } else {
      std::erase_if(faces_left_, [&](std::uint32_t f) { return !mesh.alive(4 * f); });
    }
    join_halves(mesh, labels_, faces_left_);
    const auto halves = std::exchange(parts_, {});
    for (std::size_t i = 0; i < halves.size() / 2; ++i)
      parts_.push_back(std::make_unique<Part>(state_, halves[2 * i]->share.queue.size(),
                                              Territory(labels_, static_cast<std::uint8_t>(i))));
    Queue interface = std::exchange(rest_->queue, Queue(mesh.half_edge_bound(), rest_->queue.size()));
    const auto home = [&](std::uint32_t h) -> Queue* {
      if (!mesh.queued(h)) return nullptr;
      return mesh.at_interface(h) ? &rest_->queue
                                  : &parts_[labels_[mesh.origin(h)] & ~Territory::kInner]->share.queue;
    };
    for (const auto& half : halves) half->share.queue.hand_out(home);
    interface.hand_out(home);
  }
  void unite() {
    std::size_t edges = 0;
    for (const auto& part : parts_) edges += part->share.queue.size();
    rest_->queue.reserve(edges);
    for (auto& part : parts_) {
      rest_->queue.absorb(part->share.queue);
      part.reset();  // before the next, for its memory
    }
    parts_.clear();
    rest_->last = MonotoneQueue::kLast;
  }

  DecimationState& state_;
  std::vector<std::uint8_t> labels_;
  std::vector<std::unique_ptr<Part>> parts_;
  std::vector<std::uint32_t> faces_left_;  // when parts were joined the last time; empty before
  std::unique_ptr<Share> rest_;
  tbb::enumerable_thread_specific<Worker> workers_{[this] { return Worker(state_.mesh); }};
};

}  // namespace vkmesh::detail
