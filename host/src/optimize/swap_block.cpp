#include "optimize/swap_block.h"

#include <algorithm>

#include "optimize/triangle_costs.h"
#include "simd/target_clones.h"

namespace vkmesh::detail {
namespace {

using Lanes = std::array<double, SwapBlock::kSize>;
using Coordinates = std::array<Lanes, 12>;

[[gnu::always_inline]] inline double squared(const Coordinates& of, std::size_t p, std::size_t q,
                                             std::size_t i) {
  const double x = of[3 * q][i] - of[3 * p][i], y = of[3 * q + 1][i] - of[3 * p + 1][i],
               z = of[3 * q + 2][i] - of[3 * p + 2][i];
  return x * x + y * y + z * z;
}

template <class Score>
[[gnu::always_inline]] inline void gains(const Coordinates& of, std::size_t count, Lanes& out,
                                         Score&& score) {
  constexpr std::size_t kP = 0, kQ = 1, kA = 2, kB = 3;
  for (std::size_t i = 0; i < count; ++i) {
    const double pq = squared(of, kP, kQ, i), ab = squared(of, kA, kB, i), qa = squared(of, kQ, kA, i),
                 ap = squared(of, kA, kP, i), pb = squared(of, kP, kB, i), bq = squared(of, kB, kQ, i);
    const double now = std::min(score(pq, qa, ap), score(pq, pb, bq));
    const double then = std::min(score(ab, ap, pb), score(ab, bq, qa));
    out[i] = then - now;
  }
}

VKMESH_FLAT_CLONES void gains_by_angle(const Coordinates& of, std::size_t count, Lanes& out) {
  gains(of, count, out, [](double x, double y, double z) { return SquaredSides(x, y, z).least_sine2(); });
}
VKMESH_FLAT_CLONES void gains_by_quality(const Coordinates& of, std::size_t count, Lanes& out) {
  gains(of, count, out, [](double x, double y, double z) { return SquaredSides(x, y, z).quality(); });
}

}  // namespace

void SwapBlock::compute(SwapCost cost) {
  (cost == SwapCost::kMinAngle ? gains_by_angle : gains_by_quality)(coordinates_, count_, gains_);
}

}  // namespace vkmesh::detail
