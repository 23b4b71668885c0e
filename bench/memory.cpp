#include "bench/memory.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>

#if defined(__GLIBC__)
#include <malloc.h>
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

// What is kept right before each block. Blocks are aligned here: what aligned_alloc frees glibc does not use
// again for the next of that kind, whose pages would be new ones each time.
struct Kept {
  void* start;
  std::size_t size;
};

Kept* kept_before(void* block) {
  return static_cast<Kept*>(block) - 1;
}

void* allocate(std::size_t size, std::size_t alignment) {
  std::size_t room = size + sizeof(Kept) + alignment;
  void* const start = room < size ? nullptr : std::malloc(room);
  if (start == nullptr) throw std::bad_alloc();
  void* block = static_cast<std::byte*>(start) + sizeof(Kept);
  room -= sizeof(Kept);
  std::align(alignment, size, block, room);
  *kept_before(block) = {start, size};
  count(static_cast<std::ptrdiff_t>(size));
  return block;
}

void release(void* block) {
  if (block == nullptr) return;
  count(-static_cast<std::ptrdiff_t>(kept_before(block)->size));
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
