// Area, volume, centroid and bounds of a triangle mesh.
#pragma once

#include <array>
#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

struct SurfaceMeasures {
  double area = 0.0;
  /// Enclosed volume, positive where the faces look outward; of an open mesh, that between it and the centre
  /// of its bounds.
  double volume = 0.0;
  DVec3 centroid{0.0};         ///< The surface's, by area; the centre of the bounds where there is none.
  Vec3 low{0.0f}, high{0.0f};  ///< The bounds of all positions; both 0 where there are none.
};

/// Sums over faces in 32 bits, by a tree: blocks of 64 in ascending order, then blocks of 64 of these, and so
/// on, in coordinates relative to the centre of the bounds and scaled by a power of two. The reference of
/// shaders/passes/bounds_blocks.comp, face_measures.comp and sum_blocks.comp, equal to them bit for bit.
/// O(faces). Errors: kUnsuitable unless triangles; kUsage unless one position for each vertex; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<SurfaceMeasures> surface_measures(const HalfEdgeMesh& mesh,
                                                                  std::span<const Vec3> positions);

/// What the sums of the pass are, for both paths: low, high, and in the scaled coordinates twice the area,
/// its moment (three), and six volumes.
using RawMeasures = std::array<float, 11>;

/// In double precision. O(1).
[[nodiscard]] VKMESH_API SurfaceMeasures to_surface_measures(const RawMeasures& raw);

}  // namespace vkmesh
