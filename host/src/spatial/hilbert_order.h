// An order of points in the plane in which neighbours stand near each other.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/math/predicates.h>

namespace vkmesh::detail {

/// The numbers of points along D. Hilbert's curve through a grid over their bounds, those of one cell along
/// one through a finer grid over theirs, and few of one cell from left to right. A function of the points:
/// only equal ones go by their numbers, and stand side by side. Coordinates must be finite. O(n log n).
class HilbertOrder {
 public:
  static std::vector<std::uint32_t> of(std::span<const DVec2> points) {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    HilbertOrder(points).sort(order);
    return order;
  }

 private:
  static constexpr std::size_t kFew = 24;
  static constexpr unsigned kLevelsAtOnce = 4;

  explicit HilbertOrder(std::span<const DVec2> points) : points_(points) {}

  /// For each orientation of the curve and the next 4 bits of x and y: 8 bits of the place on the curve, and
  /// above them the orientation that follows.
  struct Steps {
    std::array<std::uint16_t, 4 * 256> of{};

    constexpr Steps() {
      for (unsigned state = 0; state < 4; ++state)
        for (unsigned x = 0; x < 16; ++x)
          for (unsigned y = 0; y < 16; ++y) {
            // Bit 0 of the orientation: x and y change places; bit 1: both run backwards.
            unsigned now = state, key = 0;
            for (unsigned bit = kLevelsAtOnce; bit-- > 0;) {
              unsigned bx = x >> bit & 1u, by = y >> bit & 1u;
              if ((now & 2u) != 0) {
                bx ^= 1u;
                by ^= 1u;
              }
              if ((now & 1u) != 0) std::swap(bx, by);
              const unsigned quarter = (3 * bx) ^ by;
              key = key << 2 | quarter;
              if (quarter == 0) now ^= 1u;
              if (quarter == 3) now ^= 3u;
            }
            of[state << 8 | x << 4 | y] = static_cast<std::uint16_t>(now << 8 | key);
          }
    }
  };

  [[nodiscard]] bool is_before(std::uint32_t i, std::uint32_t j) const {
    const DVec2 p = points_[i], q = points_[j];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : i < j;
  }

  void sort(std::span<std::uint32_t> order) const {
    const auto by_place = [this](std::uint32_t i, std::uint32_t j) { return is_before(i, j); };
    if (order.size() <= kFew) return std::sort(order.begin(), order.end(), by_place);
    DVec2 low = points_[order[0]], high = low;
    for (const std::uint32_t i : order) {
      low = {std::min(low.x, points_[i].x), std::min(low.y, points_[i].y)};
      high = {std::max(high.x, points_[i].x), std::max(high.y, points_[i].y)};
    }
    // Some cells a point. Halves, since the difference of two large coordinates need not be finite.
    const unsigned levels = std::min(
        4u, (static_cast<unsigned>(std::bit_width(order.size())) / 2 + 1 + kLevelsAtOnce) / kLevelsAtOnce);
    const double cells = std::ldexp(1.0, static_cast<int>(kLevelsAtOnce * levels));
    const double extent = std::max(high.x / 2 - low.x / 2, high.y / 2 - low.y / 2),
                 scale = cells / extent / 2;
    if (!(std::isfinite(scale) && scale > 0)) return std::sort(order.begin(), order.end(), by_place);
    static constexpr Steps kSteps;
    std::vector<std::uint64_t> keys(order.size()), sorted(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      const DVec2 p = points_[order[k]];
      const auto cell = [&](double x, double least) {
        return static_cast<std::uint32_t>(std::min((x / 2 - least / 2) * scale * 2, cells - 1));
      };
      const std::uint32_t x = cell(p.x, low.x), y = cell(p.y, low.y);
      std::uint32_t key = 0, state = 0;
      for (unsigned level = levels; level-- > 0;) {
        const unsigned shift = kLevelsAtOnce * level;
        const std::uint32_t step = kSteps.of[state << 8 | (x >> shift & 15u) << 4 | (y >> shift & 15u)];
        key = key << 8 | (step & 255u);
        state = step >> 8;
      }
      keys[k] = static_cast<std::uint64_t>(key) << 32 | order[k];
    }
    for (unsigned shift = 32; shift < 32 + 8 * levels; shift += 8) {
      std::array<std::uint32_t, 256> offset{};
      for (const std::uint64_t key : keys) ++offset[key >> shift & 255u];
      std::exclusive_scan(offset.begin(), offset.end(), offset.begin(), 0u);
      for (const std::uint64_t key : keys) sorted[offset[key >> shift & 255u]++] = key;
      std::swap(keys, sorted);
    }
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::uint32_t>(keys[k]);
    for (std::size_t k = 0; k < order.size();) {
      std::size_t end = k + 1;
      while (end < order.size() && keys[end] >> 32 == keys[k] >> 32) ++end;
      // Such a cell is smaller than the bounds; one that holds all is that only by rounding.
      if (end - k == order.size()) return std::sort(order.begin(), order.end(), by_place);
      if (end - k > 1) sort(order.subspan(k, end - k));
      k = end;
    }
  }

  std::span<const DVec2> points_;
};

}  // namespace vkmesh::detail
