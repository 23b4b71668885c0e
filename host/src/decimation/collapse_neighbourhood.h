// The faces around an edge that is to collapse: both one-rings, with positions by coordinate.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "decimation/vertex_record.h"
#include "mesh/edit/one_ring.h"

namespace vkmesh::detail {

/// The one-rings of the ends p and q of an edge, and the faces there that remain when it collapses.
///
/// The corners of those faces but p and q go once around both ends, so that each consecutive two span a face
/// and neighbours among the faces follow each other. Two corners at the same place, or one at no place, span
/// nothing.
class CollapseNeighbourhood {
 public:
  using Vector = Vector3;
  /// So many faces are looked at at a time; whole blocks can be read.
  static constexpr std::size_t kBlock = LongRing::kBlock;

  /// Takes the ring of p without q and that of q without p, which must outlive it: each starts where the
  /// other ends, and its vertices can be read up to a multiple of kBlock.
  void set(const LargeArray<VertexRecord>& vertices, const OneRing& p, const OneRing& q);

  [[nodiscard]] const OneRing& ring_p() const { return ring_p_; }
  [[nodiscard]] const OneRing& ring_q() const { return ring_q_; }
  /// The flags of all vertices of both rings.
  [[nodiscard]] std::uint32_t flags() const { return flags_; }
  /// Whether p and q may share neighbours beside those across the edge's faces: false is certain.
  [[nodiscard]] bool may_share_more() const {
    return std::max(ring_p_.size(), ring_q_.size()) > kCompared + 2 || may_share_;
  }

  /// Those at p come first.
  [[nodiscard]] std::size_t faces_at_p() const { return ring_p_.size() - 1; }
  [[nodiscard]] std::size_t faces() const { return faces_at_p() + ring_q_.size() - 1; }
  /// Face k has corners k and k + 1; the first two come again after the last.
  [[nodiscard]] const float* x() const { return x_.data(); }
  [[nodiscard]] const float* y() const { return y_.data(); }
  [[nodiscard]] const float* z() const { return z_.data(); }
  /// Corner k relative to p + x.
  [[nodiscard]] Vector corner(std::size_t k, const Vector& p, const Vector& x) const {
    return {x_[k] - p[0] - x[0], y_[k] - p[1] - x[1], z_[k] - p[2] - x[2]};
  }

 private:
  static constexpr std::size_t kCompared = 8;
  using Lanes = std::vector<float>;
  Lanes x_, y_, z_;
  std::vector<std::uint32_t> ids_;  // of the corners
  OneRing ring_p_, ring_q_;
  std::uint32_t flags_ = 0;
  // Whether one of the first kCompared of p's, both ends left out, is among the first kCompared of q's or
  // what follows a shorter ring.
  bool may_share_ = false;
};

}  // namespace vkmesh::detail
