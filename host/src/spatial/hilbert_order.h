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

#include "base/parallel.h"

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
  static constexpr std::size_t kGrain = 1 << 14;

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
    parallel_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
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
    });
    for (unsigned shift = 32; shift < 32 + 8 * levels; shift += 8) {
      sort_by_digit(keys, shift, sorted);
      std::swap(keys, sorted);
    }
    // Such a cell is smaller than the bounds; one that holds all is that only by rounding.
    if (keys.front() >> 32 == keys.back() >> 32) return std::sort(order.begin(), order.end(), by_place);
    parallel_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t last) {
      for (std::size_t k = begin; k < last; ++k) order[k] = static_cast<std::uint32_t>(keys[k]);
    });
    // A range sorts the cells that begin in it.
    parallel_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t last) {
      const auto begins = [&](std::size_t k) { return k == 0 || keys[k] >> 32 != keys[k - 1] >> 32; };
      while (begin < last && !begins(begin)) ++begin;
      while (begin < last) {
        std::size_t end = begin + 1;
        while (end < order.size() && !begins(end)) ++end;
        if (end - begin > 1) sort(order.subspan(begin, end - begin));
        begin = end;
      }
    });
  }

  /// Stable, by 8 bits of the keys.
  static void sort_by_digit(const std::vector<std::uint64_t>& keys, unsigned shift,
                            std::vector<std::uint64_t>& sorted) {
    const std::size_t parts = std::clamp<std::size_t>(
        keys.size() / kGrain, 1, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
    std::vector<std::array<std::uint32_t, 256>> offset(parts);
    const auto for_each_in_part = [&](auto&& use) {
      parallel_ranges(parts, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t part = first; part < last; ++part)
          for (std::size_t k = keys.size() * part / parts; k < keys.size() * (part + 1) / parts; ++k)
            use(offset[part][keys[k] >> shift & 255u], keys[k]);
      });
    };
    for_each_in_part([](std::uint32_t& count, std::uint64_t) { ++count; });
    std::uint32_t sum = 0;
    for (std::size_t digit = 0; digit < 256; ++digit)
      for (auto& of_part : offset) sum += std::exchange(of_part[digit], sum);
    for_each_in_part([&](std::uint32_t& at, std::uint64_t key) { sorted[at++] = key; });
  }

  std::span<const DVec2> points_;
};

}  // namespace vkmesh::detail
