// The engine's own kernels: shaders/*.comp, compiled and embedded by the build.
#pragma once

#include <span>

#include <vkmesh/engine/core/kernel.h>

#include "passes/params.h"

// Every kernel and its push constants: KERNEL(name, Params). (engine/CMakeLists.txt names the sources.)
// clang-format off
#define VKMESH_EMBEDDED_KERNELS(KERNEL) \
  KERNEL(bilateral_faces, BilateralFacesParams) \
  KERNEL(bilateral_mollify, BilateralSumParams) \
  KERNEL(bilateral_move, BilateralSumParams) \
  KERNEL(bilateral_normals, BilateralNormalsParams) \
  KERNEL(bounds_blocks, BoundsBlocksParams) \
  KERNEL(canary, CanaryParams) \
  KERNEL(collapse_costs, CollapseCostsParams) \
  KERNEL(cotangent_smoothing, LaplacianSmoothingParams) \
  KERNEL(curvatures, CurvaturesParams) \
  KERNEL(dihedral_angles, DihedralAnglesParams) \
  KERNEL(face_measures, FaceMeasuresParams) \
  KERNEL(laplacian_smoothing, LaplacianSmoothingParams) \
  KERNEL(quadrics, QuadricsParams) \
  KERNEL(restore_volume, RestoreVolumeParams) \
  KERNEL(sum_blocks, SumBlocksParams) \
  KERNEL(swap_scores, SwapScoresParams) \
  KERNEL(triangle_areas, TrianglesParams) \
  KERNEL(triangle_normals, TrianglesParams) \
  KERNEL(vertex_maxima, VertexMaximaParams) \
  KERNEL(vertex_normals, VertexNormalsParams) \
  KERNEL(vertex_normals_by_angle, VertexNormalsByAngleParams)
// clang-format on

namespace vkmesh::detail {

/// Every embedded kernel.
[[nodiscard]] std::span<const KernelSource> embedded_kernels();

// NAME_kernel() for each.
#define VKMESH_DECLARE(name, Params) [[nodiscard]] const KernelSource& name##_kernel();
VKMESH_EMBEDDED_KERNELS(VKMESH_DECLARE)
#undef VKMESH_DECLARE

}  // namespace vkmesh::detail
