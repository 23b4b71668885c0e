// Makes an indexed face set an oriented manifold and builds its half-edges; repairs or refuses what is
// no oriented manifold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/repair/weld.h>

namespace vkmesh {

struct ConsolidateOptions {
  /// Points within the tolerance are made one before anything is judged. Default: none are.
  std::optional<WeldOptions> weld = {};
  /// Points at equal places are made one where the edges that use them have no partner: files repeat points
  /// for texture coordinates, normals and materials, which leaves the surface open along every seam. What is
  /// closed is not touched. Default: they stay apart.
  bool weld_boundary = false;
  /// Refuse a mesh that is no oriented manifold, instead of repairing it. Default: repair.
  bool strict = false;
  /// Points that no face uses stay (default), or go.
  bool keep_isolated_points = true;
  /// A surface like the Möbius strip, which no flipping of faces makes compatible, is cut open along edges
  /// (default), or refused.
  bool cut_non_orientable = true;
};

/// What was found, and what was done about it. Nothing is changed that is not counted here.
struct VKMESH_API ConsolidateReport {
  // The input, after welding where that was asked for.
  std::size_t points = 0;
  std::size_t faces = 0;
  std::size_t edges = 0;  ///< Distinct unordered pairs of points that some face joins, degenerate ones aside.
  std::size_t boundary_edges = 0;
  std::size_t isolated_points = 0;  ///< Points that no face uses.

  // What makes it no oriented manifold.
  std::size_t degenerate_faces = 0;    ///< Fewer than three corners, or a point repeated.
  std::size_t non_manifold_edges = 0;  ///< Three or more faces.
  std::size_t misoriented_edges = 0;   ///< Two faces that run the same way along the edge.
  /// Points whose faces form more than one fan; counted here when all edges are in order, else when the
  /// mesh is repaired.
  std::size_t non_manifold_vertices = 0;

  // What was done.
  std::size_t welded_points = 0;             ///< Points that became another.
  double largest_weld_move = 0;              ///< How far at most one went, a length.
  std::vector<std::string> weld_seams;       ///< Point channels that became corner channels by welding.
  std::size_t removed_degenerate_faces = 0;  ///< Fewer than three distinct points in a row.
  std::size_t removed_duplicate_faces = 0;   ///< The same points as an earlier face.
  std::size_t repaired_polygons = 0;  ///< That repeated a point: the repetition left out, or cut at it.
  std::size_t removed_points = 0;     ///< Isolated ones that were not to be kept.
  std::size_t split_edges = 0;        ///< Non-manifold ones, split into pairs and boundary edges.
  std::size_t split_points = 0;       ///< Points that were given copies, one for each fan of faces but one.
  std::size_t added_points = 0;       ///< Those copies.
  std::size_t flipped_faces = 0;
  std::size_t cut_components = 0;  ///< Non-orientable ones.
  std::size_t cut_edges = 0;       ///< The edges along which they were cut.

  /// The input is an oriented manifold: half-edges can hold it as it is.
  [[nodiscard]] bool manifold() const {
    return degenerate_faces + non_manifold_edges + misoriented_edges + non_manifold_vertices == 0;
  }
  /// One sentence that counts the defects found, each with its first element; empty when there are none.
  std::string defects;
  /// A sentence for each kind of thing that was done; empty when nothing was.
  [[nodiscard]] std::vector<std::string> repairs() const;
};

struct Consolidated {
  /// What `mesh` is the connectivity of: vertex i is point i, half-edge i is corner i, face i is face i.
  /// Attributes stay with their points, corners and faces.
  IndexedFaceSet face_set;
  HalfEdgeMesh mesh;
  ConsolidateReport report;
  /// For each point and face of `face_set` that of the input it came from; empty where they are the same. A
  /// point made of several by welding names the first.
  std::vector<std::uint32_t> source_point, source_face;
};

/// Makes a mesh an oriented manifold and builds its half-edges, in this order:
/// 1. points are welded, if asked for, all or those of the boundary;
/// 2. a point repeated in a row is left out of its polygon; polygons that still repeat a point are cut into
///    triangles (see `triangulate`); faces without three distinct points are removed, and faces that have
///    the points of an earlier one in the same order. The reverse of an earlier face is removed unless each
///    of its edges has as many faces one way as the other, as the wall between two solids has;
/// 3. faces that share an edge of two faces are flipped to agree, as the larger part of each such sheet lies;
///    where a sheet is not orientable it is cut along the edges that still disagree. Sheets are flipped,
///    small ones first, where edges of four, six, … faces then have more of them opposite ways;
/// 4. edges of three or more faces are split: where as many faces run one way as the other, into the pairs
///    between which the thinnest wedges of solid lie, as where two solids touch along an edge; else into the
///    flattest pairs of opposite direction, the rest becoming boundary;
/// 5. a point whose faces form several fans is given a copy at the same place for each but the first;
/// 6. where as many faces of a closed component were flipped as were not, it is made to face outward (its
/// volume
///    is positive); else the fewer are flipped, so that a cavity stays one.
/// No position changes but by welding. A mesh that is an oriented manifold already passes unchanged, in
/// O(n): edges are distributed to their smaller points by counting, and sorted within one point. Repairs
/// take O(n log n). Errors: kUnsuitable with every defect counted when `strict` (or for a non-orientable
/// mesh that is not to be cut); kUsage for corners that name no point; kOutOfMemory; kInterrupted.
[[nodiscard]] VKMESH_API Result<Consolidated> consolidate(IndexedFaceSet mesh,
                                                          const ConsolidateOptions& options = {},
                                                          const Progress& progress = {});

/// What consolidate() would find, without changing or building anything. O(n). Errors: kUsage, kOutOfMemory.
[[nodiscard]] VKMESH_API Result<ConsolidateReport> diagnose(const IndexedFaceSet& mesh);

/// The half-edges of a mesh that is an oriented manifold: vertex i is point i, half-edge i is corner i, face
/// i is face i. O(n). Errors: kUnsuitable with every defect counted in one sentence; kUsage, kOutOfMemory.
[[nodiscard]] VKMESH_API Result<HalfEdgeMesh> to_half_edge_mesh(const IndexedFaceSet& mesh);

/// The faces of a half-edge mesh over the given positions, without attributes: the inverse of
/// to_half_edge_mesh(). O(n). Errors: kUsage unless there is one position for each vertex; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<IndexedFaceSet> to_indexed_face_set(const HalfEdgeMesh& mesh,
                                                                    std::vector<Vec3> positions);

}  // namespace vkmesh
