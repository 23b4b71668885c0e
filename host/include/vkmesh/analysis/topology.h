// What a surface is topologically: Euler characteristic, genus, boundary, components, orientation. For any
// face set, manifold or not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh {

/// Counts of a surface, or of one of its components.
struct Topology {
  std::size_t points = 0;          ///< Those of its faces: isolated points are no part of a surface.
  std::size_t edges = 0;           ///< Distinct unordered pairs of points that some face joins.
  std::size_t faces = 0;           ///< Without degenerate ones.
  std::size_t boundary_edges = 0;  ///< Edges of one face.
  /// Chains of boundary edges that follow each other around the fans of their points. Every one is closed
  /// where no edge has three or more faces; a chain that ends at such an edge counts as one.
  std::size_t boundary_loops = 0;
  std::size_t non_manifold_edges = 0;  ///< Edges of three or more faces.
  /// Points whose faces, joined across edges of two faces, form more than one fan. Both ends of a
  /// non-manifold edge are among them.
  std::size_t non_manifold_vertices = 0;
  std::size_t misoriented_edges = 0;  ///< Edges of two faces that run along it in the same direction.

  /// Every edge has one face or two, and the faces of every point form one fan, open or closed.
  [[nodiscard]] bool manifold() const { return non_manifold_edges == 0 && non_manifold_vertices == 0; }
  /// Faces, and no boundary edge.
  [[nodiscard]] bool closed() const { return faces > 0 && boundary_edges == 0; }
  /// The faces of every edge of two faces run along it in opposite directions.
  [[nodiscard]] bool oriented() const { return misoriented_edges == 0; }
  /// Faces can be flipped so that `oriented` holds.
  bool orientable = true;
  /// χ = v − e + f.
  [[nodiscard]] std::int64_t euler_characteristic() const {
    return static_cast<std::int64_t>(points) - static_cast<std::int64_t>(edges) +
           static_cast<std::int64_t>(faces);
  }
  /// The number of handles g, from χ = 2 − 2g − b for a surface with b boundary loops; of a surface of
  /// several components the sum of theirs. None where it is undefined: not manifold, not orientable, or no
  /// faces.
  std::optional<std::int64_t> genus;
};

struct SurfaceTopology {
  Topology whole;
  /// Components are edge-connected faces; in order of their first faces. What they
  /// say of themselves leaves the others out: two tori that share a point are two manifold tori.
  std::vector<Topology> components;
  std::vector<std::uint32_t> component_of_face;  ///< kInvalid for degenerate faces.
};

/// Faces that repeat a point or have fewer than three corners are left out. O(n α(n)) for n corners, apart
/// from the small sorts within one point. Errors: kUsage for corners that name no point or offsets that do
/// not ascend; kUnsuitable for more than 2^32 - 2 corners or points; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<SurfaceTopology> surface_topology(const IndexedFaceSet& mesh);

/// What is odd about the elements of a face set, each on its own.
struct ElementDefects {
  std::size_t isolated_points = 0;   ///< Points that no face uses.
  std::size_t duplicate_points = 0;  ///< With the coordinates of an earlier one.
  std::size_t degenerate_faces = 0;  ///< Fewer than three corners, or a point repeated.
  std::size_t duplicate_faces = 0;   ///< With the points of an earlier one, in the same cyclic order or its
                                     ///< reverse; degenerate ones aside.
};

/// O(n log n) for n corners. Errors as surface_topology().
[[nodiscard]] VKMESH_API Result<ElementDefects> element_defects(const IndexedFaceSet& mesh);

}  // namespace vkmesh
