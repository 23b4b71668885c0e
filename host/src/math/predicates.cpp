#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <vkmesh/math/predicates.h>

#include "math/filtered_predicates.h"
#include "math/whole_points.h"

namespace vkmesh {
namespace detail {
namespace {

using Int128 = __int128;

int sign_of(Int128 x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// x y against z w: -1, 0 or 1. All below 2^127 in size.
int compare_products(Int128 x, Int128 y, Int128 z, Int128 w) {
  using Unsigned = unsigned __int128;
  const int left = sign_of(x) * sign_of(y), right = sign_of(z) * sign_of(w);
  if (left != right) return left < right ? -1 : 1;
  if (left == 0) return 0;
  const auto size = [](Int128 v) {
    return v < 0 ? Unsigned{0} - static_cast<Unsigned>(v) : static_cast<Unsigned>(v);
  };
  // The product in two words of 128 bits.
  const auto product = [](Unsigned a, Unsigned b) {
    constexpr Unsigned kLow = ~std::uint64_t{0};
    const Unsigned a0 = a & kLow, a1 = a >> 64, b0 = b & kLow, b1 = b >> 64;
    const Unsigned low = a0 * b0, one = a1 * b0, two = a0 * b1;
    const Unsigned middle = (low >> 64) + (one & kLow) + (two & kLow);
    return std::pair(a1 * b1 + (one >> 64) + (two >> 64) + (middle >> 64), middle << 64 | (low & kLow));
  };
  const auto a = product(size(x), size(y)), b = product(size(z), size(w));
  return a == b ? 0 : (a < b) == (left > 0) ? -1 : 1;
}

}  // namespace

int exact_orientation(DVec2 a, DVec2 b, DVec2 c) {
  const WholePoints<3> points({a, b, c});
  constexpr std::array<std::pair<int, int>, 2> kPairs = {{{2, 0}, {2, 1}}};
  std::array<std::int64_t, 4> v;
  if (points.small_vectors(kPairs, v)) return sign_of(Int128{v[0]} * v[3] - Int128{v[1]} * v[2]);
  const auto w = points.vectors(kPairs);
  return (w[0] * w[3] - w[1] * w[2]).sign();
}

int exact_in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  const WholePoints<4> points({a, b, c, d});
  constexpr std::array<std::pair<int, int>, 4> kPairs = {{{0, 1}, {0, 2}, {3, 1}, {3, 2}}};  // ab, ac, db, dc
  std::array<std::int64_t, 8> v;
  if (points.small_vectors(kPairs, v)) {
    const auto product = [&](std::size_t i, std::size_t j) { return Int128{v[i]} * v[j]; };
    return compare_products(product(0, 3) - product(1, 2), -product(6, 4) - product(7, 5),
                            product(0, 2) + product(1, 3), product(6, 5) - product(7, 4));
  }
  const auto w = points.vectors(kPairs);
  return ((w[1] * w[2] - w[0] * w[3]) * (w[6] * w[4] + w[7] * w[5]) -
          (w[0] * w[2] + w[1] * w[3]) * (w[6] * w[5] - w[7] * w[4]))
      .sign();
}

int perturbed_cocircular(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  // in_circle() is the sign of a determinant that is linear in how high each point is lifted. The greatest
  // point counts whose factor is not 0: for a that is the area of d, b, c.
  const std::array<DVec2, 4> points = {a, b, c, d};
  std::array<std::uint8_t, 4> order = {0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](std::uint8_t i, std::uint8_t j) {
    const DVec2 p = points[i], q = points[j];
    return p.x != q.x ? p.x > q.x : p.y > q.y;
  });
  for (const std::uint8_t i : order) {
    const int factor = i == 0   ? orientation(d, b, c)
                       : i == 1 ? orientation(d, c, a)
                       : i == 2 ? orientation(d, a, b)
                                : -orientation(a, b, c);
    if (factor != 0) return factor;
  }
  return 0;
}

DVec2 crossing_of(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  // The mean of c and d by the areas beyond, of d and of c, over the line through a and b.
  const WholePoints<5> points({a, b, c, d, DVec2(0, 0)});
  const auto w = points.vectors<5>({{{0, 1}, {0, 2}, {0, 3}, {4, 2}, {4, 3}}});  // ab, ac, ad, c, d
  const WholeNumber beyond_c = w[0] * w[3] - w[1] * w[2], beyond_d = w[0] * w[5] - w[1] * w[4];
  const WholeNumber all = beyond_c - beyond_d;
  const auto mean = [&](const WholeNumber& of_c, const WholeNumber& of_d) {
    return WholeNumber::quotient(beyond_c * of_d - beyond_d * of_c, all, points.unit());
  };
  const auto within = [](double x, double p, double q, double r, double s) {
    return std::clamp(x, std::max(std::min(p, q), std::min(r, s)), std::min(std::max(p, q), std::max(r, s)));
  };
  return {within(mean(w[6], w[8]), a.x, b.x, c.x, d.x), within(mean(w[7], w[9]), a.y, b.y, c.y, d.y)};
}

}  // namespace detail

int orientation(DVec2 a, DVec2 b, DVec2 c) {
  const bool in_range =
      detail::in_filter_range(a) && detail::in_filter_range(b) && detail::in_filter_range(c);
  return detail::FilteredPredicates(in_range).orientation(a, b, c);
}

int in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  const bool in_range = detail::in_filter_range(a) && detail::in_filter_range(b) &&
                        detail::in_filter_range(c) && detail::in_filter_range(d);
  return detail::FilteredPredicates(in_range).in_circle(a, b, c, d);
}

int in_circle_perturbed(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  const int side = in_circle(a, b, c, d);
  return side != 0 ? side : detail::perturbed_cocircular(a, b, c, d);
}

}  // namespace vkmesh
