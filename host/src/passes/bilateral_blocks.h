// The inner sums of bilateral smoothing, for some vertices at once.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <vkmesh/math/bounds.h>
#include <vkmesh/math/vec.h>

namespace vkmesh::detail {

/// Vertices that are computed side by side, each in a lane of the vector registers.
inline constexpr std::size_t kBilateralLanes = 16;

/// Faces in the order in which they are summed.
class NearFaces {
 public:
  void clear() { faces_.clear(); }
  /// `area` in units of σ_f².
  void append(Vec3 centroid, Vec3 normal, float area) { faces_.push_back({centroid, normal, area}); }
  /// The faces [begin, end) of `all` whose centroids are within √squared_radius of the box.
  void append_within(const NearFaces& all, std::size_t begin, std::size_t end, const Bounds& bounds,
                     float squared_radius);
  void set_normal(std::size_t i, Vec3 normal) { faces_[i].normal = normal; }

  struct Face {
    Vec3 centroid, normal;
    float area = 0.0f;
  };
  [[nodiscard]] std::span<const Face> faces() const { return faces_; }

 private:
  std::vector<Face> faces_;
};

struct BilateralWidths {
  float spatial;                 ///< σ_f
  float per_spatial;             ///< 1 / σ_f
  float spatial_over_influence;  ///< σ_f / σ_g
};

/// Each point becomes the mean of the centroids around it, by area and a Gaussian of width σ_f / 2.
void mollify(const NearFaces& near, std::span<Vec3, kBilateralLanes> points, float spatial,
             float per_spatial);

/// Each point becomes the mean of its predictions.
void move_to_predictions(const NearFaces& near, std::span<Vec3, kBilateralLanes> points,
                         const BilateralWidths& widths);

}  // namespace vkmesh::detail
