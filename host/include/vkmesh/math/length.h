// A length that options ask for: absolute, or relative to the size of the mesh.
#pragma once

namespace vkmesh {

/// A number of units of the positions, or a share of the diagonal of their bounding box.
struct Length {
  double value = 0;
  bool is_relative = false;

  [[nodiscard]] static constexpr Length absolute(double value) { return {value, false}; }
  [[nodiscard]] static constexpr Length relative(double share) { return {share, true}; }

  /// In units of the positions, for a bounding box of this diagonal.
  [[nodiscard]] constexpr double in_units(double diagonal) const {
    return is_relative ? value * diagonal : value;
  }
};

}  // namespace vkmesh
