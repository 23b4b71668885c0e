// Triangulations of a surface by edges that run within it: geodesics, known by their lengths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// The surface of a triangle mesh, triangulated by its vertices and straight paths on it. Flips change the
/// paths, not the surface: an edge goes, and the other diagonal of its two triangles, unfolded into the
/// plane, comes. Two vertices may have several edges then, and a vertex one to itself.
///
/// Signposts (N. Sharp, Y. Soliman, K. Crane, "Navigating intrinsic triangulations", 2019): each half-edge
/// knows in which direction it leaves its vertex, as the angle counter-clockwise from the vertex' leading
/// half-edge in the mesh it was made from; on the surface, where all angles at a vertex may come to other
/// than 2π. Half-edge 3f + i starts at corner i of triangle f, as in HalfEdgeMesh.
class VKMESH_API IntrinsicTriangulation {
 public:
  /// The edges of the mesh. Where a triangle is flat to within `slack`, the same length is added to all
  /// edges, so that none is (N. Sharp, K. Crane, "A Laplacian for nonmanifold triangle meshes", 2020, §4.5).
  /// `slack`: of the mean edge length. O(n). Errors: kUnsuitable unless triangles and positions are finite;
  /// kUsage unless one position for each vertex and slack in [0, 1]; kOutOfMemory.
  [[nodiscard]] static Result<IntrinsicTriangulation> create(const HalfEdgeMesh& mesh,
                                                             std::span<const Vec3> positions,
                                                             double slack = 1e-6);

  struct Flips {
    std::size_t flips = 0;
    /// Whether all edges are Delaunay; false only where rounding kept flips from ending, and they were
    /// stopped.
    bool finished = true;
  };
  /// Flips edges whose two opposite angles come to more than π, by more than 1e-9 in the sum of their
  /// cotangents, until there are none: the intrinsic Delaunay triangulation, which is unique up to cocircular
  /// points (A. I. Bobenko, B. A. Springborn, "A discrete Laplace–Beltrami operator for simplicial surfaces",
  /// 2007). Each lowers the sum of all cotangents. The order, first in first out from the smallest half-edge,
  /// is that of the input. Errors: kInterrupted.
  [[nodiscard]] Result<Flips> flip_to_delaunay(const Progress& progress = {});

  /// Whether the other diagonal of the edge of h lies within its two triangles. O(1).
  [[nodiscard]] bool can_flip(std::uint32_t h) const;
  /// Flips an edge that can. O(1).
  void flip(std::uint32_t h);
  /// The cotangents of the angles across from the edge, added; at least 0 where it is Delaunay. O(1).
  [[nodiscard]] double cotangent_sum(std::uint32_t h) const;

  [[nodiscard]] std::size_t vertex_count() const { return angle_sums_.size(); }
  [[nodiscard]] std::size_t face_count() const { return origins_.size() / 3; }
  [[nodiscard]] std::size_t half_edge_count() const { return origins_.size(); }
  // One for each half-edge; `twins` kInvalid on the boundary. In units of the positions, and in radians.
  [[nodiscard]] std::span<const std::uint32_t> origins() const { return origins_; }
  [[nodiscard]] std::span<const std::uint32_t> twins() const { return twins_; }
  [[nodiscard]] std::span<const double> lengths() const { return lengths_; }
  [[nodiscard]] std::span<const double> directions() const { return directions_; }
  /// All angles at each vertex, which flips leave as they are.
  [[nodiscard]] std::span<const double> angle_sums() const { return angle_sums_; }
  /// What was added to each edge where triangles were flat.
  [[nodiscard]] double added_length() const { return added_length_; }
  /// The angle at corner h. O(1).
  [[nodiscard]] double corner_angle(std::uint32_t h) const;

 private:
  std::vector<std::uint32_t> origins_, twins_;
  std::vector<double> lengths_, directions_, angle_sums_;
  double added_length_ = 0;
};

}  // namespace vkmesh
