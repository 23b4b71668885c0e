#include "decimation/setup/check_options.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

namespace vkmesh::detail {
namespace {

using std::numbers::pi;

Result<void> usage(const std::string& what) {
  return fail(ErrorCode::kUsage, what);
}

bool is_weight(double x) {
  return x >= 0 && std::isfinite(x);
}
bool is_length(const std::optional<Length>& x) {
  return !x || x->value >= 0;
}

Result<void> check(const DecimateTargets& target) {
  if (target.ratio && !(*target.ratio >= 0 && *target.ratio <= 1))
    return usage("target.ratio must lie between 0 and 1");
  if (target.seconds && !(*target.seconds >= 0)) return usage("target.seconds must be at least 0");
  return {};
}

Result<void> check(const DecimateWeights& weights) {
  const auto all = {weights.quadric, weights.density, weights.aspect_ratio, weights.normals};
  if (!std::ranges::all_of(all, is_weight)) return usage("each of weights must be at least 0 and finite");
  if (std::max(all) == 0) return usage("some criterion needs a weight above 0");
  return {};
}

Result<void> check(const DecimateBounds& bounds) {
  if (!is_length(bounds.error)) return usage("bounds.error must be at least 0");
  if (!is_length(bounds.distance)) return usage("bounds.distance must be at least 0");
  if (!(bounds.normal_deviation > 0 && bounds.normal_deviation < pi))
    return usage("bounds.normal_deviation must lie between 0 and pi");
  if (const auto angle = bounds.original_normal_deviation; angle && !(*angle > 0 && *angle < pi))
    return usage("bounds.original_normal_deviation must lie between 0 and pi");
  if (bounds.aspect_ratio && !(*bounds.aspect_ratio >= 1))
    return usage("bounds.aspect_ratio must be at least 1");
  if (bounds.edge_length && !(bounds.edge_length->value > 0))
    return usage("bounds.edge_length must be above 0");
  if (bounds.valence && *bounds.valence < 3) return usage("a bound of the valence must be at least 3");
  return {};
}

Result<void> check(const DecimateCurves& curves) {
  if (!is_weight(curves.boundary_weight) || !is_weight(curves.crease_weight) ||
      !is_weight(curves.seam_weight))
    return usage("each weight of curves must be at least 0 and finite");
  if (curves.crease_angle && !(*curves.crease_angle > 0 && *curves.crease_angle <= pi))
    return usage("curves.crease_angle must lie between 0 and pi");
  return {};
}

Result<void> check(const DecimateLocks& locked, std::size_t vertices, std::size_t corners) {
  const auto all_below = [](const auto& numbers, std::size_t count) {
    return std::ranges::all_of(numbers, [&](std::uint32_t i) { return i < count; });
  };
  if (!all_below(locked.vertices, vertices)) return usage("a locked vertex is not of the mesh");
  if (!all_below(locked.edges, corners)) return usage("a locked edge is not of the mesh");
  if (!all_below(locked.faces, corners / 3)) return usage("a locked face is not of the mesh");
  return {};
}

Result<void> check(const DecimateAttribute& a, std::size_t vertices, std::size_t corners) {
  if (!is_weight(a.weight)) return usage("the weight of an attribute must be at least 0 and finite");
  if (a.components == 0 || (a.kind == AttributeKind::kNormal && a.components != 3))
    return usage("an attribute needs at least one component, and normals three");
  if (a.stride != 0 && a.stride < a.components)
    return usage("the stride of an attribute must be at least its components");
  const std::size_t values = a.value_count();
  if ((a.stride == 0 && a.values.size() % a.components != 0) || (a.corners.empty() && values != vertices))
    return usage("an attribute needs one value for each vertex, or the value of each corner");
  if (!a.corners.empty() && a.corners.size() != corners)
    return usage("an attribute needs a value for each corner of the mesh");
  if (std::ranges::any_of(a.corners, [&](std::uint32_t value) { return value >= values; }))
    return usage("a corner names no value of an attribute");
  for (std::size_t v = 0; v < values; ++v)
    if (!std::ranges::all_of(a.value(v), [](float x) { return std::isfinite(x); }))
      return fail(ErrorCode::kUnsuitable, "decimation needs finite attributes");
  return {};
}

}  // namespace

Result<void> check_options(const DecimateOptions& options, std::size_t vertices, std::size_t corners) {
  VKMESH_CHECK(check(options.target));
  VKMESH_CHECK(check(options.weights));
  VKMESH_CHECK(check(options.bounds));
  VKMESH_CHECK(check(options.curves));
  VKMESH_CHECK(check(options.locked, vertices, corners));
  if (!is_length(options.prune_size)) return usage("prune_size must be at least 0");
  if (!options.corner_groups.empty() && options.corner_groups.size() != corners)
    return usage("corner_groups needs a number for each corner of the mesh");
  for (const DecimateAttribute& attribute : options.attributes)
    VKMESH_CHECK(check(attribute, vertices, corners));
  return {};
}

}  // namespace vkmesh::detail
