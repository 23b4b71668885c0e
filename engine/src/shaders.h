// The engine's own kernels: shaders/*.comp, compiled and embedded by the build.
#pragma once

#include <span>

#include <vkmesh/engine/kernel.h>

#include "params.h"

namespace vkmesh::detail {

/// Every embedded kernel.
[[nodiscard]] std::span<const KernelSource> embedded_kernels();

[[nodiscard]] const KernelSource& bounds_blocks_kernel();
[[nodiscard]] const KernelSource& canary_kernel();
[[nodiscard]] const KernelSource& cotangent_smoothing_kernel();
[[nodiscard]] const KernelSource& curvatures_kernel();
[[nodiscard]] const KernelSource& dihedral_angles_kernel();
[[nodiscard]] const KernelSource& face_measures_kernel();
[[nodiscard]] const KernelSource& laplacian_smoothing_kernel();
[[nodiscard]] const KernelSource& sum_blocks_kernel();
[[nodiscard]] const KernelSource& triangle_areas_kernel();
[[nodiscard]] const KernelSource& triangle_normals_kernel();
[[nodiscard]] const KernelSource& vertex_maxima_kernel();
[[nodiscard]] const KernelSource& vertex_normals_kernel();
[[nodiscard]] const KernelSource& vertex_normals_by_angle_kernel();

}  // namespace vkmesh::detail
