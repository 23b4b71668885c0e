#include "core/shaders.h"

#include <cstdint>

namespace vkmesh::detail {
namespace {

using std::uint32_t;
#include "shaders/bilateral_faces.spv.h"
#include "shaders/bilateral_mollify.spv.h"
#include "shaders/bilateral_move.spv.h"
#include "shaders/bilateral_normals.spv.h"
#include "shaders/bounds_blocks.spv.h"
#include "shaders/canary.spv.h"
#include "shaders/collapse_costs.spv.h"
#include "shaders/cotangent_smoothing.spv.h"
#include "shaders/curvatures.spv.h"
#include "shaders/dihedral_angles.spv.h"
#include "shaders/face_measures.spv.h"
#include "shaders/laplacian_smoothing.spv.h"
#include "shaders/quadrics.spv.h"
#include "shaders/restore_volume.spv.h"
#include "shaders/sum_blocks.spv.h"
#include "shaders/swap_scores.spv.h"
#include "shaders/triangle_areas.spv.h"
#include "shaders/triangle_normals.spv.h"
#include "shaders/vertex_maxima.spv.h"
#include "shaders/vertex_normals.spv.h"
#include "shaders/vertex_normals_by_angle.spv.h"

enum Index {
#define VKMESH_INDEX(name, Params) k_##name,
  VKMESH_EMBEDDED_KERNELS(VKMESH_INDEX)
#undef VKMESH_INDEX
};

}  // namespace

std::span<const KernelSource> embedded_kernels() {
  static const KernelSource kKernels[] = {
#define VKMESH_SOURCE(name, Params) {#name, k_##name##_spirv, sizeof(kernels::Params)},
      VKMESH_EMBEDDED_KERNELS(VKMESH_SOURCE)
#undef VKMESH_SOURCE
  };
  return kKernels;
}

#define VKMESH_DEFINE(name, Params)      \
  const KernelSource& name##_kernel() {  \
    return embedded_kernels()[k_##name]; \
  }
VKMESH_EMBEDDED_KERNELS(VKMESH_DEFINE)
#undef VKMESH_DEFINE

}  // namespace vkmesh::detail
