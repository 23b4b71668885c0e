// The quadric of every vertex and the cost of collapsing every edge, by the arithmetic that is the same on
// every device. Decimation computes its own, in the host's (math/quadric.h).
#pragma once

#include <array>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// Where an edge collapse puts the point that remains.
enum class CollapsePlacement : std::uint32_t {
  kOptimal,   ///< Where the quadric error is least.
  kMidpoint,  ///< In the middle of the edge.
  kEndpoint   ///< At the end where the error is less: a half-edge collapse.
};

struct CollapseCostOptions {
  /// Positions are taken as (position − centre) · scale, which should bring them into [−2, 2]: the middle of
  /// the bounding box, and a power of two. See unit_frame().
  Vec3 centre{0.0f};
  float scale = 1.0f;
  /// The weight of planes that stand on boundary edges, perpendicular to their face, relative to a plane of
  /// the same area. In [0, 2^20]. Default 10.
  float boundary_weight = 10.0f;
  CollapsePlacement placement = CollapsePlacement::kOptimal;  ///< Default optimal.
};

/// Centre and scale for the given positions. O(n).
[[nodiscard]] VKMESH_API CollapseCostOptions unit_frame(std::span<const Vec3> positions);

/// Σ w n nᵀ over the planes through the vertex, as xx, xy, xz, yy, yz, zz: with the vertex as origin nothing
/// else of a quadric is left. In scaled units of length².
using VertexQuadric = std::array<float, 6>;

/// M. Garland and P. Heckbert, "Surface simplification using quadric error metrics", 1997: a plane for each
/// triangle, weighted by its area, summed in ascending order of faces. Entries below 2^-60 are 0. The
/// reference of shaders/passes/vertex_quadrics.comp, equal to it bit for bit. O(faces). Errors: as
/// vertex_normals(), and kUsage for options out of range.
[[nodiscard]] VKMESH_API Result<std::vector<VertexQuadric>> vertex_quadrics(
    const HalfEdgeMesh& mesh, std::span<const Vec3> positions, const CollapseCostOptions& options = {});

/// For each half-edge the quadric error of collapsing its edge, the same for twins: area times squared
/// distance in scaled units, at least 0; the largest float where that has no value. The reference of
/// shaders/passes/collapse_costs.comp, equal to it bit for bit. O(half-edges). Errors: as vertex_quadrics(),
/// and kUsage unless one quadric for each vertex.
[[nodiscard]] VKMESH_API Result<std::vector<float>> collapse_costs(const HalfEdgeMesh& mesh,
                                                                   std::span<const Vec3> positions,
                                                                   std::span<const VertexQuadric> quadrics,
                                                                   const CollapseCostOptions& options = {});

}  // namespace vkmesh
