// The inner loops that pay in vector registers, over contiguous elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <vkmesh/vec.h>

namespace vkmesh::detail {

/// v ← unit_vector(v).
void to_unit_vectors(std::span<Vec3> vectors);

/// out[i] = angle_between(a[i], b[i]).
void angles_between(std::span<const Vec3> a, std::span<const Vec3> b, std::span<float> out);

/// The largest magnitude among the coordinates, as its bits: those of a NaN or an infinity exceed every
/// other.
[[nodiscard]] std::uint32_t largest_magnitude(std::span<const Vec3> vectors);

}  // namespace vkmesh::detail
