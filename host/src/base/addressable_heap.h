// A priority queue whose entries can be found again, changed and removed.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/huge_pages.h"

namespace vkmesh {

/// An implicit d-ary min-heap over the ids 0 … capacity − 1, each present at most once (D. B. Johnson,
/// "Priority queues with update and finding minimum spanning trees", 1975). Equal priorities fall to the
/// smaller id, so the order of removal depends on nothing but the entries. Eight children fill one cache
/// line. Memory: 8 bytes an entry, 4 an id.
template <unsigned Arity = 8>
class AddressableHeap {
 public:
  AddressableHeap() = default;
  /// Ids must be < capacity.
  explicit AddressableHeap(std::size_t capacity) : slot_(detail::large_vector<std::uint32_t>(capacity)) {
    std::ranges::fill(slot_, kAbsent);
    entries_.reserve(capacity);
    detail::prefer_large_pages(entries_.data(), capacity * sizeof(Entry));
  }

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] bool contains(std::uint32_t id) const { return slot_[id] != kAbsent; }
  /// The id must be present.
  [[nodiscard]] float priority(std::uint32_t id) const { return priority_of(entries_[slot_[id]]); }

  /// The id and the priority of the entry with the least (priority, id). The heap must not be empty.
  [[nodiscard]] std::uint32_t top() const { return id_of(entries_.front()); }
  [[nodiscard]] float top_priority() const { return priority_of(entries_.front()); }

  /// Adds an entry at the end without keeping the order; `heapify` restores it. The id must be absent, the
  /// priority no NaN. O(1).
  void append(std::uint32_t id, float priority) {
    slot_[id] = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back(pack(id, priority));
  }

  /// Restores the order after `append`. O(size).
  void heapify() {
    if (entries_.size() < 2) return;
    for (std::size_t i = (entries_.size() - 2) / Arity + 1; i-- > 0;) sink(i, entries_[i]);
  }

  /// Adds the id, or changes its priority, which must be no NaN. O(log size).
  void set(std::uint32_t id, float priority) {
    const Entry entry = pack(id, priority);
    const std::uint32_t slot = slot_[id];
    if (slot == kAbsent) {
      entries_.push_back(entry);
      rise(entries_.size() - 1, entry);
    } else if (entry < entries_[slot]) {
      rise(slot, entry);
    } else if (entries_[slot] < entry) {
      sink(slot, entry);
    }
  }

  /// Removes the id if it is present. O(log size).
  void remove(std::uint32_t id) {
    const std::uint32_t slot = slot_[id];
    if (slot == kAbsent) return;
    slot_[id] = kAbsent;
    const Entry last = entries_.back();
    const Entry removed = entries_[slot];
    entries_.pop_back();
    if (slot == entries_.size()) return;
    if (last < removed) {
      rise(slot, last);
    } else {
      sink(slot, last);
    }
  }

  /// Removes the top. O(log size).
  void pop() { remove(top()); }

 private:
  static constexpr std::uint32_t kAbsent = 0xffffffffu;
  /// The priority's bits, made to sort as integers do, above the id: one comparison orders both.
  using Entry = std::uint64_t;

  static Entry pack(std::uint32_t id, float priority) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(priority + 0.0f);  // -0 becomes 0
    const std::uint32_t sortable = (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
    return (static_cast<Entry>(sortable) << 32) | id;
  }
  static std::uint32_t id_of(Entry entry) { return static_cast<std::uint32_t>(entry); }
  static float priority_of(Entry entry) {
    const auto sortable = static_cast<std::uint32_t>(entry >> 32);
    return std::bit_cast<float>((sortable & 0x80000000u) != 0 ? sortable & 0x7fffffffu : ~sortable);
  }

  void place(std::size_t slot, Entry entry) {
    entries_[slot] = entry;
    slot_[id_of(entry)] = static_cast<std::uint32_t>(slot);
  }

  void rise(std::size_t slot, Entry entry) {
    while (slot > 0) {
      const std::size_t parent = (slot - 1) / Arity;
      if (entries_[parent] < entry) break;
      place(slot, entries_[parent]);
      slot = parent;
    }
    place(slot, entry);
  }

  void sink(std::size_t slot, Entry entry) {
    for (;;) {
      const std::size_t first = slot * Arity + 1;
      if (first >= entries_.size()) break;
      const std::size_t end = std::min(first + Arity, entries_.size());
      std::size_t least = first;
      for (std::size_t i = first + 1; i < end; ++i)
        if (entries_[i] < entries_[least]) least = i;
      if (entry < entries_[least]) break;
      place(slot, entries_[least]);
      slot = least;
    }
    place(slot, entry);
  }

  std::vector<Entry> entries_;
  std::vector<std::uint32_t> slot_;
};

}  // namespace vkmesh
