// Points of doubles in whole numbers, for exact predicates and constructions.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <vkmesh/math/predicates.h>

#include "math/whole_number.h"

namespace vkmesh::detail {

/// x as `mantissa` times 2^`exponent`, the mantissa odd, or both 0.
struct Binary {
  std::int64_t mantissa = 0;
  int exponent = 0;

  Binary() = default;
  explicit Binary(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const int field = static_cast<int>(bits >> 52 & 0x7ff);
    std::uint64_t m = bits & 0xfffffffffffff;
    if (field != 0) m |= std::uint64_t{1} << 52;
    if (m == 0) return;
    const int zeros = std::countr_zero(m);
    mantissa = static_cast<std::int64_t>(m >> zeros);
    if (bits >> 63) mantissa = -mantissa;
    exponent = (field != 0 ? field : 1) - 1075 + zeros;
  }
};

/// N points in units of the last bit that any coordinate has.
template <std::size_t N>
class WholePoints {
 public:
  explicit WholePoints(const std::array<DVec2, N>& points) {
    int least = 2000;
    for (std::size_t i = 0; i < N; ++i) {
      at_[2 * i] = Binary(points[i].x);
      at_[2 * i + 1] = Binary(points[i].y);
    }
    for (const Binary& x : at_)
      if (x.mantissa != 0) least = std::min(least, x.exponent);
    unit_ = least;
    for (Binary& x : at_) {
      x.exponent = x.mantissa == 0 ? 0 : x.exponent - least;
      small_ = small_ && x.exponent <= 72;
    }
  }

  /// The power of two that a unit is.
  [[nodiscard]] int unit() const { return unit_; }

  /// The vectors between pairs of points, where they fit: the product of four of their coordinates is less
  /// than 2^250.
  template <std::size_t M>
  [[nodiscard]] bool small_vectors(const std::array<std::pair<int, int>, M>& pairs,
                                   std::array<std::int64_t, 2 * M>& vectors) const {
    if (!small_) return false;
    using Int128 = __int128;
    constexpr Int128 kMost = Int128{1} << 62;
    for (std::size_t i = 0; i < 2 * M; ++i) {
      const auto [from, to] = ends(pairs, i);
      const Int128 difference = static_cast<Int128>(to.mantissa) * (Int128{1} << to.exponent) -
                                static_cast<Int128>(from.mantissa) * (Int128{1} << from.exponent);
      if (difference > kMost || difference < -kMost) return false;
      vectors[i] = static_cast<std::int64_t>(difference);
    }
    return true;
  }
  /// The same as large as they are.
  template <std::size_t M>
  [[nodiscard]] std::array<WholeNumber, 2 * M> vectors(
      const std::array<std::pair<int, int>, M>& pairs) const {
    std::array<WholeNumber, 2 * M> vectors;
    for (std::size_t i = 0; i < 2 * M; ++i) {
      const auto [from, to] = ends(pairs, i);
      vectors[i] = WholeNumber(to.mantissa, to.exponent) - WholeNumber(from.mantissa, from.exponent);
    }
    return vectors;
  }

 private:
  template <std::size_t M>
  [[nodiscard]] std::pair<Binary, Binary> ends(const std::array<std::pair<int, int>, M>& pairs,
                                               std::size_t i) const {
    const auto [from, to] = pairs[i / 2];
    return {at_[2 * static_cast<std::size_t>(from) + i % 2], at_[2 * static_cast<std::size_t>(to) + i % 2]};
  }

  std::array<Binary, 2 * N> at_;
  int unit_ = 0;
  bool small_ = true;
};

}  // namespace vkmesh::detail
