// What is known of each edge while a triangulation is constrained: whether it must stay, and why.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/large_array.h"
#include "planar/triangle_mesh.h"

namespace vkmesh::detail {

/// For each half-edge its kind, in both of an edge; for each triangle whether it is outside of the domain;
/// for each vertex a half-edge that leaves it. A byte a triangle: two bits a half-edge, the rest its own.
class EdgeMarks {
 public:
  enum Kind : std::uint8_t { kFree = 0, kBorder = 1, kConstraint = 2 };

  EdgeMarks() = default;
  EdgeMarks(const PlanarTriangles& triangles, std::size_t vertices)
      : of_triangle_(triangles.origins.size() / 3), leaving_(vertices) {
    std::fill_n(of_triangle_.data(), triangles.count, std::uint8_t{0});
    for (std::uint32_t t = 0; t < triangles.count; ++t)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t v = triangles.origins[3 * std::size_t{t} + i];
        if (v != kInvalid) leaving_[v] = 4 * t + i;
      }
  }

  [[nodiscard]] std::uint8_t kind(std::uint32_t h) const { return of_triangle_[h >> 2] >> 2 * (h & 3u) & 3u; }
  void set_kind(std::uint32_t h, std::uint8_t kind) {
    std::uint8_t& mark = of_triangle_[h >> 2];
    const unsigned shift = 2 * (h & 3u);
    mark = static_cast<std::uint8_t>((mark & ~(3u << shift)) | unsigned{kind} << shift);
  }
  /// Whether the edge may not be swapped: none outside may.
  [[nodiscard]] bool is_fixed(std::uint32_t h) const {
    return (of_triangle_[h >> 2] & (3u << 2 * (h & 3u) | kOutside)) != 0;
  }
  [[nodiscard]] bool is_outside(std::uint32_t triangle) const {
    return (of_triangle_[triangle] & kOutside) != 0;
  }
  void set_outside(std::uint32_t triangle) { of_triangle_[triangle] |= kOutside; }
  /// While a cavity is triangulated anew.
  [[nodiscard]] bool is_in_cavity(std::uint32_t triangle) const {
    return (of_triangle_[triangle] & kInCavity) != 0;
  }
  void set_in_cavity(std::uint32_t triangle) { of_triangle_[triangle] |= kInCavity; }
  /// Frees the edges of a triangle, and takes it out of the cavity.
  void clear(std::uint32_t triangle) { of_triangle_[triangle] &= kOutside; }
  /// Makes triangle `to`, which is new, lie where `from` lies.
  void copy_region(std::uint32_t from, std::uint32_t to) { of_triangle_[to] = of_triangle_[from] & kOutside; }

  [[nodiscard]] std::uint32_t leaving(std::uint32_t v) const { return leaving_[v]; }
  void set_leaving(std::uint32_t v, std::uint32_t h) {
    if (v != kInvalid) leaving_[v] = h;
  }

  void before_swap(const PlanarTriangles& triangles, std::uint32_t h) {
    const std::uint32_t n = PlanarTriangles::next(h), m = PlanarTriangles::previous(h);
    const std::uint32_t u = triangles.twin(h), v = PlanarTriangles::next(u), w = PlanarTriangles::previous(u);
    const std::uint32_t first = u & ~3u;
    set_leaving(triangles.origin(m), first);
    set_leaving(triangles.origin(h), h);
    set_leaving(triangles.origin(n), first + 2);
    set_leaving(triangles.origin(w), n);
    const std::uint8_t qs = kind(v), sr = kind(w), rp = kind(n);
    set_kind(h, qs);
    set_kind(n, kFree);
    set_kind(first, kFree);
    set_kind(first + 1, sr);
    set_kind(first + 2, rp);
  }

  void add_vertex() { leaving_.push_back(kInvalid); }
  void grow(std::size_t triangles, std::size_t kept) { of_triangle_.grow(triangles, kept); }

 private:
  static constexpr std::uint8_t kOutside = 1u << 6, kInCavity = 1u << 7;

  LargeArray<std::uint8_t> of_triangle_;
  std::vector<std::uint32_t> leaving_;
};

}  // namespace vkmesh::detail
