// The largest distance between the surface that changes and the original.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "remesh/original_surface.h"

namespace vkmesh::detail {

/// Keeps two surfaces near each other both ways, at samples: each vertex of the original, and the middle of
/// each edge where it is bent, has a face of the changing mesh that is near it, and the quarters of edges
/// that an edit makes are near the original. Edits that would part them are to be left undone; the two are
/// the same in the beginning.
class DeviationBound {
 public:
  /// A face that an edit makes, or moves. Samples are on the edge from corner 0 to corner 1.
  struct Face {
    std::uint32_t number;
    std::array<DVec3, 3> corners;
    std::uint32_t near;  // a face of the original that is near it
  };

  /// Without a bound all is allowed, and at no cost. Borrows the surface.
  explicit DeviationBound(const OriginalSurface& surface) : surface_(surface) {}
  DeviationBound(const OriginalSurface& surface, double most);

  /// How far samples may be apart, as a share of what surfaces may. Between them they are farther apart:
  /// where edges of both cross, the gap is a tent of which the quarters of an edge see four fifths or more,
  /// and folds take the rest.
  static constexpr double kAtSamples = 0.7;

  [[nodiscard]] bool is_set() const { return most2_ > 0; }
  /// Whether `made` may take the place of the faces of these numbers. O(samples × faces).
  [[nodiscard]] bool allows(std::span<const std::uint32_t> gone, std::span<const Face> made);
  /// Does so, as far as samples are concerned, after allows() of the same faces, whatever it said.
  void replace();

  /// Whether a point is near the original, by a walk from a face of it on.
  [[nodiscard]] bool is_near(const DVec3& p, std::uint32_t face) const {
    return surface_.walk(face, p).distance2 <= most2_;
  }

 private:
  static constexpr std::uint32_t kNone = kInvalid;

  const OriginalSurface& surface_;
  double most2_ = 0;
  std::vector<DVec3> points_;
  // Lists of the samples of each face: the first, and for each the next.
  std::vector<std::uint32_t> first_, next_;
  // What the last question has looked at; kept for its memory.
  std::vector<std::uint32_t> gone_, samples_, faces_of_samples_;
};

}  // namespace vkmesh::detail
