// The hole that a vertex leaves behind, and how to fill it best.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace vkmesh::detail {

/// A quadric about a vertex, xᵀA x + 2 b·x + c; as CollapseVertex has it.
struct QuadricAt {
  std::array<float, 6> a;  // xx, xy, xz, yy, yz, zz
  std::array<float, 3> b;
  float c;

  [[nodiscard]] float at(const std::array<float, 3>& x) const;
};

/// The neighbours of a vertex v and the triangles that may take the place of those at v.
///
/// Seen along the area-weighted normal of v's faces, the old surface and each new one are graphs over the
/// same polygon: their faces must all look up. How far they lie apart is known from the corners of the
/// overlay of both: from v and the point below or above it, and from where edges of v cross new edges. The
/// error of a triangulation is the quadric of v at that point, so that all that v stands for counts, and for
/// each crossing the squared difference of heights times half the area of the faces at the edge of v. That is
/// a sum over new triangles and new edges, so the best of all triangulations is found part by part, each part
/// of the polygon once (G. Klincsek, "Minimal triangulations of polygonal domains", 1980). Among
/// triangulations alike, as of flat ground, that of the shorter edges wins.
class Hole {
 public:
  using Vector = std::array<float, 3>;
  using Triangle = std::array<std::uint8_t, 3>;
  static constexpr std::size_t kMost = 32;  // neighbours

  /// Takes the neighbours of v, relative to v, counter-clockwise. Not closed: v lies on the boundary between
  /// the last and the first. False when the faces at v do not all look up.
  [[nodiscard]] bool set(std::span<const Vector> ring, bool closed);

  /// Whether an edge between neighbours i < j would be none of the polygon's that is there already.
  [[nodiscard]] bool is_new(std::size_t i, std::size_t j) const {
    return j > i + 1 && !(closed_ && i == 0 && j + 1 == size_);
  }
  /// The new edge between neighbours i and j exists elsewhere already.
  void forbid(std::size_t i, std::size_t j) {
    forbidden_[i] |= 1u << j;
    forbidden_[j] |= 1u << i;
  }

  /// Finds the best triangulation in which no face turns by more than the angle whose cosine is given. False
  /// when there is none. O(n³) for n neighbours.
  [[nodiscard]] bool fill(const QuadricAt& quadric, float cos_deviation);

  // Of the triangulation found.

  /// Squared distance times area.
  [[nodiscard]] float error() const { return error_; }
  /// By neighbours in ascending order, which is counter-clockwise; two fewer than neighbours.
  [[nodiscard]] std::span<const Triangle> triangles() const { return std::span(triangles_).first(count_); }
  /// Whether two neighbouring triangles stand against each other by more than 120 degrees and by more than
  /// any did before.
  [[nodiscard]] bool folds_over() const;
  /// The neighbours that v's part of the surface falls to, and how much of it to each; the shares sum to 1.
  struct Heir {
    std::uint8_t neighbour;
    float share;
  };
  [[nodiscard]] std::span<const Heir> heirs() const { return std::span(heirs_).first(heir_count_); }

 private:
  using Row = std::array<float, kMost>;

  [[nodiscard]] float up(std::size_t i, std::size_t j) const { return i < j ? up_[i][j] : -up_[j][i]; }
  [[nodiscard]] Vector face(std::size_t i) const;
  // Corners i < l < j. Twice the area vector.
  [[nodiscard]] Vector normal(std::size_t i, std::size_t l, std::size_t j) const;
  [[nodiscard]] bool is_legal(std::size_t i, std::size_t l, std::size_t j, float cos_deviation) const;
  [[nodiscard]] bool contains_v(std::size_t i, std::size_t l, std::size_t j) const {
    // An edge through v belongs to the triangle on one side of it only.
    return up_[i][l] >= 0 && up_[l][j] >= 0 && up_[i][j] < 0;
  }
  [[nodiscard]] float error_at_v(std::size_t i, std::size_t l, std::size_t j) const;
  [[nodiscard]] float edge_error(std::size_t i, std::size_t j) const;
  void take_triangles();
  void find_heirs(const QuadricAt& quadric);

  std::size_t size_ = 0;
  bool closed_ = false;
  std::array<Vector, kMost> ring_;
  std::array<std::array<Vector, kMost>, kMost> cross_;  // of ring i and j, i < j
  std::array<Row, kMost> up_;                           // its component along the normal
  Row height_, spoke_;                                  // along the normal; weight of the edge to v
  Vector up_direction_;
  float area_ = 0;                              // of the faces at v
  float rounding_ = 0;                          // of heights
  float along0_ = 0, along1_ = 0, along2_ = 0;  // the quadric at height z: 0 + 2 z 1 + z² 2
  std::array<std::uint32_t, kMost> forbidden_{};
  std::array<Row, kMost> best_;
  std::array<std::array<std::uint8_t, kMost>, kMost> apex_;
  std::array<Triangle, kMost> triangles_;
  std::size_t count_ = 0;
  std::array<Heir, 3> heirs_;
  std::size_t heir_count_ = 0;
  float error_ = 0;
};

}  // namespace vkmesh::detail
