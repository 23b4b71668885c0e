// Edge swaps: the triangles of a surface made better, its points left where they are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/length.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// What a swap is to lower. Lengths are in the diagonal of the bounding box over the
/// root of the number of faces, which is near the length of an edge, rounded down to a power of two. A
/// dihedral angle β is that between the normals of the two faces of an edge e, π at a face without area;
/// boundary edges have none. At a vertex, over its edges and corners, |H| = ¼ Σ |e||β|, K = 2π − Σ corner
/// angles (on the boundary π − Σ), and A is a third of its faces' area.
enum class SwapCost : std::uint8_t {
  /// The least angle of the worse of the two triangles (lecture, "Delaunay triangulations": max-min angle).
  /// In
  /// the plane what no swap can make better is Delaunay. As one term of several: Σ ¾ − sin² of the least
  /// angle.
  kMinAngle,
  /// The worse of the two triangles' qualities: 4√3 area over the sum of the squared sides, 1 for equilateral
  /// ones (R. P. Bhatia, K. L. Lawrence, 1990). As one term of several: Σ 1 − quality.
  kAspectRatio,
  /// The sum of the cotangents of all corners, which a swap lowers where the two angles across from the edge
  /// come to more than π: in the plane exactly where a circle is not empty (O. R. Musin, "Properties of the
  /// Delaunay triangulation", 1997). On curved surfaces, too, it falls with each swap.
  kDelaunay,
  /// Σ (valence − 6)² over the vertices, on the boundary (valence − 4)².
  kValence,
  // N. Dyn, K. Hormann, S. J. Kim, D. Levin, "Optimizing 3D triangulations using discrete curvature
  // analysis",
  // 2001.
  kMeanCurvature,         ///< Σ |H|.
  kSquaredMeanCurvature,  ///< Σ H² / A.
  kAbsoluteCurvature,     ///< Σ |κ₁| + |κ₂|: 2|H| where K ≥ 0, else 2 √(H² − A K).
  /// Σ |β|, the angle between normals (N. Dyn, D. Levin, S. Rippa, "Data dependent triangulations for
  /// piecewise
  /// linear interpolation", 1990).
  kDihedralAngle,
  /// Σ area (1 − cosine) of the angle between the normal of a face and that given at each of its corners, a
  /// third each: SwapEdgesOptions::normals.
  kNormalDeviation
};

inline constexpr std::size_t kSwapCosts = 9;

struct WeightedSwapCost {
  SwapCost cost = SwapCost::kMinAngle;
  double weight = 1;  ///< Above 0.
};

/// The first condition that a swap fails, in the order in which they are judged.
enum class SwapReason : std::uint8_t {
  kNone,            ///< Nothing forbids it.
  kBoundary,        ///< The edge has one face.
  kLocked,          ///< SwapEdgesOptions::locked_edges names it.
  kCrease,          ///< It was bent by SwapEdgesOptions::crease_angle or more at first.
  kSeam,            ///< Corners of SwapEdgesOptions::corner_groups differ on its two sides.
  kMaterialBorder,  ///< Its faces are of different SwapEdgesOptions::face_groups.
  kOutsideRegion,   ///< One of its faces is not in SwapEdgesOptions::region.
  kEdgeExists,      ///< The two vertices across from it are joined already: the graph would not stay simple.
  kNotConvex,       ///< Seen along the mean normal of its faces, they form no strictly convex quadrilateral.
  kFoldOver,        ///< A new face would turn by 90 degrees or more from one of those that it replaces.
  kDihedralChange,  ///< SwapEdgesOptions::max_dihedral_change forbids it.
  kDeviation        ///< SwapEdgesOptions::max_deviation forbids it.
};

inline constexpr std::size_t kSwapReasons = 12;

/// "boundary", "locked", "crease", "seam", "material border", "outside the region", "the edge exists", "not
/// convex", "fold-over", "dihedral change", "deviation".
[[nodiscard]] VKMESH_API std::string name_of(SwapReason reason);

struct SwapEdgesOptions {
  /// One, or the sum of several. Default max-min angle.
  std::vector<WeightedSwapCost> costs = {{}};
  /// Edges bent by at least this stay. Radians, in (0, π]. Default none.
  std::optional<double> crease_angle;
  /// Bounds the difference between the dihedral angles of the edge that goes and of the one that comes.
  /// Radians, in (0, π]. Default none.
  std::optional<double> max_dihedral_change;
  /// Bounds the distance between the two diagonals, by which a swap moves the surface. Default none.
  std::optional<Length> max_deviation;
  /// Half-edges, either of the two, 3f + i from corner i of face f to the next, whose edges stay.
  std::vector<std::uint32_t> locked_edges;
  /// One number for each corner: edges stay on whose two sides they differ at one of the ends (UV seams, for
  /// example). Default none.
  std::span<const std::uint32_t> corner_groups;
  /// One number for each face: edges between different ones stay (materials, for example). Default none.
  std::span<const std::uint32_t> face_groups;
  /// One flag for each face: only edges between two that are set may swap. Default all.
  std::span<const std::uint8_t> region;
  /// One for each vertex, of any length, for SwapCost::kNormalDeviation.
  std::span<const Vec3> normals;
  std::optional<std::size_t> max_swaps;  ///< Default none.
  std::optional<double> seconds;         ///< Default none.
};

enum class SwapStop : std::uint8_t {
  kNoGain,     ///< No legal swap lowers the cost.
  kMaxSwaps,   ///< SwapEdgesOptions::max_swaps are done.
  kTimeLimit,  ///< SwapEdgesOptions::seconds have passed.
};

/// "no gain", "number of swaps", "time limit".
[[nodiscard]] VKMESH_API std::string name_of(SwapStop stop);

struct SwappedEdges {
  HalfEdgeMesh mesh;
  /// For each corner of `mesh` one of the input at the same vertex, on the same side of seams.
  std::vector<std::uint32_t> source_corner;
  std::size_t swaps = 0;
  SwapStop stop = SwapStop::kNoGain;
  /// The sum of all terms, each rounded to 2^-24.
  double cost_before = 0, cost_after = 0;
  /// What forbids swaps that would still lower the cost: by SwapReason, their numbers.
  std::array<std::size_t, kSwapReasons> blocked{};
};

/// Swaps the edge that lowers the cost most, again and again, until no legal swap lowers it. Each term of the
/// cost, that of a face, edge or vertex, is a whole number of 2^-24, and so the cost falls with each swap
/// and this ends. With kMinAngle or kAspectRatio alone a swap makes the worse of the two triangles better,
/// by a whole number of 2^-32: the sorted list of them rises.
///
/// Vertices keep their numbers, faces that are not touched keep theirs and their first corner. Gains that
/// differ by less than 6e-8 of their size go by the number of the edge, so that the same input gives the same
/// bytes everywhere. Threads: as many as the caller's TBB arena has, for what comes before the first swap.
/// O(n + s log n) for s swaps. Memory: about 200 bytes a vertex, about 350 for costs of curvature.
///
/// Errors: kUnsuitable unless triangles, of coordinates below kMaxCoordinate; kUsage for options outside
/// their range; kInterrupted; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<SwappedEdges> swap_edges(const HalfEdgeMesh& mesh,
                                                         std::span<const Vec3> positions,
                                                         const SwapEdgesOptions& options = {},
                                                         const Progress& progress = {});

}  // namespace vkmesh
