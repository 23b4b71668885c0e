// The curves of the surface that was given which stay: boundary, creases, and what the caller names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/mesh/handles.h>

#include "remesh/original_surface.h"

namespace vkmesh::detail {

/// Polylines between vertices that stay where they are, its ends: those where other than two edges of curves
/// meet, where a curve turns sharply, and those that are locked. No curve joins a vertex to itself: closed
/// ones have three ends, or as many as it takes. A place on a curve is an arc length.
class FeatureCurves {
 public:
  /// `is_curve`: for each half-edge, either of the two is enough. `is_locked`: for each vertex. A curve turns
  /// sharply where it does so between the places that are `reach` away, too: the teeth of a ragged boundary
  /// are no corners.
  FeatureCurves(const OriginalSurface& surface, const std::vector<bool>& is_curve,
                const std::vector<bool>& is_locked, double reach);

  static constexpr std::uint32_t kNone = kInvalid, kEnd = kInvalid - 1;
  /// For each vertex of the input: the curve in whose interior it is, kEnd, or kNone.
  [[nodiscard]] std::uint32_t curve_of(std::uint32_t v) const { return curve_of_[v]; }
  /// The arc length at a vertex in the interior of a curve.
  [[nodiscard]] double along(std::uint32_t v) const { return along_[v]; }

  /// The vertices of the input where the curve begins and ends.
  [[nodiscard]] std::uint32_t first(std::uint32_t curve) const { return vertices_[curves_[curve].begin]; }
  [[nodiscard]] std::uint32_t last(std::uint32_t curve) const { return vertices_[curves_[curve].end - 1]; }
  [[nodiscard]] double length(std::uint32_t curve) const { return lengths_[curves_[curve].end - 1]; }
  /// The arc length at one of its two ends.
  [[nodiscard]] double along_end(std::uint32_t curve, std::uint32_t v) const {
    return v == first(curve) ? 0.0 : length(curve);
  }
  [[nodiscard]] bool is_boundary(std::uint32_t curve) const { return curves_[curve].is_boundary; }
  [[nodiscard]] DVec3 at(std::uint32_t curve, double along) const;
  /// The vertices of curves that are shorter than that, each with `factor` times the length of its curve,
  /// which edges there cannot exceed.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, double>> short_ones(double length, double factor) const;
  /// The largest squared distance of the polyline between two places from the chord that joins them.
  [[nodiscard]] double squared_deviation(std::uint32_t curve, double from, double to) const;
  /// The point there on the face to the left of the curve as seen along it, or to the right.
  [[nodiscard]] Foot beside(std::uint32_t curve, double along, bool left) const;

  /// How many vertices the interior of a curve has in the mesh that changes; kept by its steps.
  [[nodiscard]] std::uint32_t& inside(std::uint32_t curve) { return curves_[curve].inside; }
  /// The curve that is a single edge between two of the ends in the mesh that changes; kNone without one.
  [[nodiscard]] std::uint32_t single_edge(std::uint32_t v, std::uint32_t w) const;

 private:
  struct Curve {
    std::size_t begin, end;  // in vertices_ and lengths_
    std::uint32_t inside;
    bool is_boundary;
  };
  struct At {
    std::uint32_t from, curve;
  };
  /// The segment of the polyline where a place is, and how far along it, from 0 to 1.
  [[nodiscard]] std::pair<std::size_t, double> segment(std::uint32_t curve, double along) const;

  const OriginalSurface& surface_;
  std::vector<std::uint32_t> curve_of_;
  std::vector<double> along_;
  std::vector<Curve> curves_;
  std::vector<std::uint32_t> vertices_;
  std::vector<double> lengths_;       // along each curve up to the vertex
  std::vector<std::uint32_t> edges_;  // from the vertex along its curve, the half-edge or its twin
  std::vector<At> at_ends_;           // sorted
};

}  // namespace vkmesh::detail
