// How much memory is allocated: the program's operators new and delete count.
#pragma once

#include <cstddef>

namespace vkmesh::bench {

/// The most bytes that are allocated at once from its making on, beyond what was then. What is counted is
/// what is asked for: the same on every machine. One at a time.
class MemoryWatch {
 public:
  MemoryWatch();
  [[nodiscard]] std::size_t peak() const;

 private:
  std::ptrdiff_t before_;
};

/// From now on, what is freed stays with the process, as in one that does the same all day: what a system
/// takes to hand memory out again, here up to 2 ms a megabyte, would be most of the time of some rows, and in
/// no two runs the same.
void keep_freed_memory();

}  // namespace vkmesh::bench
