// Mean and Gaussian curvature of a triangle mesh at its vertices.
#pragma once

#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/node_neighbours.h>

namespace vkmesh {

struct VertexCurvature {
  /// 1 / length; positive on a sphere seen from outside: 1/r. 0 on the boundary.
  float mean = 0.0f;
  /// 1 / length²; positive on a sphere: 1/r². 0 on the boundary.
  float gaussian = 0.0f;
  /// 2π less the angles of the triangles around the vertex, and on the boundary π less these: the integral of
  /// Gaussian curvature over `area`, or of the turning of the boundary. Over a whole mesh they add up to 2π
  /// times its Euler characteristic (Gauss and Bonnet).
  float angle_defect = 0.0f;
  /// The mixed Voronoi area. Over a whole mesh they add up to its area.
  float area = 0.0f;
};

/// M. Meyer, M. Desbrun, P. Schröder, A. H. Barr, "Discrete differential-geometry operators for triangulated
/// 2-manifolds", 2003: K = defect / A and H = |Σ (cot α + cot β)(v − n)| / 4A over the neighbours n, with the
/// sign of that vector along the normal; A is made of the Voronoi regions of triangles without obtuse angle,
/// and of a half or a quarter of the others. What a vertex without area has (an isolated one, or one of
/// degenerate triangles only) is 0. Cotangents are held within ±2^10 and curvatures within ±2^100, so that
/// slivers make large values and never a NaN. Takes the neighbours of a triangle mesh. The reference of
/// shaders/passes/curvatures.comp, equal to it bit for bit. O(edges). Errors: kUsage for a wrong number of
/// positions; kUnsuitable as check_positions(); kOutOfMemory.
[[nodiscard]] VKMESH_API Result<std::vector<VertexCurvature>> curvatures(const NodeNeighbours& neighbours,
                                                                         std::span<const Vec3> positions);

}  // namespace vkmesh
