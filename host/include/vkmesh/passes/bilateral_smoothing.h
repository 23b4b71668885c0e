// Feature-preserving smoothing: noise goes, edges stay.
#pragma once

#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

struct BilateralSmoothingOptions {
  /// σ_f, a length: how far faces count; those nearer than 2 σ_f do. Four mean edge lengths smooth the noise
  /// of a scan.
  float spatial = 0.0f;
  /// σ_g, a length: predictions farther than about 2 σ_g from a vertex lie across a feature and hardly count.
  /// Small: only noise goes; as large as features: they go too.
  float influence = 0.0f;
};

/// T. R. Jones, F. Durand, M. Desbrun, "Non-iterative, feature-preserving mesh smoothing", 2003 (lecture,
/// "Mesh smoothing"). Each vertex p moves to the weighted mean of its predictions, the feet of p on the
/// tangent planes of the faces q around it: p ← Σ Π_q(p) w_q / Σ w_q with w_q = a_q f(|c_q − p|) g(|Π_q(p) −
/// p|), where a_q is the area of the face, c_q its centroid, and f and g are Gaussians of widths σ_f and σ_g.
/// Tangent planes go through the centroids, along normals of the mesh mollified by the same means: each
/// vertex at the mean of the centroids, by a_q and a Gaussian of width σ_f / 2. The spatial ones end at twice
/// their width. Nearness is that of space: pieces that lie side by side smooth each other. Faces are summed
/// in the order of a grid of cells, and in ascending order in a cell: the same bytes on any number of
/// threads. Tangent planes of a curved surface pass outside of it, so that it grows: the radius of a
/// sphere whose mean edge is 0.15 of it by 8.1 % with σ_f and σ_g of 4 and 1 mean edges, by 4.7 % with 2 and
/// 1, by 1.7 % with 2 and 0.2; restore_volume() takes that back from closed surfaces. Triangles without area
/// do not count; isolated vertices, and those that no face is near to, stay. O(vertices × faces within 2
/// σ_f). Errors: kUsage unless 2^-40 ≤ σ_f, σ_g ≤ 2^40; kUnsuitable unless triangles, and for a mesh more
/// than 2^20 σ_f wide; kUsage unless one position for each vertex; kOutOfMemory; kInterrupted.
[[nodiscard]] VKMESH_API Result<std::vector<Vec3>> bilateral_smoothing(
    const HalfEdgeMesh& mesh, std::span<const Vec3> positions, const BilateralSmoothingOptions& options,
    const Progress& progress = {});

/// What σ_f is given in multiples of; 0 for a mesh without edges. In double precision; O(half-edges).
[[nodiscard]] VKMESH_API double mean_edge_length(const HalfEdgeMesh& mesh, std::span<const Vec3> positions);

}  // namespace vkmesh
