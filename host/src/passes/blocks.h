// The inner loops that pay in vector registers, over contiguous elements.
#pragma once

#include <cstddef>
#include <span>

#include <vkmesh/vec.h>

namespace vkmesh::detail {

/// v ← unit_vector(v).
void to_unit_vectors(std::span<Vec3> vectors);

/// out[i] = angle_between(a[i], b[i]).
void angles_between(std::span<const Vec3> a, std::span<const Vec3> b, std::span<float> out);

}  // namespace vkmesh::detail
