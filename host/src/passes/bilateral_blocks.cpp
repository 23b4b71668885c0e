#include "passes/bilateral_blocks.h"

#include <vkmesh/math/arithmetic.h>

#include "simd/target_clones.h"

namespace vkmesh::detail {
namespace {

// One array for each coordinate, so that lanes are neighbours in memory.
struct Lanes {
  float x[kBilateralLanes] = {}, y[kBilateralLanes] = {}, z[kBilateralLanes] = {};
};

}  // namespace

void NearFaces::append_within(const NearFaces& all, std::size_t begin, std::size_t end, const Bounds& bounds,
                              float squared_radius) {
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 c = all.faces_[i].centroid;
    float squared = 0.0f;
    for (int k = 0; k < 3; ++k) {
      const float below = bounds.low[k] - c[k], above = c[k] - bounds.high[k];
      const float outside = below > 0.0f ? below : (above > 0.0f ? above : 0.0f);
      squared += outside * outside;
    }
    if (squared <= squared_radius) faces_.push_back(all.faces_[i]);
  }
}

// In both sums lengths are in units of σ_f, so that nothing depends on the unit of the mesh.

VKMESH_CLONES void mollify(const NearFaces& near, std::span<Vec3, kBilateralLanes> points, float spatial,
                           float per_spatial) {
  Lanes p, sum;
  float total[kBilateralLanes] = {};
  for (std::size_t i = 0; i < kBilateralLanes; ++i)
    p.x[i] = points[i].x, p.y[i] = points[i].y, p.z[i] = points[i].z;
  for (const NearFaces::Face& face : near.faces()) {
    const Vec3 c = face.centroid;
    const float area = face.area;
    for (std::size_t i = 0; i < kBilateralLanes; ++i) {
      const Vec3 to =
          zero_below(Vec3(c.x - p.x[i], c.y - p.y[i], c.z - p.z[i]) * per_spatial, VKMESH_TINY_DIRECTION);
      const float squared = squared_length(to);
      // Half of (|to| / ½)².
      const float f = exact::exponential(squared < 1.0f ? -2.0f * squared : -2.0f);
      const float weight = squared < 1.0f ? zero_below(area * f, VKMESH_TINY_GAUSSIAN) : 0.0f;
      sum.x[i] += weight * to.x;
      sum.y[i] += weight * to.y;
      sum.z[i] += weight * to.z;
      total[i] += weight;
    }
  }
  for (std::size_t i = 0; i < kBilateralLanes; ++i) {
    const float scale = exact::reciprocal(total[i]);
    const Vec3 move = zero_below(Vec3(sum.x[i], sum.y[i], sum.z[i]) * scale, VKMESH_TINY_DIRECTION) * spatial;
    points[i] = zero_below(points[i] + move, VKMESH_TINY_COORDINATE);
  }
}

VKMESH_CLONES void move_to_predictions(const NearFaces& near, std::span<Vec3, kBilateralLanes> points,
                                       const BilateralWidths& widths) {
  Lanes p, sum;
  float total[kBilateralLanes] = {};
  for (std::size_t i = 0; i < kBilateralLanes; ++i)
    p.x[i] = points[i].x, p.y[i] = points[i].y, p.z[i] = points[i].z;
  const float per_spatial = widths.per_spatial, ratio = widths.spatial_over_influence;
  for (const NearFaces::Face& face : near.faces()) {
    const Vec3 c = face.centroid, n = face.normal;
    const float area = n.x == 0.0f && n.y == 0.0f && n.z == 0.0f ? 0.0f : face.area;
    for (std::size_t i = 0; i < kBilateralLanes; ++i) {
      const Vec3 to =
          zero_below(Vec3(c.x - p.x[i], c.y - p.y[i], c.z - p.z[i]) * per_spatial, VKMESH_TINY_DIRECTION);
      const float squared = squared_length(to);
      // The prediction lies this far along the normal.
      const float height = zero_below((n.x * to.x + n.y * to.y) + n.z * to.z, VKMESH_TINY_DIRECTION);
      const float across = zero_below(height * ratio, VKMESH_TINY_DIRECTION);
      const float held = std::fabs(across) < VKMESH_BILATERAL_FAR ? across : VKMESH_BILATERAL_FAR;
      // The spatial Gaussian ends at twice its width.
      const bool counts = squared < 4.0f;
      const float f = exact::exponential(counts ? -0.5f * (squared + held * held) : -4.0f);
      const float weight = counts ? zero_below(area * f, VKMESH_TINY_GAUSSIAN) : 0.0f;
      const float along = zero_below(weight * height, VKMESH_TINY_GAUSSIAN);
      sum.x[i] += along * n.x;
      sum.y[i] += along * n.y;
      sum.z[i] += along * n.z;
      total[i] += weight;
    }
  }
  for (std::size_t i = 0; i < kBilateralLanes; ++i) {
    const float scale = exact::reciprocal(total[i]);
    const Vec3 move =
        zero_below(Vec3(sum.x[i], sum.y[i], sum.z[i]) * scale, VKMESH_TINY_DIRECTION) * widths.spatial;
    points[i] = zero_below(points[i] + move, VKMESH_TINY_COORDINATE);
  }
}

}  // namespace vkmesh::detail
