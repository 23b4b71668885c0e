// Sums of squared distances to planes, as a function of a point.
#pragma once

#include <vkmesh/vec.h>

namespace vkmesh::detail {

/// Σ w (n·x − d)² over planes (n, d) of weight w, as xᵀA x + 2 b·x + c with x relative to a centre that the
/// owner knows. Centred on the vertex it belongs to, it keeps its precision however far the mesh lies from
/// the origin.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  // A
  DVec3 linear{0.0};                                      // b
  double constant = 0;                                    // c, the value at the centre
  double weight = 0;                                      // Σ w

  /// Adds a plane through the centre with unit normal n.
  void add_plane(const DVec3& n, double w) {
    xx += w * n.x * n.x;
    xy += w * n.x * n.y;
    xz += w * n.x * n.z;
    yy += w * n.y * n.y;
    yz += w * n.y * n.z;
    zz += w * n.z * n.z;
    weight += w;
  }

  [[nodiscard]] DVec3 times(const DVec3& x) const {
    return {xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z};
  }

  /// The value at x. Not negative: what rounding leaves below 0 is 0.
  [[nodiscard]] double at(const DVec3& x) const {
    const DVec3 ax = times(x);
    const double value =
        constant + x.x * (ax.x + 2 * linear.x) + x.y * (ax.y + 2 * linear.y) + x.z * (ax.z + 2 * linear.z);
    return value > 0 ? value : 0;
  }

  /// Adds `other`, whose centre lies at −offset from here: this centre is `offset` in its coordinates.
  void add(const Quadric& other, const DVec3& offset) {
    const DVec3 shifted = other.times(offset) + other.linear;
    constant += other.at(offset);
    linear += shifted;
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
    weight += other.weight;
  }
};

}  // namespace vkmesh::detail
