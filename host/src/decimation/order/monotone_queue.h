// A priority queue for priorities that only rise.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vkmesh {

/// Ids under non-negative floats, served in ascending order to 1/16 octave (6 %): one bucket for each value
/// of a float's exponent and the upper four bits of its mantissa (after R. K. Ahuja, K. Mehlhorn, J. B.
/// Orlin, R. E. Tarjan, "Faster algorithms for the shortest path problem", 1990). Nothing is found again or
/// changed: an id whose priority has risen is put in anew when it is served, if `is_due` says no. What is put
/// in under less than the bucket being served joins that bucket. Within a bucket the last comes first, so the
/// order depends on nothing but the calls. O(1) each. Memory: about 4 bytes an entry.
class MonotoneQueue {
 public:
  MonotoneQueue() = default;
  /// Room for this many entries is made at once, in full chunks and one more for each of a usual number of
  /// buckets.
  explicit MonotoneQueue(std::size_t capacity) { reserve(capacity); }

  /// Room for so many entries more.
  void reserve(std::size_t more) {
    words_.reserve(words_.size() + (more / (kChunk - 1) + kUsualBuckets) * kChunk);
  }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }

  /// The bucket of a priority, which must not be negative; -0 is 0.
  [[nodiscard]] static std::uint32_t bucket(float priority) {
    return (std::bit_cast<std::uint32_t>(priority) & 0x7fffffffu) >> kShift;
  }

  /// The bucket that is being served.
  [[nodiscard]] std::uint32_t floor() const { return floor_; }
  /// The highest priority that would be served now.
  [[nodiscard]] float level() const { return std::bit_cast<float>(((floor_ + 1) << kShift) - 1); }
  /// Whether an id of this priority would be served now.
  [[nodiscard]] bool is_due(float priority) const { return bucket(priority) <= floor_; }

  void insert(std::uint32_t id, float priority) { insert_in(std::max(bucket(priority), floor_), id); }
  /// Into the bucket that is being served.
  void insert_now(std::uint32_t id) { insert_in(floor_, id); }

  /// The lowest bucket that holds an id; kNone when empty.
  [[nodiscard]] std::uint32_t first() const {
    if (size_ == 0) return kNone;
    std::uint32_t word = floor_ / 64;
    std::uint64_t bits = occupied_[word] & (~std::uint64_t{0} << floor_ % 64);
    while (bits == 0) bits = occupied_[++word];
    return word * 64 + static_cast<std::uint32_t>(std::countr_zero(bits));
  }
  static constexpr std::uint32_t kNone = ~std::uint32_t{0}, kLast = kNone - 1;

  /// Moves up to out.size() ids of the lowest bucket to `out` and returns how many; 0 when empty, or when
  /// that bucket lies above `last`.
  std::size_t take(std::span<std::uint32_t> out, std::uint32_t last = kLast) {
    const std::uint32_t lowest = first();
    if (lowest > last) return 0;
    floor_ = lowest;

    std::size_t count = 0;
    std::uint32_t end = ends_[floor_];
    while (count < out.size() && end != 0) {
      const std::uint32_t chunk = (end - 1) / kChunk * kChunk;
      const std::size_t moved = std::min<std::size_t>(end - chunk - 1, out.size() - count);
      std::reverse_copy(words_.data() + end - moved, words_.data() + end, out.data() + count);
      end -= static_cast<std::uint32_t>(moved);
      count += moved;
      if (end != chunk + 1) continue;
      end = words_[chunk];
      words_[chunk] = free_;
      free_ = chunk;
    }
    ends_[floor_] = end;
    if (end == 0) occupied_[floor_ / 64] &= ~(std::uint64_t{1} << floor_ % 64);
    size_ -= count;
    return count;
  }

  /// Takes all that another queue holds, into the same buckets or that being served.
  void absorb(MonotoneQueue& other) {
    other.distribute([this](std::uint32_t) { return this; });
  }
  /// Gives all that it holds to the queues that to(id) points to, as absorb does; what has none is dropped.
  template <class To>
  void distribute(To&& to) {
    std::array<std::uint32_t, kChunk> ids;
    while (const std::size_t count = take(ids))
      for (std::size_t i = 0; i < count; ++i)
        if (MonotoneQueue* const queue = to(ids[i]); queue != nullptr)
          queue->insert_in(std::max(floor_, queue->floor_), ids[i]);
  }

 private:
  static constexpr unsigned kShift = 19;
  static constexpr std::size_t kBuckets = std::size_t{1} << (31 - kShift);
  /// Words of a chunk, of which the first tells where the ids of the bucket's chunk before it end.
  static constexpr std::uint32_t kChunk = 64;
  /// 64 octaves.
  static constexpr std::size_t kUsualBuckets = 1024;

  void insert_in(std::uint32_t b, std::uint32_t id) {
    std::uint32_t end = ends_[b];
    if (end % kChunk == 0) end = add_chunk(b);
    words_[end] = id;
    ends_[b] = end + 1;
    ++size_;
  }

  std::uint32_t add_chunk(std::uint32_t b) {
    std::uint32_t chunk = free_;
    if (chunk == 0) {
      chunk = static_cast<std::uint32_t>(words_.size());
      words_.resize(words_.size() + kChunk);
    } else {
      free_ = words_[chunk];
    }
    words_[chunk] = ends_[b];
    occupied_[b / 64] |= std::uint64_t{1} << b % 64;
    return chunk + 1;
  }

  std::vector<std::uint32_t> words_ = std::vector<std::uint32_t>(kChunk);  // the first chunk is none
  std::array<std::uint32_t, kBuckets> ends_{};  // of the last chunk's ids; 0 when the bucket is empty
  std::array<std::uint64_t, kBuckets / 64> occupied_{};
  std::uint32_t free_ = 0;  // a chunk; each leads to the next
  std::uint32_t floor_ = 0;
  std::size_t size_ = 0;
};

}  // namespace vkmesh
