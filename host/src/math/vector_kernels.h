// The inner loops that pay in vector registers, over contiguous elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// out[f] = area_vector() of the positions of corners 3f, 3f + 1, 3f + 2.
void area_vectors(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                  std::span<Vec3> out);

/// out[3f + i] = the angle of that triangle at its corner i, as corner_angle() tells it.
void corner_angles(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                   std::span<float> out);

/// v ← unit_vector(v).
void to_unit_vectors(std::span<Vec3> vectors);

/// out[i] = dihedral_angle(left[i], right[i], along[i]).
void dihedral_angles(std::span<const Vec3> left, std::span<const Vec3> right, std::span<const Vec3> along,
                     std::span<float> out);

/// The largest magnitude among the coordinates, as its bits: those of a NaN or an infinity exceed every
/// other.
[[nodiscard]] std::uint32_t largest_magnitude(std::span<const Vec3> vectors);

}  // namespace vkmesh::detail
