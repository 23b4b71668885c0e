#include "job/triangle_angles.h"

namespace vkmesh::cli {

Json json_of(const TriangleAngles& angles) {
  return {{"least", angles.least * kDegrees},
          {"mean_least", angles.mean * kDegrees},
          {"below_5", angles.below_5_degrees},
          {"below_30", angles.below_30_degrees}};
}

std::string text_of(const TriangleAngles& angles, std::size_t faces) {
  const double share =
      faces == 0 ? 0 : 100.0 * static_cast<double>(angles.below_30_degrees) / static_cast<double>(faces);
  return "least " + brief(angles.least * kDegrees) + ", mean of the least " + brief(angles.mean * kDegrees) +
         " degrees; " + brief(share) + " % of the triangles have one below 30";
}

}  // namespace vkmesh::cli
