// Random numbers that are the same with every standard library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <vkmesh/math/vec.h>

namespace vkmesh::test {

class RandomPoints {
 public:
  explicit RandomPoints(std::uint64_t seed) : random_(seed) {}
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::size_t below(std::size_t n) { return random_() % n; }
  double whole(std::size_t n) { return static_cast<double>(below(n)); }
  DVec2 whole_point(std::size_t n) {
    const double x = whole(n);
    return {x, whole(n)};
  }
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace vkmesh::test
