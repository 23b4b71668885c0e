#include <algorithm>
#include <string>

#include <vkmesh/math/arithmetic.h>

#include "base/parallel.h"
#include "math/vector_kernels.h"

#if defined(__FAST_MATH__) || !defined(__cpp_exceptions)
#error "vkmesh's sources need exact arithmetic and exceptions, as cmake/VkmeshTarget.cmake asks for them"
#endif

namespace vkmesh {
namespace {

constexpr std::size_t kGrain = 1 << 14;

struct Largest {
  std::uint32_t magnitude = 0;

  Largest& operator+=(const Largest& other) {
    magnitude = std::max(magnitude, other.magnitude);
    return *this;
  }
};

}  // namespace

Result<void> check_positions(std::span<const Vec3> positions) {
  const auto largest =
      detail::parallel_sum<Largest>(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        return Largest{detail::largest_magnitude(positions.subspan(begin, end - begin))};
      });
  if (largest.magnitude < detail::bits(kMaxCoordinate)) return {};
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::fabs(positions[i][k]) < kMaxCoordinate))
        return fail(ErrorCode::kUnsuitable, "coordinate " + std::to_string(k) + " of vertex " +
                                                std::to_string(i) +
                                                " is not finite, or not below 2^60 in magnitude");
  return fail(ErrorCode::kInternal, "a coordinate was outside its range and then was not");
}

Result<void> prepare_positions(std::span<const Vec3> positions, std::span<Vec3> prepared) {
  if (positions.size() != prepared.size())
    return fail(ErrorCode::kUsage, "as many prepared positions as positions are needed");
  VKMESH_CHECK(check_positions(positions));
  detail::parallel_ranges(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) prepared[i] = zero_below(positions[i], VKMESH_TINY_COORDINATE);
  });
  return {};
}

}  // namespace vkmesh
