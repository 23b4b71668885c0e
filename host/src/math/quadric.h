// Quadric error functions (M. Garland, P. Heckbert, "Surface simplification using quadric error metrics",
// 1997).
#pragma once

#include <array>
#include <cstddef>

#include <vkmesh/math/arithmetic.h>

#include "math/vector3.h"

namespace vkmesh::detail {

// Everything is inline and branchless: a loop over lanes of a batch, compiled for wide registers, calls the
// same functions as scalar code does, and gets the same bytes.

/// IEEE arithmetic as processors do it, for what stays on the host.
struct HostArithmetic {
  /// Added to the pivots of a quadric that is 0.
  static constexpr float kLeastPivot = 1e-36f;
  static float reciprocal(float x) { return 1.0f / x; }
  static float entry(float x) { return x; }
  static float direction(float x) { return x; }
  static float product(float x) { return x; }
};

/// Arithmetic that is the same to the bit on every device (docs/exactness.md): entries of quadrics,
/// directions and products so small that what follows might be subnormal count as 0, and reciprocals are
/// computed.
struct DeviceArithmetic {
  static constexpr float kLeastPivot = VKMESH_FLAT_LEAST;
  static float reciprocal(float x) { return exact::reciprocal(x); }
  static float entry(float x) { return zero_below(x, VKMESH_TINY_QUADRIC); }
  static float direction(float x) { return zero_below(x, VKMESH_TINY_DIRECTION); }
  static float product(float x) { return zero_below(x, VKMESH_TINY_COORDINATE); }
};

/// A symmetric matrix: xx, xy, xz, yy, yz, zz.
using Symmetric3 = std::array<float, 6>;

[[nodiscard, gnu::always_inline]] inline Vector3 times(const Symmetric3& a, const Vector3& x) {
  return {a[0] * x[0] + a[1] * x[1] + a[2] * x[2], a[1] * x[0] + a[3] * x[1] + a[4] * x[2],
          a[2] * x[0] + a[4] * x[1] + a[5] * x[2]};
}
[[nodiscard, gnu::always_inline]] inline Symmetric3 plus(const Symmetric3& a, const Symmetric3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]};
}

[[nodiscard, gnu::always_inline]] inline Symmetric3 minus(const Symmetric3& a, const Symmetric3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3], a[4] - b[4], a[5] - b[5]};
}

/// w n nᵀ: squared distances from the plane through the origin with the unit normal n, times w.
template <class Arithmetic>
[[nodiscard, gnu::always_inline]] inline Symmetric3 plane_quadric(const Vector3& n, float w) {
  const auto entry = [](float x) __attribute__((always_inline)) {
    return Arithmetic::entry(x);
  };
  const float x = entry(w * n[0]), y = entry(w * n[1]), z = entry(w * n[2]);
  return {entry(x * n[0]), entry(x * n[1]), entry(x * n[2]),
          entry(y * n[1]), entry(y * n[2]), entry(z * n[2])};
}

/// xᵀA x + 2 b·x + c of a place x, relative to the origin about which it is expressed.
struct Quadric {
  Symmetric3 a{};
  float c = 0;
  Vector3 b{};

  /// What rounding leaves below 0 is 0.
  [[nodiscard, gnu::always_inline]] float value(const Vector3& x) const { return value(x, times(a, x)); }

  /// Moves the origin by d.
  [[gnu::always_inline]] void shift(const Vector3& d) {
    const Vector3 ad = times(a, d);
    c = value(d, ad);
    b = plus(b, ad);
  }

  /// Adds a share of a quadric about the same origin.
  [[gnu::always_inline]] void add(const Quadric& of, float share = 1) {
    for (std::size_t k = 0; k < 6; ++k) a[k] += share * of.a[k];
    for (std::size_t k = 0; k < 3; ++k) b[k] += share * of.b[k];
    c += share * of.c;
  }

  /// Adds w (g·x + value)².
  [[gnu::always_inline]] void add_square(const Vector3& g, float value, float w) {
    a[0] += w * g[0] * g[0];
    a[1] += w * g[0] * g[1];
    a[2] += w * g[0] * g[2];
    a[3] += w * g[1] * g[1];
    a[4] += w * g[1] * g[2];
    a[5] += w * g[2] * g[2];
    for (std::size_t k = 0; k < 3; ++k) b[k] += w * g[k] * value;
    c += w * value * value;
  }

 private:
  [[nodiscard, gnu::always_inline]] float value(const Vector3& x, const Vector3& ax) const {
    const float sum = c + x[0] * (ax[0] + 2 * b[0]) + x[1] * (ax[1] + 2 * b[1]) + x[2] * (ax[2] + 2 * b[2]);
    return sum > 0 ? sum : 0.0f;
  }
};

/// L D Lᵀ of A + εI, by which (A + εI) s = −g is solved. ε is 2^-20 of the trace: directions in which A is
/// flatter than that are left alone, and pivots are at least ε but for rounding.
template <class Arithmetic>
struct Factors {
  float r0, r1, r2, l1, l2, l3;  // reciprocals of D; xy, xz and yz of L

  [[gnu::always_inline]] explicit Factors(const Symmetric3& a) {
    const float e = (a[0] + a[3] + a[5]) * VKMESH_FLAT_SHARE + Arithmetic::kLeastPivot, least = 0.5f * e;
    r0 = Arithmetic::reciprocal(a[0] + e);
    l1 = product(a[1] * r0);
    l2 = product(a[2] * r0);
    const float p1 = (a[3] + e) - product(l1 * a[1]);
    r1 = Arithmetic::reciprocal(p1 > least ? p1 : least);
    const float u = product(a[4] - product(l2 * a[1]));
    l3 = product(u * r1);
    const float p2 = (a[5] + e) - product(l2 * a[2]) - product(l3 * u);
    r2 = Arithmetic::reciprocal(p2 > least ? p2 : least);
  }

  [[nodiscard, gnu::always_inline]] Vector3 solve(const Vector3& g) const {
    const float w0 = -g[0], w1 = product(-g[1] - product(l1 * w0)),
                w2 = product(-g[2] - product(l2 * w0) - product(l3 * w1));
    const float z = product(w2 * r2);
    const float y = product(product(w1 * r1) - product(l3 * z));
    const float x = product(product(w0 * r0) - product(l1 * y) - product(l2 * z));
    return {x, y, z};
  }

 private:
  [[gnu::always_inline]] static float product(float x) { return Arithmetic::product(x); }
};

/// The way from the middle of an edge, which goes along d, to the nearest place to it where a quadric is
/// least that has the matrix A and half the gradient g there; 0 where that is farther than twice the edge, to
/// where no planes of its faces can lead in earnest.
template <class Arithmetic>
[[nodiscard, gnu::always_inline]] inline Vector3 way_to_least(const Symmetric3& a, const Vector3& g,
                                                              const Vector3& d) {
  const auto each = [](const Vector3& v, auto&& f) __attribute__((always_inline)) {
    return Vector3{f(v[0]), f(v[1]), f(v[2])};
  };
  const auto direction = [](float x) __attribute__((always_inline)) {
    return Arithmetic::direction(x);
  };
  const auto product = [](float x) __attribute__((always_inline)) {
    return Arithmetic::product(x);
  };
  const Factors<Arithmetic> factors(a);
  const Vector3 first = factors.solve(g);
  // Once more for the rest, which takes back what ε has shortened of steep directions.
  const Vector3 rest = each(plus(g, times(a, each(first, direction))), product);
  const Vector3 s = each(plus(first, factors.solve(rest)), direction);
  const bool near = dot(s, s) <= 4 * dot(d, d);
  return {near ? s[0] : 0.0f, near ? s[1] : 0.0f, near ? s[2] : 0.0f};
}

}  // namespace vkmesh::detail
