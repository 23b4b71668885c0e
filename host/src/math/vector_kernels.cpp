#include "math/vector_kernels.h"

#include <algorithm>
#include <array>

#include <vkmesh/math/arithmetic.h>

#include "simd/target_clones.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kBlock = 128;
using Points = std::array<Vec3, kBlock>;

// The first, the second and the third corners of some triangles.
struct Triangles {
  std::array<Points, 3> corner;

  void gather(std::span<const Vec3> positions, std::span<const std::uint32_t> corners) {
    for (std::size_t f = 0; 3 * f < corners.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) corner[i][f] = positions[corners[3 * f + i]];
  }
};

// Only what follows a gather is compiled for wide vectors: gathering instructions are slower than loads.
VKMESH_CLONES void area_vectors(const Points& p0, const Points& p1, const Points& p2, std::size_t count,
                                Points& out) {
  for (std::size_t f = 0; f < count; ++f) out[f] = area_vector(p0[f], p1[f], p2[f]);
}

VKMESH_CLONES void corner_angles(const Points& p0, const Points& p1, const Points& p2, std::size_t count,
                                 std::array<float, kBlock>& out) {
  for (std::size_t f = 0; f < count; ++f)
    out[f] =
        corner_angle(corner_product(p0[f], p1[f], p2[f]), vector_length(area_vector(p0[f], p1[f], p2[f])));
}

}  // namespace

void area_vectors(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                  std::span<Vec3> out) {
  Triangles triangles;
  Points areas;
  for (std::size_t first = 0; first < out.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, out.size() - first);
    triangles.gather(positions, corners.subspan(3 * first, 3 * count));
    area_vectors(triangles.corner[0], triangles.corner[1], triangles.corner[2], count, areas);
    std::copy_n(areas.begin(), count, out.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

void corner_angles(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                   std::span<float> out) {
  Triangles triangles;
  std::array<float, kBlock> angles;
  for (std::size_t first = 0; 3 * first < out.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, out.size() / 3 - first);
    triangles.gather(positions, corners.subspan(3 * first, 3 * count));
    const auto& p = triangles.corner;
    for (std::size_t i = 0; i < 3; ++i) {
      corner_angles(p[i], p[(i + 1) % 3], p[(i + 2) % 3], count, angles);
      for (std::size_t f = 0; f < count; ++f) out[3 * (first + f) + i] = angles[f];
    }
  }
}

VKMESH_CLONES void to_unit_vectors(std::span<Vec3> vectors) {
  // Through a copy that cannot alias, or the compiler gives up on vector registers.
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
