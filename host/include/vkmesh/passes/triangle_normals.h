// The unit normal of every triangle.
#pragma once

#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// (p1 − p0) × (p2 − p0), scaled to length 1, for each face; the zero vector for a triangle without area
/// (docs/exactness.md says below which size). The reference of shaders/passes/triangle_normals.comp, equal to
/// it bit for bit. O(faces). Errors: as vertex_normals().
[[nodiscard]] VKMESH_API Result<std::vector<Vec3>> triangle_normals(const HalfEdgeMesh& mesh,
                                                                    std::span<const Vec3> positions);

/// The same into memory of the caller, one vector for each face: nothing is allocated, which is most of the
/// time of a pass over millions of faces whose result is new each time. Errors: also kUsage where the size of
/// `normals` differs; it is left as it was.
[[nodiscard]] VKMESH_API Result<void> triangle_normals(const HalfEdgeMesh& mesh,
                                                       std::span<const Vec3> positions,
                                                       std::span<Vec3> normals);

}  // namespace vkmesh
