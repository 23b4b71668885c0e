// The inner loops that pay in vector registers, over contiguous elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <vkmesh/vec.h>

namespace vkmesh::detail {

/// v ← unit_vector(v).
void to_unit_vectors(std::span<Vec3> vectors);

/// out[i] = dihedral_angle(left[i], right[i], along[i]).
void dihedral_angles(std::span<const Vec3> left, std::span<const Vec3> right, std::span<const Vec3> along,
                     std::span<float> out);

/// The largest magnitude among the coordinates, as its bits: those of a NaN or an infinity exceed every
/// other.
[[nodiscard]] std::uint32_t largest_magnitude(std::span<const Vec3> vectors);

}  // namespace vkmesh::detail
