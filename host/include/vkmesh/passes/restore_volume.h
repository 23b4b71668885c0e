// Giving a surface back the volume that smoothing took.
#pragma once

#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// `after`, scaled about the centroid of its surface so that it encloses the volume that `before` did
/// (M. Desbrun, M. Meyer, P. Schröder, A. H. Barr, "Implicit fairing of irregular meshes using diffusion and
/// curvature flow", 1999, §4.2). Every vertex moves, locked ones included. As it was where one of the
/// volumes is 0, where they differ in sign, or by more than a factor 2^30. The reference of
/// shaders/passes/restore_volume.comp, equal to it bit for bit. O(faces). Errors: kUnsuitable unless closed
/// triangles, and as check_positions(); kUsage unless one position for each vertex; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<std::vector<Vec3>> restore_volume(const HalfEdgeMesh& mesh,
                                                                  std::span<const Vec3> before,
                                                                  std::span<const Vec3> after);

}  // namespace vkmesh
