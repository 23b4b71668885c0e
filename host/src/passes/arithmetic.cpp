#include <string>

#include <vkmesh/passes/arithmetic.h>

namespace vkmesh {

Result<void> prepare_positions(std::span<const Vec3> positions, std::span<Vec3> prepared) {
  if (positions.size() != prepared.size())
    return fail(ErrorCode::kUsage, "as many prepared positions as positions are needed");
  bool inside = true;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = positions[i];
    // Written so that a NaN fails it.
    inside &=
        std::fabs(p.x) < kMaxCoordinate && std::fabs(p.y) < kMaxCoordinate && std::fabs(p.z) < kMaxCoordinate;
    prepared[i] = zero_below(p, VKMESH_TINY_COORDINATE);
  }
  if (inside) return {};
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::fabs(positions[i][k]) < kMaxCoordinate))
        return fail(ErrorCode::kUnsuitable, "coordinate " + std::to_string(k) + " of vertex " +
                                                std::to_string(i) +
                                                " is not finite, or not below 2^60 in magnitude");
  return fail(ErrorCode::kInternal, "a coordinate was outside its range and then was not");
}

}  // namespace vkmesh
