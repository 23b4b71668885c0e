// What swapping every edge would gain: the first fill of the queue of edge swapping.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

enum class SwapCriterion : std::uint32_t {
  /// The least of the six angles, radians (lecture, "Delaunay triangulations": max-min angle). In the plane a
  /// mesh without gains is Delaunay.
  kMinAngle,
  /// The worse of the two triangles' qualities: 4√3 area over the sum of the squared sides, 1 for equilateral
  /// ones (R. P. Bhatia, K. L. Lawrence, "Two-dimensional finite element mesh generation based on stripwise
  /// automatic triangulation", 1990).
  kAspectRatio,
};

/// The score of an edge that cannot be swapped.
inline constexpr float kNoSwap = -4.0f;

/// For each half-edge what its edge's swap gains, the same for twins: the criterion after less before.
/// kNoSwap on the boundary, and where a new triangle would face away from the two that it replaces (in the
/// plane: where the quadrilateral is not convex). Whether the new edge exists already is not looked at. The
/// reference of shaders/passes/swap_scores.comp, equal to it bit for bit. O(half-edges). Errors: as
/// vertex_normals().
[[nodiscard]] VKMESH_API Result<std::vector<float>> swap_scores(
    const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
    SwapCriterion criterion = SwapCriterion::kMinAngle);

}  // namespace vkmesh
