#include "passes/blocks.h"

#include <algorithm>

#include <vkmesh/passes/arithmetic.h>

#include "passes/clones.h"

namespace vkmesh::detail {

VKMESH_CLONES void to_unit_vectors(std::span<Vec3> vectors) {
  // Through a copy that cannot alias, or the compiler gives up on vector registers.
  constexpr std::size_t kBlock = 128;
  Vec3 in[kBlock], out[kBlock];
  for (std::size_t first = 0; first < vectors.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, vectors.size() - first);
    std::copy_n(vectors.begin() + static_cast<std::ptrdiff_t>(first), count, in);
    for (std::size_t i = 0; i < count; ++i) out[i] = unit_vector(in[i]);
    std::copy_n(out, count, vectors.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

VKMESH_CLONES void dihedral_angles(std::span<const Vec3> left, std::span<const Vec3> right,
                                   std::span<const Vec3> along, std::span<float> out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = dihedral_angle(left[i], right[i], along[i]);
}

VKMESH_CLONES std::uint32_t largest_magnitude(std::span<const Vec3> vectors) {
  std::uint32_t largest = 0;
  for (const Vec3& v : vectors)
    for (int k = 0; k < 3; ++k) largest = std::max(largest, bits(v[k]) & 0x7fffffffu);
  return largest;
}

}  // namespace vkmesh::detail
