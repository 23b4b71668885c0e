#include "shaders.h"

#include <cstdint>

namespace vkmesh::detail {
namespace {

using std::uint32_t;
#include "shaders/bounds_blocks.spv.h"
#include "shaders/canary.spv.h"
#include "shaders/cotangent_smoothing.spv.h"
#include "shaders/curvatures.spv.h"
#include "shaders/dihedral_angles.spv.h"
#include "shaders/face_measures.spv.h"
#include "shaders/laplacian_smoothing.spv.h"
#include "shaders/sum_blocks.spv.h"
#include "shaders/triangle_areas.spv.h"
#include "shaders/triangle_normals.spv.h"
#include "shaders/vertex_maxima.spv.h"
#include "shaders/vertex_normals.spv.h"
#include "shaders/vertex_normals_by_angle.spv.h"

enum Index {
  kBoundsBlocks,
  kCanary,
  kCotangentSmoothing,
  kCurvatures,
  kDihedralAngles,
  kFaceMeasures,
  kLaplacianSmoothing,
  kSumBlocks,
  kTriangleAreas,
  kTriangleNormals,
  kVertexMaxima,
  kVertexNormals,
  kVertexNormalsByAngle
};

}  // namespace

std::span<const KernelSource> embedded_kernels() {
  static const KernelSource kKernels[] = {
      {"bounds_blocks", k_bounds_blocks_spirv, sizeof(kernels::BoundsBlocksParams)},
      {"canary", k_canary_spirv, sizeof(kernels::CanaryParams)},
      {"cotangent_smoothing", k_cotangent_smoothing_spirv, sizeof(kernels::LaplacianSmoothingParams)},
      {"curvatures", k_curvatures_spirv, sizeof(kernels::CurvaturesParams)},
      {"dihedral_angles", k_dihedral_angles_spirv, sizeof(kernels::DihedralAnglesParams)},
      {"face_measures", k_face_measures_spirv, sizeof(kernels::FaceMeasuresParams)},
      {"laplacian_smoothing", k_laplacian_smoothing_spirv, sizeof(kernels::LaplacianSmoothingParams)},
      {"sum_blocks", k_sum_blocks_spirv, sizeof(kernels::SumBlocksParams)},
      {"triangle_areas", k_triangle_areas_spirv, sizeof(kernels::TrianglesParams)},
      {"triangle_normals", k_triangle_normals_spirv, sizeof(kernels::TrianglesParams)},
      {"vertex_maxima", k_vertex_maxima_spirv, sizeof(kernels::VertexMaximaParams)},
      {"vertex_normals", k_vertex_normals_spirv, sizeof(kernels::VertexNormalsParams)},
      {"vertex_normals_by_angle", k_vertex_normals_by_angle_spirv,
       sizeof(kernels::VertexNormalsByAngleParams)},
  };
  return kKernels;
}

const KernelSource& bounds_blocks_kernel() {
  return embedded_kernels()[kBoundsBlocks];
}
const KernelSource& canary_kernel() {
  return embedded_kernels()[kCanary];
}
const KernelSource& cotangent_smoothing_kernel() {
  return embedded_kernels()[kCotangentSmoothing];
}
const KernelSource& curvatures_kernel() {
  return embedded_kernels()[kCurvatures];
}
const KernelSource& dihedral_angles_kernel() {
  return embedded_kernels()[kDihedralAngles];
}
const KernelSource& face_measures_kernel() {
  return embedded_kernels()[kFaceMeasures];
}
const KernelSource& laplacian_smoothing_kernel() {
  return embedded_kernels()[kLaplacianSmoothing];
}
const KernelSource& sum_blocks_kernel() {
  return embedded_kernels()[kSumBlocks];
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
const KernelSource& vertex_normals_by_angle_kernel() {
  return embedded_kernels()[kVertexNormalsByAngle];
}

}  // namespace vkmesh::detail
