// Where the faces around an edge that is to collapse have their corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// The faces around the ends p and q of an edge that remain when it collapses.
///
/// Their corners but p and q go once around both ends, so that each consecutive two span a face and
/// neighbours among the faces follow each other. Two corners at the same place, or one at no place, span
/// nothing.
class CollapseNeighbourhood {
 public:
  using Vector = Vector3;
  /// So many faces are looked at at a time; whole blocks can be read.
  static constexpr std::size_t kBlock = 16;

  /// What is known of the vertices around.
  struct Summary {
    std::uint32_t flags;  // of all
    /// Whether one of the first eight of p's, both ends left out, is among the first eight of q's or what
    /// follows a shorter ring.
    bool may_share;
  };
  /// Takes the neighbours of p but q and those of q but p, counter-clockwise: each ring starts where the
  /// other ends, and can be read up to a multiple of kBlock.
  Summary set(const LargeArray<VertexRecord>& vertices, std::span<const std::uint32_t> around_p,
              std::span<const std::uint32_t> around_q);

  /// Those at p come first.
  [[nodiscard]] std::size_t faces_at_p() const { return at_p_; }
  [[nodiscard]] std::size_t faces() const { return faces_; }
  /// Face k has corners k and k + 1; the first two come again after the last.
  [[nodiscard]] const float* x() const { return x_.data(); }
  [[nodiscard]] const float* y() const { return y_.data(); }
  [[nodiscard]] const float* z() const { return z_.data(); }
  /// Relative to p + x.
  [[nodiscard]] Vector corner(std::size_t k, const Vector& p, const Vector& x) const {
    return {x_[k] - p[0] - x[0], y_[k] - p[1] - x[1], z_[k] - p[2] - x[2]};
  }

 private:
  using Lanes = std::vector<float>;
  Lanes x_, y_, z_;
  std::vector<std::uint32_t> ids_;  // of the corners
  std::size_t at_p_ = 0, faces_ = 0;
};

}  // namespace vkmesh::detail
