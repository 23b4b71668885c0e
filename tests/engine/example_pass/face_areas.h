// The area of every triangle.
#pragma once

#include <span>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// Half the length of (p1 − p0) × (p2 − p0), for each face. The reference of face_areas.comp, equal to it bit
/// for bit. O(faces). Errors: as check_positions(); kUsage unless one position for each vertex; kOutOfMemory.
[[nodiscard]] Result<std::vector<float>> face_areas(const HalfEdgeMesh& mesh,
                                                    std::span<const Vec3> positions);

}  // namespace vkmesh
