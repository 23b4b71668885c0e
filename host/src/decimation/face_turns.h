// Whether a collapse would fold faces over, and how far it moves them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "decimation/collapse_mesh.h"

namespace vkmesh::detail {

/// The faces around the ends p and q of an edge that remain when it collapses, how they turn and how far they
/// move.
///
/// The corners go once around both ends, so that each consecutive two span a face and neighbours among the
/// faces follow each other. Two corners at the same place, or one at no place, span nothing.
class FaceTurns {
 public:
  /// So many faces are looked at at a time.
  static constexpr std::size_t kBlock = 16;

  /// Takes the neighbours of p but q and those of q but p, counter-clockwise: each ring starts where the
  /// other ends, and can be read up to a multiple of kBlock. Returns the flags of all these vertices.
  std::uint32_t set(const LargeArray<CollapseVertex>& vertices, std::span<const std::uint32_t> around_p,
                    std::span<const std::uint32_t> around_q);

  /// Whether some face turns too far or loses its area, one that had none stands against the others, or two
  /// neighbours come to stand against each other, when p, which lies at `p`, and q at `q` move to p + x. Both
  /// rings need at least two vertices, and must not be the same face.
  bool folds_over(const std::array<float, 3>& p, const std::array<float, 3>& q, const std::array<float, 3>& x,
                  float cos_deviation) const;

  /// The squared distance between the faces before and after that, as far as a few points show it: the ends
  /// and the middles of their edges, each to the faces on the other side. At least `least`: what is nearer
  /// does not matter.
  [[nodiscard]] float squared_distance(const std::array<float, 3>& p, const std::array<float, 3>& q,
                                       const std::array<float, 3>& x, float least) const;

 private:
  using Vector = std::array<float, 3>;

  /// Relative to p + x.
  [[nodiscard]] Vector corner(std::size_t k, const Vector& p, const Vector& x) const {
    return {x_[k] - p[0] - x[0], y_[k] - p[1] - x[1], z_[k] - p[2] - x[2]};
  }
  [[nodiscard]] Vector normal(std::size_t face, const Vector& p, const Vector& x) const;
  [[nodiscard]] bool disagrees(const Vector& p, const Vector& d, const Vector& x) const;
  [[nodiscard]] bool more_against(const Vector& p, const Vector& d, const Vector& x) const;

  using Lanes = std::vector<float>;
  Lanes x_, y_, z_;  // the corners: those around p, then those around q, and the first two again
  std::vector<std::uint32_t> ids_;    // of the corners
  std::size_t at_p_ = 0, faces_ = 0;  // faces at p, which come first, and all
};

}  // namespace vkmesh::detail
