// Laplacian smoothing: uniform or cotangent weights, λ alone or λ|μ.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/node_neighbours.h>

namespace vkmesh {

/// How much each neighbour of a vertex counts.
enum class SmoothingWeights : std::uint8_t {
  kUniform,  ///< All alike. Evens out the triangles as well.
  /// cot α + cot β of the angles opposite the edge, of the positions before each step, held in [0, 2^11]
  /// (M. Desbrun, M. Meyer, P. Schröder, A. H. Barr, "Implicit fairing of irregular meshes using diffusion
  /// and curvature flow", 1999). Moves vertices along the normal only. A triangle without area gives no
  /// weight; a vertex all of whose weights are below 2^-20 stays.
  kCotangent,
};

/// What boundary vertices do.
enum class SmoothingBoundary : std::uint8_t {
  kFixed,        ///< They stay where they are.
  kAlongItself,  ///< They move towards the mean of their two neighbours on the boundary.
  kFree,         ///< They move as any other.
};

struct LaplacianSmoothingOptions {
  float lambda = 0.5f;            ///< Share of the way to the neighbours' mean, in [0, 1]. Default 0.5.
  std::uint32_t iterations = 10;  ///< Jacobi steps: each reads only the positions before it. Default 10.
  SmoothingBoundary boundary = SmoothingBoundary::kFixed;  ///< Default fixed.
  SmoothingWeights weights = SmoothingWeights::kUniform;
  /// In [−1, 0]. Unless 0, each iteration is a step by λ and a step by μ, which together keep low frequencies
  /// (G. Taubin, "A signal processing approach to fair surface design", 1995): μ a little beyond −λ, such as
  /// −0.53 for λ = 0.5. smoothing_gain() tells what such a pair makes larger. Default 0.
  float mu = 0.0f;
  /// Bit v % 32 of word v / 32: vertex v stays. Empty: none. On a device DeviceSmoothing::locked takes this
  /// instead.
  std::span<const std::uint32_t> locked = {};
};

/// What one iteration multiplies the frequency k of a surface by: (1 − λk)(1 − μk), for the eigenvalues k of
/// the mesh's Laplacian, which lie in [0, 2] for both kinds of weights (G. Taubin, "Curve and surface
/// smoothing without shrinkage", 1995, §3 and §4). Iterations raise it to a power: where it exceeds 1 in
/// magnitude, they diverge. Below the pass-band frequency 1/λ + 1/μ it does so by little, at most at half of
/// that, as long as μ is near −λ; up to k = 2 it does not where 1/λ + 1/μ ≤ 2 and λ ≤ (1 − μ) / (1 − 2μ).
[[nodiscard]] inline double smoothing_gain(double lambda, double mu, double k) {
  return (1 - lambda * k) * (1 - mu * k);
}

/// v ← v + λ (weighted mean of its neighbours − v), `iterations` times, all vertices at once (lecture, "Mesh
/// smoothing"). Neighbours are summed in NodeNeighbours order; isolated vertices stay. The reference of
/// shaders/passes/laplacian_smoothing.comp and cotangent_smoothing.comp, equal to them bit for bit.
/// Coordinates below 2^-100 in magnitude become 0. Cotangent weights take the neighbours of a triangle mesh.
/// O(iterations × edges). Memory: about 40 bytes a vertex beside the result. Errors: kUsage for λ outside [0,
/// 1], μ outside [−1, 0], a wrong number of positions or of locked vertices; kOutOfMemory; kInterrupted.
[[nodiscard]] VKMESH_API Result<std::vector<Vec3>> laplacian_smoothing(
    const NodeNeighbours& neighbours, std::span<const Vec3> positions,
    const LaplacianSmoothingOptions& options = {}, const Progress& progress = {});

}  // namespace vkmesh
