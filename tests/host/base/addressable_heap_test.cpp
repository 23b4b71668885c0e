#include "base/addressable_heap.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

namespace vkmesh {
namespace {

/// The same by a sorted set: slow and obvious.
class Reference {
 public:
  void set(std::uint32_t id, float priority) {
    remove(id);
    priorities_[id] = priority;
    order_.insert({priority, id});
  }
  void remove(std::uint32_t id) {
    const auto found = priorities_.find(id);
    if (found == priorities_.end()) return;
    order_.erase({found->second, id});
    priorities_.erase(found);
  }
  [[nodiscard]] bool contains(std::uint32_t id) const { return priorities_.contains(id); }
  [[nodiscard]] float priority(std::uint32_t id) const { return priorities_.at(id); }
  [[nodiscard]] const std::set<std::pair<float, std::uint32_t>>& order() const { return order_; }

 private:
  std::map<std::uint32_t, float> priorities_;
  std::set<std::pair<float, std::uint32_t>> order_;
};

}  // namespace

TEMPLATE_TEST_CASE("an addressable heap does as a sorted set under random operations", "[heap]",
                   AddressableHeap<2>, AddressableHeap<3>, AddressableHeap<8>) {
  constexpr std::uint32_t kIds = 97;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    TestType heap(kIds);
    Reference reference;
    // Few distinct priorities, of both signs, so that ties are common.
    const auto priority = [&] { return (static_cast<float>(random() % 25) - 12.0f) * 0.25f; };
    for (std::uint32_t id = 0; id < kIds; id += 2) {
      const float p = priority();
      heap.append(id, p);
      reference.set(id, p);
    }
    heap.heapify();
    for (int i = 0; i < 3000; ++i) {
      const auto id = static_cast<std::uint32_t>(random() % kIds);
      switch (random() % 4) {
        case 0:
        case 1: {
          const float p = priority();
          heap.set(id, p);
          reference.set(id, p);
          break;
        }
        case 2:
          heap.remove(id);
          reference.remove(id);
          break;
        default:
          if (!heap.empty()) {
            reference.remove(heap.top());
            heap.pop();
          }
      }
      REQUIRE(heap.size() == reference.order().size());
      REQUIRE(heap.contains(id) == reference.contains(id));
      if (heap.contains(id)) REQUIRE(heap.priority(id) == reference.priority(id));
      if (!heap.empty()) REQUIRE(std::pair(heap.top_priority(), heap.top()) == *reference.order().begin());
    }
    std::vector<std::pair<float, std::uint32_t>> drained;
    while (!heap.empty()) {
      drained.emplace_back(heap.top_priority(), heap.top());
      heap.pop();
    }
    CHECK(std::equal(drained.begin(), drained.end(), reference.order().begin(), reference.order().end()));
  }
}

TEST_CASE("an addressable heap orders every finite and infinite priority", "[heap]") {
  const std::vector<float> ascending = {
      -std::numeric_limits<float>::infinity(),  -std::numeric_limits<float>::max(),        -1.0f,
      -std::numeric_limits<float>::min(),       -std::numeric_limits<float>::denorm_min(), 0.0f,
      std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::min(),         1.0f,
      std::numeric_limits<float>::max(),        std::numeric_limits<float>::infinity()};
  AddressableHeap<> heap(ascending.size());
  for (std::size_t i = ascending.size(); i-- > 0;) heap.set(static_cast<std::uint32_t>(i), ascending[i]);
  for (std::size_t i = 0; i < ascending.size(); ++i) {
    CHECK(heap.top() == i);
    CHECK(heap.top_priority() == ascending[i]);
    heap.pop();
  }
}

TEST_CASE("equal priorities leave an addressable heap by id, and -0 equals 0", "[heap]") {
  AddressableHeap<> heap(40);
  for (std::uint32_t i = 0; i < 40; ++i) heap.set((i * 7) % 40, i % 2 == 0 ? 0.0f : -0.0f);
  for (std::uint32_t i = 0; i < 40; ++i) {
    CHECK(heap.top() == i);
    heap.pop();
  }
}

}  // namespace vkmesh
