// Edge collapses in several partitions of a large surface side by side.
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

/// Edge collapses, the cheapest first. A large surface is partitioned: in each round the partitions collapse,
/// side by side, the edges whose cost is at most the round's limit, and then one thread collapses those on
/// the interface between them. The result depends on the surface, and not on the number of threads. With
/// attributes or criteria a surface is one partition.
template <class Placement, class Queue, bool kAttributes>
class PartitionedCollapses {
 public:
  static constexpr std::size_t kStep = kRemovalsBetweenReports;

  explicit PartitionedCollapses(DecimationState& state) : state_(state) {
    const std::size_t count = partition_count(), edges = 3 * state.first_faces / 2 + 1;
    if (count > 1) {
      labels_ = partition_kd(state.mesh, count);
      for (std::size_t i = 0; i < count; ++i)
        partitions_.push_back(std::make_unique<PartitionWork>(
            state, edges / count, Partition(labels_, static_cast<std::uint8_t>(i))));
    }
    interface_ = count > 1
                     ? std::make_unique<Share>(state, edges / 16, Partition(labels_, Partition::kInterface))
                     : std::make_unique<Share>(state, edges);
  }

  void fill() {
    CollapseMesh& mesh = state_.mesh;
    if (partitions_.empty()) {
      mine().fill([](CollapseMesh::Face&) { return std::array<std::uint8_t, 3>{}; },
                  [&](std::uint8_t, std::uint32_t h, float cost) { interface_->queue.fill(h, cost); });
      interface_->queue.start();
      return;
    }
    const auto mark = [&](CollapseMesh::Face& face) { return tag_interface(labels_, face); };
    for (std::size_t g = 4 * mesh.face_count(); g < mesh.half_edge_bound(); g += 4)
      if (CollapseMesh::Face& ghost = mesh.face(static_cast<std::uint32_t>(g)); ghost.alive()) mark(ghost);
    std::array<Queue*, Partition::kInterface + 1> queues{};
    for (std::size_t i = 0; i < partitions_.size(); ++i) queues[i] = &partitions_[i]->share.queue;
    queues[Partition::kInterface] = &interface_->queue;
    mine().fill(
        mark, [&](std::uint8_t partition, std::uint32_t h, float cost) { queues[partition]->fill(h, cost); });
  }

  bool step() {
    if constexpr (!Queue::kExact) {
      while (partitions_.size() > 2 && is_small()) merge_partition_pairs();
      if (!partitions_.empty() && (is_small() || is_late())) merge_all();
      if (!partitions_.empty()) return round();
    }
    Worker& worker = mine();
    for (std::size_t i = 0; i < kStep / Queue::kBatch && !state_.reached(); ++i) {
      if (i % 8 == 0) state_.ask();
      if (!worker.step()) return i > 0;
    }
    return true;
  }

  void count_blocked() { mine().count_blocked(); }

 private:
  using Worker = EdgeCollapses<Placement, Queue, kAttributes>;
  using Share = typename Worker::Share;

  static constexpr std::size_t kMaxPartitions = 64;
  /// Buckets of a round: two octaves; one for the last quarter of the removals; and a quarter of one where
  /// there are less than three times as many faces or vertices as are to be left, which decides over those.
  static constexpr std::uint32_t kFar = 32, kLast = 16, kNear = 4;

  [[nodiscard]] std::size_t partition_count() const {
    if (Queue::kExact || kAttributes || state_.criteria != nullptr) return 1;
    return std::clamp<std::size_t>(std::bit_floor(state_.first_faces / state_.sizes.partition_faces), 1,
                                   kMaxPartitions);
  }

  struct PartitionWork {
    PartitionWork(const DecimationState& all, std::size_t edges, Partition partition)
        : own(all), share(own.state, edges, partition) {}

    PartitionState own;
    std::size_t collapses = 0;  // of the last round, of which the next will have about as many
    Share share;
  };

  /// The worker of this thread, set to the edges outside the partitions.
  Worker& mine() {
    Worker& worker = workers_.local();
    worker.work_on(*interface_);
    return worker;
  }

  /// All partitions, each by a worker, up to the bucket `last`. Together they do not go beyond the limits.
  void run_side_by_side(std::uint32_t last) {
    const std::size_t divisor = 2 * partitions_.size(),
                      faces = (state_.faces - state_.limits.faces) / divisor,
                      vertices = (state_.vertices - state_.limits.vertices) / divisor;
    // Those with most to do first, or threads would wait for the last of them.
    std::vector<PartitionWork*> by_work;
    for (const auto& partition : partitions_) by_work.push_back(partition.get());
    std::ranges::stable_sort(by_work, std::ranges::greater(), &PartitionWork::collapses);
    std::atomic<std::size_t> next = 0;
    parallel_ranges(partitions_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (; begin < end; ++begin) {
        PartitionWork& partition = *by_work[next++];
        partition.own.start(faces, vertices);
        Worker& worker = workers_.local();
        worker.work_on(partition.share);
        worker.run(last);
      }
    });
    for (const auto& partition : partitions_) {
      partition->collapses = partition->own.state.outcome.collapses;
      partition->own.report_to(state_);
    }
  }

  bool round() {
    std::uint32_t last = interface_->queue.first();
    for (const auto& partition : partitions_) last = std::min(last, partition->share.queue.first());
    if (last == MonotoneQueue::kNone) return false;
    last += (is_near() ? kNear : is_last() ? kLast : kFar) - 1;
    for (const auto& partition : partitions_) partition->share.watch(state_);
    const auto done = static_cast<std::ptrdiff_t>(state_.outcome.events.size());
    run_side_by_side(last);
    Worker& worker = mine();
    for (const auto& partition : partitions_) worker.take_over(partition->share);
    // A history that stops anywhere has done as much in each partition.
    std::ranges::stable_sort(state_.outcome.events.begin() + done, state_.outcome.events.end(), {},
                             &Event::bucket);
    worker.run(last);
    return true;
  }

  [[nodiscard]] bool is_last() const {
    return 4 * (state_.faces - state_.limits.faces) < state_.first_faces - state_.limits.faces ||
           4 * (state_.vertices - state_.limits.vertices) < state_.first_vertices - state_.limits.vertices;
  }
  [[nodiscard]] bool is_near() const {
    return state_.faces < 3 * state_.limits.faces || state_.vertices < 3 * state_.limits.vertices;
  }
  /// Whether partitions have too few faces left,
  [[nodiscard]] bool is_small() const {
    return state_.faces < state_.sizes.partition_faces / 16 * partitions_.size();
  }
  /// or too few to remove in a round.
  [[nodiscard]] bool is_late() const {
    const std::size_t few = std::max(state_.sizes.partition_faces / 16, 4 * partitions_.size());
    return state_.faces - state_.limits.faces < few || state_.vertices - state_.limits.vertices < few / 2;
  }
  /// Half as many partitions, with less interface between them.
  void merge_partition_pairs() {
    CollapseMesh& mesh = state_.mesh;
    if (faces_left_.empty()) {
      faces_left_ = collect(mesh.half_edge_bound() / 4, [&](std::uint32_t f) {
        prefetch_stream(&mesh.face(4 * f));
        return mesh.alive(4 * f);
      });
    } else {
      std::erase_if(faces_left_, [&](std::uint32_t f) { return !mesh.alive(4 * f); });
    }
    merge_pairs(mesh, labels_, faces_left_);
    const auto halves = std::exchange(partitions_, {});
    for (std::size_t i = 0; i < halves.size() / 2; ++i)
      partitions_.push_back(std::make_unique<PartitionWork>(
          state_, halves[2 * i]->share.queue.size(), Partition(labels_, static_cast<std::uint8_t>(i))));
    Queue interface =
        std::exchange(interface_->queue, Queue(mesh.half_edge_bound(), interface_->queue.size()));
    const auto home = [&](std::uint32_t h) -> Queue* {
      if (!mesh.has_tag(h, kQueued)) return nullptr;
      return mesh.has_tag(h, kAtInterface)
                 ? &interface_->queue
                 : &partitions_[labels_[mesh.origin(h)] & ~Partition::kInner]->share.queue;
    };
    for (const auto& half : halves) half->share.queue.distribute(home);
    interface.distribute(home);
  }
  void merge_all() {
    std::size_t edges = 0;
    for (const auto& partition : partitions_) edges += partition->share.queue.size();
    interface_->queue.reserve(edges);
    for (auto& partition : partitions_) {
      interface_->queue.absorb(partition->share.queue);
      partition.reset();  // before the next, for its memory
    }
    partitions_.clear();
    interface_->last = MonotoneQueue::kLast;
  }

  DecimationState& state_;
  std::vector<std::uint8_t> labels_;
  std::vector<std::unique_ptr<PartitionWork>> partitions_;
  std::vector<std::uint32_t> faces_left_;  // when partitions were joined the last time; empty before
  std::unique_ptr<Share> interface_;
  tbb::enumerable_thread_specific<Worker> workers_{[this] { return Worker(state_.mesh); }};
};

}  // namespace vkmesh::detail
