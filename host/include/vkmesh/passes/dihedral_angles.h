// Dihedral angle of every edge, and the largest around each vertex: discrete measures of curvature.
#pragma once

#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

struct DihedralAngles {
  /// For each half-edge the angle between the normals of the two faces at its edge, radians in [−π, π]: 0
  /// where they lie in one plane, positive where the surface is convex as seen from outside, negative where
  /// it is concave. Twins hold the same value; 0 on the boundary and beside a triangle of no area.
  std::vector<float> half_edge;
  /// For each vertex the largest magnitude of its edges; 0 for an isolated vertex.
  std::vector<float> vertex_maximum;
};

/// The angle between neighbouring triangle normals (lecture, "Curvature, features"), by 2 atan2(|a − b|, |a +
/// b|) of the unit normals a, b (W. Kahan, "How futile are mindless assessments of roundoff", 2006, §12),
/// accurate for flat and sharp edges alike; the sign is that of (a × b) · edge. The reference of
/// shaders/passes/dihedral_angles_*.comp, equal to it bit for bit. O(half-edges). Errors: as
/// vertex_normals().
[[nodiscard]] VKMESH_API Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh,
                                                                std::span<const Vec3> positions);

}  // namespace vkmesh
