// Queues of edges: each holds half-edges, one of the two of an edge, under lower bounds of the edge's cost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "base/addressable_heap.h"
#include "decimation/cost/edge_batch.h"
#include "decimation/order/monotone_queue.h"

namespace vkmesh::detail {

/// For costs that only rise.
class LazyQueue {
 public:
  static constexpr std::size_t kBatch = EdgeBatch::kSize;
  static constexpr bool kExact = false;
  LazyQueue(std::size_t, std::size_t edges) : queue_(edges) {}
  void fill(std::uint32_t id, float cost) { queue_.insert(id, cost); }
  void start() {}
  void insert(std::uint32_t id, float cost) { queue_.insert(id, cost); }
  void insert_now(std::uint32_t id) { queue_.insert_now(id); }
  void erase(std::uint32_t) {}
  [[nodiscard]] bool is_due(std::uint32_t, float cost) const { return queue_.is_due(cost); }
  /// The highest cost that is due.
  [[nodiscard]] float level() const { return queue_.level(); }
  std::size_t take(std::span<std::uint32_t> out, std::uint32_t last = MonotoneQueue::kLast) {
    return queue_.take(out, last);
  }
  /// That is being served.
  [[nodiscard]] std::uint32_t bucket() const { return queue_.floor(); }
  /// The first bucket that holds any; kNone when empty.
  [[nodiscard]] std::uint32_t first() const { return queue_.first(); }
  [[nodiscard]] std::size_t size() const { return queue_.size(); }
  void reserve(std::size_t more) { queue_.reserve(more); }
  /// All that another holds.
  void absorb(LazyQueue& other) { queue_.absorb(other.queue_); }
  /// Moves each entry to the queue that to(id) points to; drops it if to none.
  template <class To>
  void distribute(To&& to) {
    queue_.distribute([&](std::uint32_t id) {
      LazyQueue* const queue = to(id);
      return queue == nullptr ? nullptr : &queue->queue_;
    });
  }

 private:
  MonotoneQueue queue_;
};

/// For costs that may fall, and the exact order.
class ExactQueue {
 public:
  static constexpr std::size_t kBatch = 1;
  static constexpr bool kExact = true;
  ExactQueue(std::size_t half_edges, std::size_t) : heap_(half_edges) {}
  void fill(std::uint32_t id, float cost) { heap_.append(id, cost); }
  void start() { heap_.heapify(); }
  void insert(std::uint32_t id, float cost) { heap_.set(id, cost); }
  void insert_now(std::uint32_t id) { heap_.set(id, -1.0f); }
  void erase(std::uint32_t id) { heap_.remove(id); }
  [[nodiscard]] std::uint32_t bucket() const { return 0; }
  [[nodiscard]] float level() const {
    return heap_.empty() ? std::numeric_limits<float>::infinity() : heap_.top_priority();
  }
  [[nodiscard]] bool is_due(std::uint32_t id, float cost) const {
    return heap_.empty() || cost < heap_.top_priority() || (cost == heap_.top_priority() && id < heap_.top());
  }
  std::size_t take(std::span<std::uint32_t> out, std::uint32_t = 0) {
    if (heap_.empty()) return 0;
    out[0] = heap_.top();
    heap_.pop();
    return 1;
  }

 private:
  AddressableHeap<> heap_;
};

}  // namespace vkmesh::detail
