#include "math/circumcentre.h"

#include <array>
#include <utility>

#include "math/whole_points.h"

namespace vkmesh::detail {
namespace {

using Pair = std::pair<int, int>;

/// The circumcentre less a is (x, y) / area, where a is the first corner and area twice that of the
/// parallelogram.
struct Fractions {
  WholeNumber x, y, area;
};

/// From the vectors b - a and c - a.
Fractions circumcentre_of(const WholeNumber& bx, const WholeNumber& by, const WholeNumber& cx,
                          const WholeNumber& cy) {
  const WholeNumber b2 = bx * bx + by * by, c2 = cx * cx + cy * cy, area = bx * cy - by * cx;
  return {cy * b2 - by * c2, bx * c2 - cx * b2, area + area};
}

/// The difference of the squared distances from k to p and to q, of the vectors q - p, k - p and k - q.
WholeNumber difference(const WholeNumber* pq, const WholeNumber* pk, const WholeNumber* qk) {
  return pq[0] * (pk[0] + qk[0]) + pq[1] * (pk[1] + qk[1]);
}

}  // namespace

int exact_circumcentre_side(DVec2 a, DVec2 b, DVec2 c, DVec2 k, DVec2 l) {
  const WholePoints<5> points({a, b, c, k, l});
  constexpr std::array<Pair, 4> kPairs = {{{0, 1}, {0, 2}, {3, 0}, {3, 4}}};  // ab, ac, ka, kl
  const auto v = points.vectors(kPairs);
  const Fractions centre = circumcentre_of(v[0], v[1], v[2], v[3]);
  const WholeNumber x = v[4] * centre.area + centre.x, y = v[5] * centre.area + centre.y;
  return (v[6] * y - v[7] * x).sign() * centre.area.sign();
}

DVec2 exact_circumcentre(DVec2 a, DVec2 b, DVec2 c) {
  const WholePoints<4> points({a, b, c, DVec2(0, 0)});
  constexpr std::array<Pair, 3> kPairs = {{{0, 1}, {0, 2}, {3, 0}}};  // ab, ac, a
  const auto v = points.vectors(kPairs);
  const Fractions centre = circumcentre_of(v[0], v[1], v[2], v[3]);
  return {WholeNumber::quotient(v[4] * centre.area + centre.x, centre.area, points.unit()),
          WholeNumber::quotient(v[5] * centre.area + centre.y, centre.area, points.unit())};
}

int exact_bisector_side(DVec2 p, DVec2 q, DVec2 k) {
  const WholePoints<3> points({p, q, k});
  constexpr std::array<Pair, 3> kPairs = {{{0, 1}, {0, 2}, {1, 2}}};  // pq, pk, qk
  const auto v = points.vectors(kPairs);
  return difference(v.data(), v.data() + 2, v.data() + 4).sign();
}

double exact_bisector_crossing(DVec2 p, DVec2 q, DVec2 k, DVec2 l) {
  const WholePoints<4> points({p, q, k, l});
  constexpr std::array<Pair, 5> kPairs = {{{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}}};  // pq, pk, qk, pl, ql
  const auto v = points.vectors(kPairs);
  const WholeNumber at_k = difference(v.data(), v.data() + 2, v.data() + 4),
                    at_l = difference(v.data(), v.data() + 6, v.data() + 8);
  return WholeNumber::quotient(at_k, at_k - at_l, 0);
}

int sign_of_product(DVec2 p, DVec2 q, DVec2 k, DVec2 l) {
  const WholePoints<4> points({p, q, k, l});
  constexpr std::array<Pair, 2> kPairs = {{{0, 1}, {2, 3}}};
  const auto v = points.vectors(kPairs);
  return (v[0] * v[2] + v[1] * v[3]).sign();
}

}  // namespace vkmesh::detail
