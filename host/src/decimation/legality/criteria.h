// What decides about a removal beside its quadric error.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <vkmesh/decimation/decimate.h>

#include "decimation/legality/hausdorff_bound.h"
#include "decimation/legality/local_change.h"
#include "decimation/setup/frame.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// DecimateWeights and all DecimateBounds but those of every removal, on changes in local units.
class Criteria {
 public:
  /// 4 bytes a face if the distance is watched, 16 if normals are.
  Criteria(const DecimateWeights& weights, const DecimateBounds& bounds, const Frame& frame,
           const CollapseMesh& mesh);

  /// Whether there is something to judge removals by.
  [[nodiscard]] bool bounds() const { return bounds_; }
  /// Whether `cost` is anything but the quadric error.
  [[nodiscard]] bool ranks() const {
    return weights_.density > 0 || weights_.aspect_ratio > 0 || weights_.normals > 0;
  }
  /// Whether `cost` looks at faces, and not at the length alone.
  [[nodiscard]] bool ranks_by_faces() const { return weights_.aspect_ratio > 0 || weights_.normals > 0; }
  /// What the shape of a triangle weighs when the quadric error weighs 1.
  [[nodiscard]] float shape_over_quadric() const {
    constexpr double kLeast = 1e-3;
    const double ratio = weights_.aspect_ratio / std::max(weights_.quadric, kLeast);
    return static_cast<float>(ratio * ratio);
  }
  [[nodiscard]] bool watches_distance() const { return watches_distance_; }

  /// What a removal costs, `quadric` included: a mean square times `area`, which all that it counts is in.
  [[nodiscard]] float cost(float quadric, float area, const LocalChange& change) const;

  /// Whether no bound forbids the removal; `keep` may be called then.
  [[nodiscard]] bool allow(const LocalChange& change);
  /// The removal that was allowed last is done.
  void keep(const LocalChange& change);

  /// No point of the surface is farther than this from the original, nor the other way round; local units.
  [[nodiscard]] double distance(const CollapseMesh& mesh) const;

 private:
  /// Around unit normals.
  struct Ball {
    std::array<float, 3> centre{};
    float radius = -1;  // around none
  };
  static Ball around(const Ball& a, const Ball& b);
  [[nodiscard]] bool is_far(const LocalChange& change) const;
  [[nodiscard]] bool stays_near(const LocalChange& change);
  [[nodiscard]] bool looks_alike(const LocalChange& change);

  DecimateWeights weights_;
  DecimateBounds limits_;
  bool watches_distance_, bounds_;
  double edge_length2_ = std::numeric_limits<double>::infinity();
  double distance_ = std::numeric_limits<double>::infinity();  // most
  double chord_ = std::numeric_limits<double>::infinity();     // most, between unit normals
  // By record of the face. How far it lies from the part of the original that it stands for, and that from
  // it; the normals of the original's faces that were handed to it.
  std::vector<float> distances_;
  std::vector<Ball> normals_;
  // The same after the change that was allowed last.
  std::vector<float> distances_after_;
  std::vector<Ball> normals_after_;
  Overlay overlay_;
};

/// The longest side over the height upon it, 1 for equilateral triangles; infinite without area.
[[nodiscard]] double aspect_ratio(const Triangle& triangle);

}  // namespace vkmesh::detail
