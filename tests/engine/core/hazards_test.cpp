#include "core/hazards.h"

#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

namespace vkmesh::test {
namespace {

std::size_t comparisons = 0;

struct CountingEqual {
  bool operator()(std::uint64_t a, std::uint64_t b) const {
    ++comparisons;
    return a == b;
  }
};

struct Work {
  std::vector<std::uint64_t> reads, writes;
};

/// Records the work as a recorder does. Returns whether each piece needs a barrier before it.
template <class Hazards>
std::vector<bool> barriers_of(const std::vector<Work>& work) {
  Hazards hazards;
  std::vector<bool> barriers;
  for (const Work& w : work) {
    bool hinders = false;
    for (const std::uint64_t key : w.reads) hinders = hinders || hazards.hinder_read(key);
    for (const std::uint64_t key : w.writes) hinders = hinders || hazards.hinder_write(key);
    if (hinders) hazards.pass_barrier();
    for (const std::uint64_t key : w.reads) hazards.note_read(key);
    for (const std::uint64_t key : w.writes) hazards.note_write(key);
    barriers.push_back(hinders);
  }
  return barriers;
}

/// The rule by its words: a barrier where a piece of work touches what one since the last barrier wrote, or
/// writes what one read.
std::vector<bool> barriers_by_definition(const std::vector<Work>& work) {
  std::set<std::uint64_t> read, written;
  std::vector<bool> barriers;
  for (const Work& w : work) {
    bool hinders = false;
    for (const std::uint64_t key : w.reads) hinders = hinders || written.contains(key);
    for (const std::uint64_t key : w.writes) hinders = hinders || written.contains(key) || read.contains(key);
    if (hinders) {
      read.clear();
      written.clear();
    }
    read.insert(w.reads.begin(), w.reads.end());
    written.insert(w.writes.begin(), w.writes.end());
    barriers.push_back(hinders);
  }
  return barriers;
}

}  // namespace

TEST_CASE("barriers go where their definition says, over random work", "[no-device]") {
  std::mt19937 engine(7);
  const auto below = [&](std::uint32_t count) { return static_cast<std::uint32_t>(engine() % count); };
  for (const std::uint32_t resources : {1u, 3u, 10u, 100u}) {
    std::vector<Work> work(3000);
    for (Work& w : work) {
      for (std::uint32_t i = below(4); i > 0; --i) w.reads.push_back(below(resources));
      for (std::uint32_t i = below(3); i > 0; --i) w.writes.push_back(below(resources));
    }
    CHECK(barriers_of<detail::Hazards<std::uint64_t>>(work) == barriers_by_definition(work));
  }
}

TEST_CASE("the cost of a barrier's place does not grow with the number of buffers", "[no-device]") {
  using Counting = detail::Hazards<std::uint64_t, CountingEqual>;
  // Meshes whose passes do not meet: no barrier empties the notes.
  for (const std::uint64_t meshes : {100u, 1000u, 30000u}) {
    std::vector<Work> work;
    for (std::uint64_t m = 0; m < meshes; ++m)
      work.push_back({{4096 * m, 4096 * m + 256, 4096 * m + 512}, {4096 * m + 768}});
    comparisons = 0;
    const std::vector<bool> barriers = barriers_of<Counting>(work);
    CHECK(std::set<bool>(barriers.begin(), barriers.end()) == std::set<bool>{false});
    // Two look-ups for each of four buffers.
    INFO(meshes << " meshes");
    CHECK(comparisons <= 4 * 2 * 4 * meshes);
  }
}

}  // namespace vkmesh::test
