// The surface that was given, and the points of it that are nearest to vertices that move.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

#include "spatial/triangle_tree.h"

namespace vkmesh::detail {

/// A point of the surface: of a face, by barycentric weights that are at least 0 and add up to 1.
struct Foot {
  std::uint32_t face = kInvalid;
  std::array<double, 3> weights{1, 0, 0};
  DVec3 point{0.0};
  double distance2 = 0;  // squared, from the point that was asked for
};

/// Borrows the mesh and the positions. `scale` multiplies coordinates, for all that comes in and goes out.
class OriginalSurface {
 public:
  OriginalSurface(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, double scale)
      : mesh_(mesh), positions_(positions), scale_(scale) {}

  [[nodiscard]] const HalfEdgeMesh& mesh() const { return mesh_; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] DVec3 position(std::uint32_t v) const { return DVec3(positions_[v]) * scale_; }
  /// Along the normal of a face, twice its area long.
  [[nodiscard]] DVec3 normal(std::uint32_t face) const;
  /// Faces that no chain of edges joins but across these half-edges are of different patches. O(faces).
  void part_at(const std::vector<bool>& half_edges);

  /// The point of a face that is nearest to p.
  [[nodiscard]] Foot nearest_in(std::uint32_t face, const DVec3& p) const;
  /// Walks over the surface, from the face on, to faces that are nearer to p, as long as there are such
  /// around: the nearest point of the neighbourhood, never one of another sheet that passes nearby. Stays in
  /// the patch of the face.
  [[nodiscard]] Foot walk(std::uint32_t face, const DVec3& p) const;
  /// The nearer of where walks from two faces end: at a fold one may stay on the wrong leaf.
  [[nodiscard]] Foot nearer_walk(std::uint32_t one, std::uint32_t other, const DVec3& p) const {
    const Foot first = walk(one, p);
    if (one == other) return first;
    const Foot second = walk(other, p);
    return second.distance2 < first.distance2 ? second : first;
  }
  /// The nearest point of all, by the tree. build_tree() first.
  [[nodiscard]] Foot search(const Foot& hint, const DVec3& p) const;
  void build_tree();
  /// The nearest point of all if the faces there look as those of the hint do and are of its patch; else the
  /// hint.
  [[nodiscard]] Foot search_same_side(const Foot& hint, const DVec3& p) const;

 private:
  [[nodiscard]] std::uint32_t patch(std::uint32_t face) const { return patch_.empty() ? 0 : patch_[face]; }
  /// Twin within the patch; kInvalid at its border.
  [[nodiscard]] std::uint32_t across(std::uint32_t h) const {
    const std::uint32_t t = mesh_.twins()[h];
    return t == kInvalid || patch_.empty() || !is_border_[h] ? t : kInvalid;
  }

  const HalfEdgeMesh& mesh_;
  std::span<const Vec3> positions_;
  double scale_;
  std::vector<std::uint32_t> patch_;
  std::vector<bool> is_border_;
  std::optional<TriangleTree> tree_;
  std::vector<std::uint32_t> leaf_;  // of each face, in the tree
};

}  // namespace vkmesh::detail
