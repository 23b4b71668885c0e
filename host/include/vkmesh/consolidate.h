// From an indexed face set to half-edges: finding which faces share an edge, and refusing what is no
// manifold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <vkmesh/half_edge_mesh.h>
#include <vkmesh/indexed_face_set.h>
#include <vkmesh/progress.h>
#include <vkmesh/result.h>

namespace vkmesh {

/// What consolidation found. All counts describe the input.
struct ConsolidateReport {
  std::size_t points = 0;
  std::size_t faces = 0;
  std::size_t edges = 0;  ///< Distinct unordered pairs of points that some face joins.
  std::size_t boundary_edges = 0;
  std::size_t isolated_points = 0;  ///< Kept: they have no half-edge.

  // Each of these makes the input unsuitable.
  std::size_t degenerate_faces = 0;    ///< Fewer than three corners, or a point repeated.
  std::size_t non_manifold_edges = 0;  ///< Three or more faces.
  std::size_t misoriented_edges = 0;   ///< Two faces that run the same way along the edge.
  std::size_t non_manifold_vertices =
      0;  ///< Faces that form more than one fan. Counted when edges are in order.

  [[nodiscard]] bool manifold() const {
    return degenerate_faces + non_manifold_edges + misoriented_edges + non_manifold_vertices == 0;
  }
  /// One sentence that counts the defects, each with its first element; empty when there are none.
  std::string defects;
};

struct Consolidated {
  HalfEdgeMesh mesh;
  ConsolidateReport report;
};

/// Looks for shared edges by sorting them: for each edge of each face a record (a = smaller point, b =
/// larger, which half-edge), in lexicographic order; one record alone is a boundary edge, two are joined,
/// three or more are non-manifold. The records are distributed by `a` first (counting sort), so the cost is
/// O(n + v) plus the small sorts within one point. Vertex i of the mesh is point i, half-edge i is corner i,
/// face i is face i. Errors: kUnsuitable (with every defect counted in one sentence), kOutOfMemory.
[[nodiscard]] Result<Consolidated> consolidate(const IndexedFaceSet& mesh);

/// The same judgement without the half-edges, for any input. O(n).
[[nodiscard]] Result<ConsolidateReport> survey(const IndexedFaceSet& mesh);

}  // namespace vkmesh
