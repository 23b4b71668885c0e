#include "bench/memory.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <mutex>
#include <new>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace vkmesh::bench {
namespace {

std::atomic<std::ptrdiff_t> held = 0, most = 0;

constexpr std::size_t kDefault = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

void count(std::ptrdiff_t bytes) {
  const std::ptrdiff_t now = held.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  std::ptrdiff_t seen = most.load(std::memory_order_relaxed);
  while (now > seen && !most.compare_exchange_weak(seen, now, std::memory_order_relaxed)) {
  }
}

// What is kept right before each block.
struct Kept {
  void* start;  // nullptr of a large block
  std::size_t size;
};

Kept* kept_before(void* block) {
  return static_cast<Kept*>(block) - 1;
}

#if defined(__linux__)
// Large blocks are kept by size, in large pages or small ones as their first user has asked: each contestant
// finds its own again. From malloc they would get what another has left in small pages, or new ones, which
// takes long.
class LargeBlocks {
 public:
  static constexpr std::size_t kLeast = std::size_t{1} << 20, kPage = std::size_t{1} << 21;

  void* take(std::size_t size, std::size_t alignment) {
    const std::size_t room = room_for(size);
    {
      const std::lock_guard lock(mutex_);
      for (std::size_t i = 0; i < count_; ++i)
        if (room_for(kept_before(free_[i])->size) == room && address_of(free_[i]) % alignment == 0) {
          void* const block = free_[i];
          free_[i] = free_[--count_];
          return block;
        }
    }
    void* const start =
        mmap(nullptr, room + 2 * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED) return nullptr;
    // Behind what is kept; and unless they must, no two begin alike, or what is read side by side would have
    // one place in the caches.
    const std::size_t apart =
        alignment < kPage ? made_++ % 31 * (kPage / 32 + kLine) / alignment * alignment : 0;
    void* const block = static_cast<std::byte*>(start) + (kPage - address_of(start) % kPage) + apart;
    *kept_before(block) = {nullptr, size};
    return block;
  }
  void give_back(void* block) {
    const std::lock_guard lock(mutex_);
    if (count_ < free_.size()) free_[count_++] = block;
  }

 private:
  static constexpr std::size_t kLine = 64;
  static std::size_t room_for(std::size_t size) { return (size + kPage - 1) / kPage * kPage; }
  static std::uintptr_t address_of(const void* block) { return reinterpret_cast<std::uintptr_t>(block); }

  std::mutex mutex_;
  std::array<void*, 1024> free_{};
  std::size_t count_ = 0;
  std::atomic<std::size_t> made_ = 0;
};
LargeBlocks large_blocks;
#endif

void* allocate(std::size_t size, std::size_t alignment) {
  void* block = nullptr;
#if defined(__linux__)
  if (size >= LargeBlocks::kLeast && alignment <= LargeBlocks::kPage) {
    block = large_blocks.take(size, alignment);
    if (block == nullptr) throw std::bad_alloc();
    kept_before(block)->size = size;
    count(static_cast<std::ptrdiff_t>(size));
    return block;
  }
#endif
  std::size_t room = size + sizeof(Kept) + alignment;
  void* const start = room < size ? nullptr : std::malloc(room);
  if (start == nullptr) throw std::bad_alloc();
  block = static_cast<std::byte*>(start) + sizeof(Kept);
  room -= sizeof(Kept);
  std::align(alignment, size, block, room);
  *kept_before(block) = {start, size};
  count(static_cast<std::ptrdiff_t>(size));
  return block;
}

void release(void* block) {
  if (block == nullptr) return;
  count(-static_cast<std::ptrdiff_t>(kept_before(block)->size));
#if defined(__linux__)
  if (kept_before(block)->start == nullptr) return large_blocks.give_back(block);
#endif
  std::free(kept_before(block)->start);
}

std::size_t at_least_default(std::align_val_t alignment) {
  return std::max(static_cast<std::size_t>(alignment), kDefault);
}

}  // namespace

MemoryWatch::MemoryWatch() : before_(held) {
  most = before_;
}

std::size_t MemoryWatch::peak() const {
  return static_cast<std::size_t>(most - before_);
}

void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kMost = std::numeric_limits<int>::max();
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, kMost);
#endif
}

}  // namespace vkmesh::bench

// The others, of arrays and without exceptions, end in these.
void* operator new(std::size_t size) {
  return vkmesh::bench::allocate(size, vkmesh::bench::kDefault);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return vkmesh::bench::allocate(size, vkmesh::bench::at_least_default(alignment));
}
void operator delete(void* block) noexcept {
  vkmesh::bench::release(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
  vkmesh::bench::release(block);
}
void operator delete(void* block, std::size_t) noexcept {
  operator delete(block);
}
void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
  operator delete(block);
}
