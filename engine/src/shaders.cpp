#include "shaders.h"

#include <cstdint>

namespace vkmesh::detail {
namespace {

using std::uint32_t;
#include "shaders/canary.spv.h"
#include "shaders/dihedral_angles.spv.h"
#include "shaders/laplacian_smoothing.spv.h"
#include "shaders/triangle_areas.spv.h"
#include "shaders/triangle_normals.spv.h"
#include "shaders/vertex_maxima.spv.h"
#include "shaders/vertex_normals.spv.h"

enum Index {
  kCanary,
  kDihedralAngles,
  kLaplacianSmoothing,
  kTriangleAreas,
  kTriangleNormals,
  kVertexMaxima,
  kVertexNormals
};

}  // namespace

std::span<const KernelSource> embedded_kernels() {
  static const KernelSource kKernels[] = {
      {"canary", k_canary_spirv, sizeof(kernels::CanaryParams)},
      {"dihedral_angles", k_dihedral_angles_spirv, sizeof(kernels::DihedralAnglesParams)},
      {"laplacian_smoothing", k_laplacian_smoothing_spirv, sizeof(kernels::LaplacianSmoothingParams)},
      {"triangle_areas", k_triangle_areas_spirv, sizeof(kernels::TrianglesParams)},
      {"triangle_normals", k_triangle_normals_spirv, sizeof(kernels::TrianglesParams)},
      {"vertex_maxima", k_vertex_maxima_spirv, sizeof(kernels::VertexMaximaParams)},
      {"vertex_normals", k_vertex_normals_spirv, sizeof(kernels::VertexNormalsParams)},
  };
  return kKernels;
}

const KernelSource& canary_kernel() {
  return embedded_kernels()[kCanary];
}
const KernelSource& dihedral_angles_kernel() {
  return embedded_kernels()[kDihedralAngles];
}
const KernelSource& laplacian_smoothing_kernel() {
  return embedded_kernels()[kLaplacianSmoothing];
}
const KernelSource& triangle_areas_kernel() {
  return embedded_kernels()[kTriangleAreas];
}
const KernelSource& triangle_normals_kernel() {
  return embedded_kernels()[kTriangleNormals];
}
const KernelSource& vertex_maxima_kernel() {
  return embedded_kernels()[kVertexMaxima];
}
const KernelSource& vertex_normals_kernel() {
  return embedded_kernels()[kVertexNormals];
}

}  // namespace vkmesh::detail
