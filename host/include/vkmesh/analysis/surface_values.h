// Numbers to see a surface by: edges, curvature, quality, components. For any face set, manifold or not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/handles.h>
#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh {

/// An unordered pair of points that some face joins.
struct SurfaceEdge {
  std::uint32_t a = 0, b = 0;  ///< a < b.
  std::uint32_t faces = 0;  ///< How many run along it: 1 on the boundary, 3 or more where it is non-manifold.
  /// The first two faces, in ascending order; the second is kInvalid on the boundary.
  std::uint32_t first_face = kInvalid, second_face = kInvalid;
  bool opposed = false;  ///< Two faces, which run along it in opposite directions, as on an oriented surface.
};

// Each of these is O(n) but for the small sorts at each point. Errors: kUsage for corners that name no point;
// kOutOfMemory.

/// All edges in ascending order of (a, b). Sides of faces from a point to itself are no edges.
[[nodiscard]] VKMESH_API Result<std::vector<SurfaceEdge>> surface_edges(const IndexedFaceSet& mesh);

/// For each edge the angle between the normals of its two faces, radians: positive where the surface is
/// convex there, as seen from outside, negative where it is concave, 0 unless the edge is `opposed`. Normals
/// of polygons are Newell's.
[[nodiscard]] VKMESH_API Result<std::vector<float>> signed_dihedral_angles(
    const IndexedFaceSet& mesh, std::span<const SurfaceEdge> edges);

/// For each point the mean curvature, 1 / length: positive on a sphere seen from outside. The integral of
/// mean curvature along an edge is half its length times its signed angle (D. Cohen-Steiner, J.-M. Morvan,
/// "Restricted Delaunay triangulations and normal cycle", 2003); each end takes half of it, and divides by a
/// third of the area of the faces around it. NaN for a point without area around it.
[[nodiscard]] VKMESH_API Result<std::vector<float>> mean_curvatures(const IndexedFaceSet& mesh,
                                                                    std::span<const SurfaceEdge> edges,
                                                                    std::span<const float> signed_angles);

/// For each point the largest magnitude of the angles of its edges; 0 without any.
[[nodiscard]] VKMESH_API Result<std::vector<float>> largest_angles(const IndexedFaceSet& mesh,
                                                                   std::span<const SurfaceEdge> edges,
                                                                   std::span<const float> signed_angles);

/// For each point the number of its edges.
[[nodiscard]] VKMESH_API Result<std::vector<float>> valences(const IndexedFaceSet& mesh,
                                                             std::span<const SurfaceEdge> edges);

struct ConnectedComponents {
  std::vector<float> of_point;     ///< Number of the component; NaN for a point of no face.
  std::vector<std::size_t> faces;  ///< The number of faces of each component, descending.
};
/// The vertex-connected components: faces that share a point are of one. Components are numbered by faces,
/// the largest 0; equal ones in order of their first point.
[[nodiscard]] VKMESH_API Result<ConnectedComponents> connected_components(const IndexedFaceSet& mesh);

/// For each triangle 4√3 area / (sum of squared sides): 1 if equilateral, 0 without area. Errors: kUnsuitable
/// for polygons.
[[nodiscard]] VKMESH_API Result<std::vector<float>> triangle_qualities(const IndexedFaceSet& mesh);

/// For each point the area-weighted mean of the normals of the triangles around it, as vertex_normals() gives
/// for a manifold, bit for bit. Errors: kUnsuitable for polygons, and for coordinates out of its range.
[[nodiscard]] VKMESH_API Result<std::vector<Vec3>> point_normals(const IndexedFaceSet& mesh);

/// For each point its distance to the neighbour that is `neighbours` away in order of distance; where as many
/// points coincide, the median of all others. 0 for a single point. A tree of halved boxes (J. L. Bentley,
/// "Multidimensional binary search trees", 1975): O(n log n). Positions must be finite.
[[nodiscard]] VKMESH_API Result<std::vector<float>> point_spacing(std::span<const Vec3> points,
                                                                  unsigned neighbours = 6);

}  // namespace vkmesh
